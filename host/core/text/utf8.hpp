// Decodes text that may not be valid UTF-8.
#pragma once

#include <cstddef>
#include <string_view>

namespace octoskin {

/// Length in bytes of the UTF-8 sequence at the start of `text`, which must not be empty; 0 if it does not
/// start with a valid one (RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF).
[[nodiscard]] std::size_t utf8_length(std::string_view text);

/// The character of a complete, valid sequence.
[[nodiscard]] char32_t utf8_character(std::string_view sequence);

}  // namespace octoskin
