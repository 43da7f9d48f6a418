// Words and numbers of a mesh file's text, as assimp takes them.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace octoskin {

/// The next word of `text`, which is removed from it; empty at its end.
inline std::string_view take_word(std::string_view& text, std::string_view blanks) {
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(blanks));
    text.remove_prefix(word.size());
    return word;
}

inline bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// assimp takes the digits before the point as one 64-bit number, with 0 in place of a larger one, and of
/// those behind it the first 15.
inline bool has_digits_for_all_readers(std::string_view unsigned_word) {
    constexpr std::size_t kDigits = 15;
    const std::size_t end_of_whole = std::min(unsigned_word.find_first_of(".eE"), unsigned_word.size());
    const std::string_view whole = unsigned_word.substr(0, end_of_whole);
    const std::size_t zeros = std::min(whole.find_first_not_of('0'), whole.size());
    if (whole.size() - zeros > kDigits) return false;
    const std::size_t exponent = unsigned_word.find_first_of("eE");
    const bool is_small = zeros == whole.size();
    const bool is_enlarged = exponent != std::string_view::npos && exponent + 1 < unsigned_word.size() &&
                             unsigned_word[exponent + 1] != '-';
    return !(is_small && is_enlarged && exponent - end_of_whole > kDigits + 1);
}

/// A number that all readers take the same way; none for "5-0", "1.2.3", "0x2", "nan".
inline std::optional<double> plain_number(std::string_view word) {
    if (!word.empty() && (word.front() == '-' || word.front() == '+')) {
        const auto negative = word.front() == '-';
        const auto value = word.size() > 1 && word[1] != '-' && word[1] != '+' ? plain_number(word.substr(1))
                                                                               : std::optional<double>();
        return value && negative ? std::optional(-*value) : value;
    }
    const bool has_digit = !word.empty() && (is_digit(word.front()) ||
                                             (word.size() > 1 && word.front() == '.' && is_digit(word[1])));
    if (!has_digit || !has_digits_for_all_readers(word)) return std::nullopt;
    double value = 0.0;
    const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_whole = parsed.ec == std::errc{} && parsed.ptr == word.data() + word.size();
    return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace octoskin
