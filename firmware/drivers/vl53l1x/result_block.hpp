// The result block: 17 bytes from RESULT__RANGE_STATUS on, everything a reading needs, in one transfer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/drivers/vl53l1x/measurement.hpp"

namespace octoskin::vl53l1x {

using ResultBlock = std::array<std::uint8_t, 17>;
inline constexpr std::size_t kStreamCountOffset = 2;

/// Unpacks without judging. `applies_gain_factor` scales the range by 2011/2048, rounded, as ST's full API
/// does.
[[nodiscard]] Measurement unpack(const ResultBlock& block, bool applies_gain_factor) noexcept;

/// False for what no sensor sends: a bus that reads 0xFF throughout, a status code beyond the last one
/// defined (23), or a complete range that no SPAD took part in.
[[nodiscard]] bool is_plausible(const ResultBlock& block) noexcept;

}  // namespace octoskin::vl53l1x
