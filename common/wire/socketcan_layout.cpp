#include "common/wire/socketcan_layout.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace octoskin::wire {

std::optional<CanFrame> from_socketcan(std::span<const std::byte> bytes) noexcept {
    if (bytes.size() != CAN_MTU && bytes.size() != CANFD_MTU) return std::nullopt;
    canfd_frame raw{};
    std::memcpy(&raw, bytes.data(), bytes.size());

    CanFrame frame;
    frame.is_fd = bytes.size() == CANFD_MTU;
    frame.is_remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.is_error = (raw.can_id & CAN_ERR_FLAG) != 0;
    if ((frame.is_fd || frame.is_error) && frame.is_remote) return std::nullopt;
    if (frame.is_fd && frame.is_error) return std::nullopt;
    // The identifier of an error frame is its class. It is 29 bits wide, but the frame is not an extended
    // one.
    frame.is_extended = (raw.can_id & CAN_EFF_FLAG) != 0 && !frame.is_error;
    frame.can_id = raw.can_id & (frame.is_extended || frame.is_error ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.has_bit_rate_switch = frame.is_fd && (raw.flags & CANFD_BRS) != 0;
    const bool is_length = frame.is_fd ? is_fd_length(raw.len) : raw.len <= kClassicalPayloadMax;
    if (!is_length) return std::nullopt;
    frame.payload_len = raw.len;
    if (!frame.is_remote) std::copy_n(raw.data, raw.len, frame.data.begin());
    return frame;
}

SocketCanBytes to_socketcan(const CanFrame& frame) noexcept {
    assert(frame.is_fd ? is_fd_length(frame.payload_len) : frame.payload_len <= kClassicalPayloadMax);
    assert(!(frame.is_fd && frame.is_remote));
    SocketCanBytes bytes;
    bytes.size = frame.is_fd ? CANFD_MTU : CAN_MTU;
    bytes.frame.can_id = frame.can_id | (frame.is_extended ? CAN_EFF_FLAG : 0U) |
                         (frame.is_remote ? CAN_RTR_FLAG : 0U) | (frame.is_error ? CAN_ERR_FLAG : 0U);
    bytes.frame.len = frame.payload_len;
    bytes.frame.flags = frame.is_fd && frame.has_bit_rate_switch ? CANFD_BRS : 0;
    std::copy_n(frame.data.begin(), frame.payload_len, bytes.frame.data);
    return bytes;
}

}  // namespace octoskin::wire
