// Characters of a text that may be no UTF-8 at all.
#pragma once

#include <cstddef>
#include <string_view>

namespace octoskin {

/// Bytes of the UTF-8 sequence that `text`, which is not empty, begins with, or 0 if it begins with none (RFC
/// 3629: no overlong forms, no surrogates, nothing above U+10FFFF).
[[nodiscard]] std::size_t utf8_length(std::string_view text);

/// The character that those bytes, a whole sequence, are.
[[nodiscard]] char32_t utf8_character(std::string_view sequence);

}  // namespace octoskin
