#include "firmware/drivers/vl53l1x/timing.hpp"

#include <array>
#include <cassert>

namespace octoskin::vl53l1x {
namespace {

constexpr ModeRegisters kShort{.phasecal_timeout = 0x14,
                               .vcsel_period_a = 0x07,
                               .vcsel_period_b = 0x05,
                               .valid_phase_high = 0x38,
                               .woi = 0x0705,
                               .initial_phase = 0x0606};
constexpr ModeRegisters kMedium{.phasecal_timeout = 0x0E,
                                .vcsel_period_a = 0x0B,
                                .vcsel_period_b = 0x09,
                                .valid_phase_high = 0x78,
                                .woi = 0x0B09,
                                .initial_phase = 0x0A0A};
constexpr ModeRegisters kLong{.phasecal_timeout = 0x0A,
                              .vcsel_period_a = 0x0F,
                              .vcsel_period_b = 0x0D,
                              .valid_phase_high = 0xB8,
                              .woi = 0x0F0D,
                              .initial_phase = 0x0E0E};

struct BudgetRow {
    DistanceMode mode = DistanceMode::long_range;
    std::uint16_t budget_ms = 0;
    RangeTimeouts timeouts;
};
using enum DistanceMode;
// Short and long: ST ULD 3.5.2, VL53L1X_SetTimingBudgetInMs, including its irregular short / 33 ms row. ST's
// driver has no medium mode; the datasheet (DS12385 rev 7, 2.5.2) requires 33 ms there. The medium rows
// integrate as long as the long rows: the same microseconds in macro periods of 24 and 20 instead of 32 and
// 28 clocks, at the typical 11.78 MHz. So the time left for calibration is the same as in ST's rows.
constexpr std::array<BudgetRow, 18> kBudgets{{
    {short_range, 15, {0x001D, 0x0027}},
    {short_range, 20, {0x0051, 0x006E}},
    {short_range, 33, {0x00D6, 0x006E}},
    {short_range, 50, {0x01AE, 0x01E8}},
    {short_range, 100, {0x02E1, 0x0388}},
    {short_range, 200, {0x03E1, 0x0496}},
    {short_range, 500, {0x0591, 0x05C1}},
    {medium_range, 33, {0x0080, 0x009A}},
    {medium_range, 50, {0x00E7, 0x018A}},
    {medium_range, 100, {0x0288, 0x02A3}},
    {medium_range, 200, {0x0390, 0x03AD}},
    {medium_range, 500, {0x04BE, 0x04E5}},
    {long_range, 20, {0x001E, 0x0022}},
    {long_range, 33, {0x0060, 0x006E}},
    {long_range, 50, {0x00AD, 0x00C6}},
    {long_range, 100, {0x01CC, 0x01EA}},
    {long_range, 200, {0x02D9, 0x02F8}},
    {long_range, 500, {0x048F, 0x04A4}},
}};

// Valid bits of RESULT__OSC_CALIBRATE_VAL.
constexpr std::uint16_t kOscillatorMask = 0x03FF;

}  // namespace

const ModeRegisters& mode_registers(DistanceMode mode) noexcept {
    switch (mode) {
        case short_range:
            return kShort;
        case medium_range:
            return kMedium;
        case long_range:
            return kLong;
    }
    assert(false && "a distance mode is checked where it is read");
    return kLong;
}

std::optional<DistanceMode> marked_mode(std::uint8_t phasecal_timeout) noexcept {
    for (const DistanceMode mode : {short_range, medium_range, long_range}) {
        if (mode_registers(mode).phasecal_timeout == phasecal_timeout) return mode;
    }
    return std::nullopt;
}

std::optional<RangeTimeouts> range_timeouts(DistanceMode mode, std::uint16_t budget_ms) noexcept {
    for (const BudgetRow& row : kBudgets) {
        if (row.mode == mode && row.budget_ms == budget_ms) return row.timeouts;
    }
    return std::nullopt;
}

std::optional<std::uint16_t> budget_of_timeout_a(std::uint16_t timeout_a) noexcept {
    for (const BudgetRow& row : kBudgets) {
        if (row.timeouts.a == timeout_a) return row.budget_ms;
    }
    return std::nullopt;
}

std::optional<std::uint32_t> period_register(std::uint16_t oscillator, Microseconds nominal) noexcept {
    constexpr std::int64_t kPeriodUsMax =
        3'600'000'000;  // one hour; fits the register at every oscillator value
    static_assert(std::uint64_t{kOscillatorMask} * kPeriodUsMax * 1075 / 1'000'000 <= UINT32_MAX);
    const auto ticks = static_cast<std::uint64_t>(oscillator & kOscillatorMask);
    if (ticks == 0 || nominal.count() <= 0 || nominal.count() > kPeriodUsMax) return std::nullopt;
    const std::uint64_t value =
        ticks * static_cast<std::uint64_t>(nominal.count()) * 1075 / (std::uint64_t{1000} * 1000);
    if (value == 0) return std::nullopt;
    return static_cast<std::uint32_t>(value);
}

std::optional<Nanoseconds> period_step(std::uint16_t oscillator) noexcept {
    const std::int64_t ticks = oscillator & kOscillatorMask;
    if (ticks == 0) return std::nullopt;
    return Nanoseconds{1'000'000'000 / (ticks * 1075)};
}

}  // namespace octoskin::vl53l1x
