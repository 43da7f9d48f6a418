// The result block: the 17 bytes from RESULT__RANGE_STATUS on. One transfer reads all that a reading needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/drivers/vl53l1x/measurement.hpp"

namespace octoskin::vl53l1x {

using ResultBlock = std::array<std::uint8_t, 17>;
inline constexpr std::size_t kStreamCountOffset = 2;

/// Unpacks without checking. `applies_gain_factor` scales the range by 2011/2048, rounded, as ST's full API
/// does.
[[nodiscard]] Measurement unpack(const ResultBlock& block, bool applies_gain_factor) noexcept;

/// False for a block that no sensor sends: 0xFF throughout, a status code beyond the last defined one (23),
/// or a complete range without SPADs.
[[nodiscard]] bool is_plausible(const ResultBlock& block) noexcept;

}  // namespace octoskin::vl53l1x
