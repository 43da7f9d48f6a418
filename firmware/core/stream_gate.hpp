// Whether the sensor has measured again: the stream count of a result, compared with the last one.
#pragma once

#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"

namespace octoskin::node {

/// More steps than this cannot be distinguished from steps back: the ring 128..255 has 128 places.
inline constexpr std::uint8_t kStreamStepsMax = 63;

/// By how many results the count moved from `previous` to `current`, 1..kStreamStepsMax; empty if it did not
/// move, moved back or moved further. The count runs 0, 1, ..., 255, 128, ..., 255, 128 (UM2356), so 0..127
/// come only once after a start.
[[nodiscard]] std::optional<std::uint8_t> stream_steps(std::uint8_t previous, std::uint8_t current) noexcept;

/// Whether `gate` lets a result with stream count `current` pass after one with `previous`.
[[nodiscard]] bool passes(StreamGate gate, std::uint8_t previous, std::uint8_t current) noexcept;

}  // namespace octoskin::node
