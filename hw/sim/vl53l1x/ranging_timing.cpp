#include "hw/sim/vl53l1x/ranging_timing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace octoskin::sim {
namespace {

struct BudgetEntry {
    std::uint8_t vcsel_period_b;
    std::uint16_t timeout_a;
    std::int64_t budget_ms;
};
// ST ULD 3.5.2, VL53L1X_SetTimingBudgetInMs: short mode has VCSEL period B 0x05, long mode 0x0D.
constexpr std::array<BudgetEntry, 13> kBudgets{{{0x05, 0x001D, 15},
                                                {0x05, 0x0051, 20},
                                                {0x05, 0x00D6, 33},
                                                {0x05, 0x01AE, 50},
                                                {0x05, 0x02E1, 100},
                                                {0x05, 0x03E1, 200},
                                                {0x05, 0x0591, 500},
                                                {0x0D, 0x001E, 20},
                                                {0x0D, 0x0060, 33},
                                                {0x0D, 0x00AD, 50},
                                                {0x0D, 0x01CC, 100},
                                                {0x0D, 0x02D9, 200},
                                                {0x0D, 0x048F, 500}}};

std::optional<std::int64_t> tabulated_budget_ms(const Registers& registers) {
    for (const BudgetEntry& entry : kBudgets) {
        if (entry.vcsel_period_b == registers.at(reg::kVcselPeriodB) &&
            entry.timeout_a == read16(registers, reg::kTimeoutA)) {
            return entry.budget_ms;
        }
    }
    return std::nullopt;
}

double timeout_us(const Registers& registers, std::uint16_t timeout_index, std::uint16_t vcsel_index) {
    // Encoding (LSB << MSB) + 1 in macro periods of 2304 VCSEL periods; PLL period 2^30 / f(4.12 MHz), 0.24
    // us (full API).
    const double pll_us =
        std::ldexp(1.0, 30) / read16(registers, reg::kFastOscFrequency) / std::ldexp(1.0, 24);
    const double macro_us = 2304.0 * 2.0 * (registers.at(vcsel_index) + 1) * pll_us;
    const auto exponent = std::min<unsigned>(registers.at(timeout_index), 20U);
    return (std::ldexp(registers.at(timeout_index + 1U), static_cast<int>(exponent)) + 1.0) * macro_us;
}

struct IntegrationPoint {
    double integration_us;
    double budget_us;
};
// ST's rows of long mode: the time of both time-outs at 11.78 MHz, and the nominal budget.
constexpr std::array<IntegrationPoint, 6> kIntegrations{{{6'030.0, 20'000.0},
                                                         {18'980.0, 33'000.0},
                                                         {34'040.0, 50'000.0},
                                                         {80'130.0, 100'000.0},
                                                         {169'950.0, 200'000.0},
                                                         {448'460.0, 500'000.0}}};

// Linear interpolation between ST's rows, and linear extrapolation beyond both ends.
double interpolated_budget_us(double integration_us) {
    std::size_t upper = 1;
    while (upper + 1 < kIntegrations.size() && integration_us > kIntegrations[upper].integration_us) ++upper;
    const IntegrationPoint& low = kIntegrations[upper - 1];
    const IntegrationPoint& high = kIntegrations[upper];
    const double slope = (high.budget_us - low.budget_us) / (high.integration_us - low.integration_us);
    return low.budget_us + slope * (integration_us - low.integration_us);
}

Microseconds budget_of(const Registers& registers) {
    if (const auto tabulated = tabulated_budget_ms(registers)) return Microseconds{*tabulated * 1000};
    constexpr double kOverheadUs = 4528.0;  // Pololu's library, after the full API: without DSS2
    constexpr unsigned kDss2 = 0x10;        // ST ULD's sequence has it
    const double sum = timeout_us(registers, reg::kTimeoutA, reg::kVcselPeriodA) +
                       timeout_us(registers, reg::kTimeoutB, reg::kVcselPeriodB);
    const bool is_uld = (registers.at(reg::kSequenceConfig) & kDss2) != 0;
    const double budget_us = is_uld ? interpolated_budget_us(sum) : sum + kOverheadUs;
    return Microseconds{static_cast<std::int64_t>(std::llround(std::min(budget_us, 2e6)))};
}

}  // namespace

RangingTiming ranging_timing(const Registers& registers, const SensorPart& part) {
    RangingTiming timing{.overhead = part.range_overhead, .budget = budget_of(registers)};
    const double ticks = read32(registers, reg::kInterMeasurement);
    const double slot_us = ticks / std::max<int>(part.osc_calibrate, 1) * 1000.0 / part.slow_clock_factor;
    timing.slot = Microseconds{static_cast<std::int64_t>(std::llround(std::clamp(slot_us, 1000.0, 3.6e9)))};
    timing.period = timing.slot;
    const Microseconds needed = timing.budget + std::max(part.slot_guard, part.range_overhead);
    while (timing.period < needed) timing.period += timing.slot;
    return timing;
}

}  // namespace octoskin::sim
