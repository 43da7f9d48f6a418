// Checks the set-up of I2C: pins, clock and timing by the specification of the bus.
#include <fmt/format.h>

#include <algorithm>

#include "hw/sim/stm32g474/peripherals/i2c.hpp"
#include "hw/sim/stm32g474/peripherals/i2c_registers.hpp"

namespace octoskin::sim::stm32 {

using namespace i2c_model;

namespace {

// UM10204 table 10, picoseconds: low and high of the clock.
struct ClockMinima {
    std::int64_t period;
    std::int64_t low;
    std::int64_t high;
};
constexpr ClockMinima kStandard{10'000'000, 4'700'000, 4'000'000};
constexpr ClockMinima kFast{2'500'000, 1'300'000, 600'000};

}  // namespace

std::int64_t I2c::clock_period() const {
    const std::uint32_t timing = bank_.get(kTimingr);
    const std::uint64_t hz = hooks_.kernel_hz();
    const std::uint64_t clocks =
        std::uint64_t{(timing & 0xFFU) + (timing >> 8U & 0xFFU) + 2} * ((timing >> 28U) + 1);
    // Twice filter (50..260 ns) and synchronisation (2..3 clocks), a rise and a fall.
    const std::int64_t edges = edges_ == BusEdges::typical ? 2 * 110'000 + 120'000 + span_of(5, hz)
                                                           : 2 * 260'000 + 600'000 + span_of(6, hz);
    return span_of(clocks, hz) + edges;
}

void I2c::check_start() {
    if (phase_ != Phase::idle && phase_ != Phase::complete) {
        env_.log.report(Rule::start_while_busy, fmt::format("{}: START in the middle of a transfer", name()));
    } else if (phase_ == Phase::idle && is_bus_busy()) {
        env_.log.report(Rule::start_while_busy,
                        fmt::format("{}: START while a line is low: it waits without an event", name()));
    }
    if (is_checked_) return;
    is_checked_ = true;
    if (!hooks_.has_pins()) {
        env_.log.report(Rule::pin_function,
                        fmt::format("{}: START, but its pins are not alternate, open-drain", name()));
    }
    check_timing();
}

// At the fastest: 50 ns of filter, two clocks, no rise time.
void I2c::check_timing() {
    const std::uint32_t timing = bank_.get(kTimingr);
    const std::uint64_t hz = hooks_.kernel_hz();
    const std::uint64_t prescaler = (timing >> 28U) + 1;
    const std::int64_t added = 50'000 + span_of(2, hz);
    const std::int64_t low = span_of(((timing & 0xFFU) + 1) * prescaler, hz) + added;
    const std::int64_t high = span_of(((timing >> 8U & 0xFFU) + 1) * prescaler, hz) + added;
    const ClockMinima& minima = low + high >= kStandard.period ? kStandard : kFast;
    if (low + high < kFast.period || low < minima.low || high < minima.high) {
        env_.log.report(Rule::bus_timing, fmt::format("{}.TIMINGR=0x{:08X} at {} Hz: low {} ns, high {} ns",
                                                      name(), timing, hz, low / 1000, high / 1000));
    }
}

}  // namespace octoskin::sim::stm32
