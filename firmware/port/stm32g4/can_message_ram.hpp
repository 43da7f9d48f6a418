// How frames and filters lie in the CAN controller's message RAM: words only. RM0440, "FDCAN message RAM".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "firmware/port/stm32g4/registers/fdcan.hpp"

namespace octoskin::stm32g4 {

inline constexpr Address kMessageRam = kMessageRamBase;  ///< FDCAN1's part is the first
inline constexpr std::uint32_t kMessageRamBytes = 0x350;
inline constexpr Address kStandardFilters = kMessageRam;
inline constexpr Address kReceiveFifo = kMessageRam + 0x0B0;
inline constexpr Address kTransmitFifo = kMessageRam + 0x278;
inline constexpr std::uint32_t kFifoElements = 3;
inline constexpr std::uint32_t kElementWords = 18;  ///< 2 of header, 64 bytes of data

using CanElement = std::array<std::uint32_t, kElementWords>;

[[nodiscard]] constexpr Address element_address(Address fifo, std::uint32_t index) {
    return fifo + index * kElementWords * 4;
}
/// Words of an element that a frame of this length uses.
[[nodiscard]] constexpr std::uint32_t words_in_use(std::uint8_t payload_len) {
    return 2 + (payload_len + 3U) / 4;
}

/// The length as the controller codes it. `payload_len`: one that CAN FD has.
[[nodiscard]] std::uint32_t data_length_code(std::uint8_t payload_len);
/// 0..15; a classical frame has at most 8 bytes whatever its code says.
[[nodiscard]] std::uint8_t payload_length(std::uint32_t code, bool is_fd);

/// For the transmit FIFO; words behind `words_in_use` are zero.
[[nodiscard]] CanElement encode_element(const wire::CanFrame& frame);
/// From the receive FIFO. A remote frame has no data.
[[nodiscard]] wire::CanFrame decode_element(const CanElement& element);

/// What a node listens to: SYNC, commands to all, and its own id: commands to it, and whoever else uses it.
inline constexpr std::uint32_t kFilterCount = 2;
[[nodiscard]] std::array<std::uint32_t, kFilterCount> node_filters(wire::NodeId node_id);

}  // namespace octoskin::stm32g4
