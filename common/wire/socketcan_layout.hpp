// A frame as Linux lays it out in a raw CAN socket: <linux/can.h>, `struct can_frame` and `struct
// canfd_frame`. Everybody on Linux who opens such a socket shares it.
#pragma once

#include <linux/can.h>

#include <cstddef>
#include <optional>
#include <span>

#include "common/wire/can_frame.hpp"

namespace octoskin::wire {

/// The frame in `bytes`, as one `read` of a raw CAN socket returned them; empty if that is neither a
/// classical nor an FD frame: another size, or a length that its format does not have.
[[nodiscard]] std::optional<CanFrame> from_socketcan(std::span<const std::byte> bytes) noexcept;

struct SocketCanBytes {
    canfd_frame frame{};   ///< begins as `struct can_frame` does
    std::size_t size = 0;  ///< CAN_MTU or CANFD_MTU
    [[nodiscard]] std::span<const std::byte> bytes() const noexcept {
        return std::as_bytes(std::span(&frame, 1)).first(size);
    }
};
/// The frame's length must exist in its format (asserted).
[[nodiscard]] SocketCanBytes to_socketcan(const CanFrame& frame) noexcept;

}  // namespace octoskin::wire
