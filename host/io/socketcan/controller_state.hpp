// How an interface's CAN controller stands, asked of the kernel (rtnetlink): error frames tell of changes
// only, and not every adapter tells of every change.
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

/// Empty if the kernel does not say: no such interface, a virtual one, or netlink is not permitted here. One
/// call of the kernel, which waits only for whoever sets up an interface at that moment.
[[nodiscard]] std::optional<ControllerState> read_controller_state(const std::string& interface);

/// The same out of the kernel's answer to RTM_GETLINK. Any bytes are safe.
[[nodiscard]] std::optional<ControllerState> controller_state_of(std::span<const std::byte> answer);

}  // namespace octoskin::socketcan
