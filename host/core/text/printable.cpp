#include "host/core/text/printable.hpp"

#include <array>
#include <cstddef>

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

std::string shown_of(std::string_view text, bool keeps_lines) {
    std::string shown;
    shown.reserve(text.size());
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        const std::string_view sequence = text.substr(0, length == 0 ? 1 : length);
        text.remove_prefix(sequence.size());
        const auto byte = static_cast<unsigned char>(sequence.front());
        if (length == 0) {
            append_number(shown, 'x', byte, 2);
            continue;
        }
        const char32_t character = utf8_character(sequence);
        const bool is_kept = keeps_lines && (character == U'\n' || character == U'\t');
        if (is_control(character) && !is_kept) {
            append_number(shown, 'x', static_cast<unsigned>(character), 2);
        } else if (is_turning_or_ending(character)) {
            append_number(shown, 'u', static_cast<unsigned>(character), 4);
        } else {
            shown += sequence;
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
        const std::size_t length = utf8_length(json);
        const std::string_view sequence = json.substr(0, length == 0 ? 1 : length);
        json.remove_prefix(sequence.size());
        const char32_t character = length == 0 ? 0 : utf8_character(sequence);
        // Those below 0x20 are escaped already where they are part of a string.
        const bool is_shown_by_number =
            character >= 0x7F && (is_control(character) || is_turning_or_ending(character));
        if (is_shown_by_number) {
            append_number(shown, 'u', static_cast<unsigned>(character), 4);
        } else {
            shown += sequence;
        }
    }
    return shown;
}

}  // namespace octoskin
