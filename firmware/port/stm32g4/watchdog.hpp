// The independent watchdog: once started it resets the chip unless refreshed in time.
#pragma once

#include <cstdint>

#include "firmware/core/ports.hpp"

namespace octoskin::stm32g4 {

/// The watchdog's own oscillator is about 32 kHz; a quarter off either way is more than the datasheet allows
/// it.
inline constexpr std::uint32_t kLsiHzMin = 24'000;
inline constexpr std::uint32_t kLsiHzMax = 40'000;
inline constexpr std::uint32_t kWatchdogDivider = 16;
inline constexpr std::uint32_t kWatchdogCounts = 300;

/// It bites after this many microseconds at the earliest and at the latest.
inline constexpr std::uint32_t kWatchdogUsMin =
    static_cast<std::uint32_t>(std::uint64_t{kWatchdogCounts} * kWatchdogDivider * 1'000'000 / kLsiHzMax);
inline constexpr std::uint32_t kWatchdogUsMax =
    static_cast<std::uint32_t>(std::uint64_t{kWatchdogCounts} * kWatchdogDivider * 1'000'000 / kLsiHzMin);
static_assert(kWatchdogUsMin >= 100'000 && kWatchdogUsMax <= 200'000);

class IndependentWatchdog final : public node::Watchdog {
  public:
    /// Cannot be undone. Call at the speed that the core has after reset. Waits until the slow clock took the
    /// period over: about 0.3 ms, at most 2; should it never do so, the first period lasts up to two seconds.
    void start();
    void feed() override;
};

}  // namespace octoskin::stm32g4
