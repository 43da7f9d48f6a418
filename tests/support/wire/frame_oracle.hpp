// A second, simple implementation of the frame layout: one bit after the other, directly from
// docs/protocol.md. Tests compare the codec with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/wire/can_frame.hpp"
#include "common/wire/crc.hpp"

namespace octoskin::test {

using Payload = std::vector<std::uint8_t>;

/// Bit n of a frame is bit n % 8 of byte n / 8; a field's lowest bit comes first.
inline void set_bits(Payload& payload, unsigned start, unsigned bits, std::uint64_t raw) {
    for (unsigned i = 0; i < bits; ++i) {
        const auto mask = static_cast<std::uint8_t>(1U << ((start + i) % 8));
        std::uint8_t& byte = payload.at((start + i) / 8);
        byte = ((raw >> i) & 1U) != 0 ? static_cast<std::uint8_t>(byte | mask)
                                      : static_cast<std::uint8_t>(byte & ~mask);
    }
}

/// Puts the right checksum of `checksum_len` bytes (0: none) into the last bytes of `payload`.
inline void sign(std::uint32_t can_id, Payload& payload, std::size_t checksum_len) {
    if (payload.size() < checksum_len) {
        return;
    }
    const std::size_t data_len = payload.size() - checksum_len;
    Payload covered = {static_cast<std::uint8_t>(can_id & 0xFFU), static_cast<std::uint8_t>(can_id >> 8U),
                       static_cast<std::uint8_t>(payload.size())};
    covered.insert(covered.end(), payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(data_len));
    if (checksum_len == 1) {
        payload[data_len] = crc8(covered);
    } else if (checksum_len == 2) {
        payload[data_len] = static_cast<std::uint8_t>(crc16(covered) >> 8U);
        payload[data_len + 1] = static_cast<std::uint8_t>(crc16(covered) & 0xFFU);
    }
}

/// Bytes of the checksum of each type of frame, by docs/protocol.md; 0 for types that do not exist.
inline std::size_t checksum_len_of(std::uint32_t can_id) {
    constexpr std::uint8_t kLengths[32] = {2, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 1, 2, 1};
    const std::uint32_t type = (can_id >> 6U) & 31U;
    return type == 31 ? 1 : kLengths[type];
}

/// The frame of `payload` unchanged, with its checksum.
inline wire::CanFrame frame_of(std::uint32_t can_id, bool is_fd, const Payload& payload) {
    wire::CanFrame frame;
    frame.can_id = can_id;
    frame.is_fd = is_fd;
    frame.has_bit_rate_switch = is_fd;
    frame.payload_len = static_cast<std::uint8_t>(payload.size());
    for (std::size_t i = 0; i < payload.size(); ++i) {
        frame.data.at(i) = payload[i];
    }
    return frame;
}

inline Payload payload_of(const wire::CanFrame& frame) {
    return {frame.payload().begin(), frame.payload().end()};
}

}  // namespace octoskin::test
