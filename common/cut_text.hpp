// Words of others, in a message: as much of them as tells what they are.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace octoskin {

/// The first `max` bytes of a text that is longer, and "..."; a character of UTF-8 is there as a whole or not
/// at all.
[[nodiscard]] inline std::string cut_text(std::string_view text, std::size_t max) {
    if (text.size() <= max) return std::string(text);
    constexpr unsigned kContinues = 0x80U;
    constexpr unsigned kContinuesMask = 0xC0U;
    while (max > 0 && (static_cast<unsigned char>(text[max]) & kContinuesMask) == kContinues) --max;
    return std::string(text.substr(0, max)) + "...";
}

}  // namespace octoskin
