#include "host/core/text/printable.hpp"

#include <array>
#include <cstddef>
#include <optional>

#include "host/core/text/utf8.hpp"

namespace octoskin {
namespace {

constexpr std::array<char, 16> kDigits{'0', '1', '2', '3', '4', '5', '6', '7',
                                       '8', '9', 'a', 'b', 'c', 'd', 'e', 'f'};

bool is_control(char32_t character) {
    return character < 0x20 || (character >= 0x7F && character <= 0x9F);
}

/// Unicode's Bidi_Control, and the separators of lines (2028) and paragraphs (2029).
bool is_turning_or_ending(char32_t character) {
    return character == 0x061C || character == 0x200E || character == 0x200F ||
           (character >= 0x2028 && character <= 0x202E) || (character >= 0x2066 && character <= 0x2069);
}

void append_number(std::string& shown, char kind, unsigned number, int digits) {
    shown += '\\';
    shown += kind;
    for (int digit = digits - 1; digit >= 0; --digit)
        shown += kDigits.at(number >> static_cast<unsigned>(4 * digit) & 0xFU);
}

/// The first character of a text, or a single byte that is not part of valid UTF-8.
struct Sequence {
    std::string_view bytes;
    std::optional<char32_t> character;
};

/// Removes the first character from the text, which must not be empty.
Sequence take_sequence(std::string_view& text) {
    const std::size_t length = utf8_length(text);
    const std::string_view bytes = text.substr(0, length == 0 ? 1 : length);
    text.remove_prefix(bytes.size());
    return {bytes, length == 0 ? std::nullopt : std::optional(utf8_character(bytes))};
}

std::string shown_of(std::string_view text, bool keeps_lines) {
    std::string shown;
    shown.reserve(text.size());
    while (!text.empty()) {
        const auto [bytes, character] = take_sequence(text);
        const bool is_kept = keeps_lines && (character == U'\n' || character == U'\t');
        if (!character) {
            append_number(shown, 'x', static_cast<unsigned char>(bytes.front()), 2);
        } else if (is_control(*character) && !is_kept) {
            append_number(shown, 'x', static_cast<unsigned>(*character), 2);
        } else if (is_turning_or_ending(*character)) {
            append_number(shown, 'u', static_cast<unsigned>(*character), 4);
        } else {
            shown += bytes;
        }
    }
    return shown;
}

}  // namespace

std::string printable(std::string_view text) {
    return shown_of(text, false);
}

std::string printable_lines(std::string_view text) {
    return shown_of(text, true);
}

std::string printable_json(std::string_view json) {
    std::string shown;
    shown.reserve(json.size());
    while (!json.empty()) {
        const auto [bytes, character] = take_sequence(json);
        // JSON strings already escape the characters below 0x20.
        const bool is_shown_by_number =
            character && *character >= 0x7F && (is_control(*character) || is_turning_or_ending(*character));
        if (is_shown_by_number) {
            append_number(shown, 'u', static_cast<unsigned>(*character), 4);
        } else {
            shown += bytes;
        }
    }
    return shown;
}

}  // namespace octoskin
