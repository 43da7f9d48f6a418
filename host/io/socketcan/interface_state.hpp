// How an interface and its CAN controller stand, asked of the kernel (rtnetlink): error frames tell of
// changes only, and not every adapter tells of every change; a socket tells that its interface went down, and
// not that it is up again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace octoskin::socketcan {

/// As <linux/can/netlink.h> has them.
enum class ControllerState : std::uint8_t {
    error_active,
    error_warning,
    error_passive,
    bus_off,
    stopped,
    sleeping,
};

struct InterfaceState {
    bool is_up = false;                         ///< somebody brought it up (IFF_UP)
    std::optional<ControllerState> controller;  ///< empty: it has none, as a virtual one
    friend bool operator==(const InterfaceState&, const InterfaceState&) = default;
};

/// Empty if the kernel does not say: no such interface, or netlink is not permitted here. One call of the
/// kernel, which waits only for whoever sets up an interface at that moment.
[[nodiscard]] std::optional<InterfaceState> read_interface_state(const std::string& interface);

/// The same out of the kernel's answer to RTM_GETLINK. Any bytes are safe.
[[nodiscard]] std::optional<InterfaceState> interface_state_of(std::span<const std::byte> answer);

}  // namespace octoskin::socketcan
