// Which names of CAN interfaces are allowed. A candump log has the name and the frame as words of one line,
// so a name that looks like a frame, or like two words, would be misread.
#pragma once

#include <cstddef>
#include <string_view>

namespace octoskin::wire {

inline constexpr std::size_t kInterfaceNameMax = 15;  ///< the limit of Linux

/// 1 to 15 printable ASCII characters, no blank, no '#'. Linux allows more than that.
[[nodiscard]] constexpr bool is_interface_name(std::string_view name) noexcept {
    for (const char c : name) {
        if (c <= ' ' || c > '~' || c == '#') return false;
    }
    return !name.empty() && name.size() <= kInterfaceNameMax;
}

/// The explanation in messages about any other name.
inline constexpr std::string_view kInterfaceNameRule =
    "a CAN interface's name here has 1 to 15 printable ASCII characters, no blank and no '#': rename it "
    "(`ip link set OLD name NEW`)";

}  // namespace octoskin::wire
