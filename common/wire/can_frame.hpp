// One CAN or CAN FD frame, independent of an operating system's layout.
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <span>

namespace octoskin::wire {

inline constexpr std::uint8_t kClassicalPayloadMax = 8;
inline constexpr std::uint8_t kFdPayloadMax = 64;

struct CanFrame {
    std::uint32_t can_id = 0;  ///< 11 bits, or 29 when `is_extended`
    bool is_extended = false;
    bool is_remote = false;
    bool is_error = false;  ///< an error frame of the adapter, not bus traffic
    bool is_fd = false;     ///< CAN FD format
    bool has_bit_rate_switch = false;
    std::uint8_t payload_len = 0;  ///< bytes of `data` in use: 0..8, or an FD length up to 64
    std::array<std::uint8_t, kFdPayloadMax> data{};

    [[nodiscard]] constexpr std::span<const std::uint8_t> payload() const {
        return std::span(data).first(payload_len);
    }
    friend constexpr bool operator==(const CanFrame&, const CanFrame&) = default;
};

/// CAN FD allows 0..8, 12, 16, 20, 24, 32, 48 and 64 bytes.
[[nodiscard]] constexpr bool is_fd_length(std::size_t length) noexcept {
    return length <= 8 || length == 12 || length == 16 || length == 20 || length == 24 || length == 32 ||
           length == 48 || length == 64;
}

/// The shortest CAN FD payload that holds `length` <= 64 bytes.
[[nodiscard]] constexpr std::uint8_t next_fd_length(std::uint8_t length) noexcept {
    while (!is_fd_length(length)) {
        assert(length < kFdPayloadMax);
        ++length;
    }
    return length;
}

}  // namespace octoskin::wire
