// A frame in the layout of a raw CAN socket of Linux: <linux/can.h>, `struct can_frame` and `struct
// canfd_frame`. Shared by all programs on Linux that open such a socket.
#pragma once

#include <linux/can.h>

#include <cstddef>
#include <optional>
#include <span>

#include "common/wire/can_frame.hpp"

namespace octoskin::wire {

/// The frame in `bytes`, as one `read` of a raw CAN socket returned them. Empty if that is neither a
/// classical nor an FD frame: another size, a length that its format does not have, a remote frame in FD
/// format (CAN has none), or an error frame that is remote or in FD format (no kernel makes one). So every
/// returned frame can be sent and recorded, and is the same when it is read again.
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
