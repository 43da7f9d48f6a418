// Layout of frames and filters in the CAN controller's message RAM, which allows word access only. RM0440,
// "FDCAN message RAM".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "firmware/port/stm32g4/registers/fdcan.hpp"

namespace octoskin::stm32g4 {

inline constexpr Address kMessageRam = kMessageRamBase;  ///< FDCAN1's part is the first one
inline constexpr std::uint32_t kMessageRamBytes = 0x350;
inline constexpr Address kStandardFilters = kMessageRam;
inline constexpr Address kReceiveFifo = kMessageRam + 0x0B0;
inline constexpr Address kTransmitFifo = kMessageRam + 0x278;
inline constexpr std::uint32_t kFifoElements = 3;
inline constexpr std::uint32_t kElementWords = 18;  ///< 2 header words, 64 bytes of data

using CanElement = std::array<std::uint32_t, kElementWords>;

[[nodiscard]] constexpr Address element_address(Address fifo, std::uint32_t index) {
    return fifo + index * kElementWords * 4;
}
/// Number of words used by a frame with this payload length.
[[nodiscard]] constexpr std::uint32_t words_in_use(std::uint8_t payload_len) {
    return 2 + (payload_len + 3U) / 4;
}

/// Data length code of `payload_len`, which must be a CAN FD length.
[[nodiscard]] std::uint32_t data_length_code(std::uint8_t payload_len);
/// `code`: 0..15. A classical frame has at most 8 bytes for any code.
[[nodiscard]] std::uint8_t payload_length(std::uint32_t code, bool is_fd);

/// Element for the transmit FIFO; words after `words_in_use` are zero.
[[nodiscard]] CanElement encode_element(const wire::CanFrame& frame);
/// Frame of a receive FIFO element. A remote frame has no data.
[[nodiscard]] wire::CanFrame decode_element(const CanElement& element);

/// Filters for the frames that a node receives: SYNC, commands to all, and frames with its own id: commands
/// to it, and frames of another node that uses the same id.
inline constexpr std::uint32_t kFilterCount = 2;
[[nodiscard]] std::array<std::uint32_t, kFilterCount> node_filters(wire::NodeId node_id);

}  // namespace octoskin::stm32g4
