// The state of an interface and its CAN controller, requested from the kernel (rtnetlink). Error frames
// report changes only, and some adapters do not report all of them. A socket reports that its interface went
// down, but not that it is up again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace octoskin::socketcan {

/// The values of <linux/can/netlink.h>.
enum class ControllerState : std::uint8_t {
    error_active,
    error_warning,
    error_passive,
    bus_off,
    stopped,
    sleeping,
};

struct InterfaceState {
    bool is_up = false;                         ///< set up (IFF_UP)
    std::optional<ControllerState> controller;  ///< empty: it has none, like a virtual interface
    friend bool operator==(const InterfaceState&, const InterfaceState&) = default;
};

/// Empty if the kernel gives no answer: no such interface, or netlink is not permitted. One system call; it
/// waits only while another program configures an interface.
[[nodiscard]] std::optional<InterfaceState> read_interface_state(const std::string& interface);

/// The same from the kernel's answer to RTM_GETLINK. Safe for any bytes.
[[nodiscard]] std::optional<InterfaceState> interface_state_of(std::span<const std::byte> answer);

}  // namespace octoskin::socketcan
