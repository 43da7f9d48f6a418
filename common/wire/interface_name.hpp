// What a CAN interface may be called. A log of candump has the name and the frame as words of one line, so a
// name that looks like a frame, or like two words, would be read for one.
#pragma once

#include <cstddef>
#include <string_view>

namespace octoskin::wire {

inline constexpr std::size_t kInterfaceNameMax = 15;  ///< as Linux has it

/// 1 to 15 printable ASCII characters, no blank, no '#'. Linux takes more than that.
[[nodiscard]] constexpr bool is_interface_name(std::string_view name) noexcept {
    for (const char c : name) {
        if (c <= ' ' || c > '~' || c == '#') return false;
    }
    return !name.empty() && name.size() <= kInterfaceNameMax;
}

/// What messages say of any other name.
inline constexpr std::string_view kInterfaceNameRule =
    "a CAN interface's name here has 1 to 15 printable ASCII characters, no blank and no '#': rename it "
    "(`ip link set OLD name NEW`)";

}  // namespace octoskin::wire
