// Shortens a text from outside for use in a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace octoskin {

/// A text longer than `max` bytes is cut there and ends in "..."; a shorter one is unchanged. A character of
/// UTF-8 is kept whole or left out.
[[nodiscard]] inline std::string cut_text(std::string_view text, std::size_t max) {
    if (text.size() <= max) return std::string(text);
    constexpr unsigned kContinues = 0x80U;
    constexpr unsigned kContinuesMask = 0xC0U;
    while (max > 0 && (static_cast<unsigned char>(text[max]) & kContinuesMask) == kContinues) --max;
    return std::string(text.substr(0, max)) + "...";
}

}  // namespace octoskin
