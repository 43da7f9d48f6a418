#include "firmware/drivers/vl53l1x/result_block.hpp"

#include "common/range_status.hpp"

namespace octoskin::vl53l1x {
namespace {

// Bits 7:5 of RESULT__RANGE_STATUS are threshold flags and the group id. Without the mask, a valid range
// would have an unknown status.
constexpr std::uint8_t kDeviceStatusMask = 0x1F;
constexpr std::uint8_t kDeviceStatusLast = 23;

std::uint16_t word(const ResultBlock& block, std::size_t offset) noexcept {
    return static_cast<std::uint16_t>((block[offset] << 8U) | block[offset + 1]);
}

std::uint8_t device_status(const ResultBlock& block) noexcept {
    return block[0] & kDeviceStatusMask;
}

std::int16_t scaled_by_gain(std::int16_t range_mm) noexcept {
    constexpr std::int32_t kGain = 2011;  // of 2048
    return static_cast<std::int16_t>((range_mm * kGain + 1024) >> 11U);
}

}  // namespace

Measurement unpack(const ResultBlock& block, bool applies_gain_factor) noexcept {
    const auto range_mm = static_cast<std::int16_t>(word(block, 13));
    return {.device_status = device_status(block),
            .stream_count = block[kStreamCountOffset],
            .effective_spads = word(block, 3),
            .peak_signal = word(block, 5),
            .ambient = word(block, 7),
            .sigma_quarter_mm = word(block, 9),
            .range_mm = applies_gain_factor ? scaled_by_gain(range_mm) : range_mm,
            .corrected_signal = word(block, 15)};
}

bool is_plausible(const ResultBlock& block) noexcept {
    // A block of 0xFF has code 31, so the first test covers it.
    const std::uint8_t status = device_status(block);
    if (status > kDeviceStatusLast) return false;
    const bool is_complete = status == kDeviceStatusComplete || status == kDeviceStatusCompleteNoWrapCheck;
    return !is_complete || word(block, 3) != 0;
}

}  // namespace octoskin::vl53l1x
