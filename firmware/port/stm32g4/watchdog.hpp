// The independent watchdog: once started, it resets the chip unless it is refreshed in time.
#pragma once

#include <cstdint>

#include "firmware/core/ports.hpp"

namespace octoskin::stm32g4 {

/// The watchdog's own oscillator runs at about 32 kHz. The limits of a quarter either way are wider than the
/// datasheet's.
inline constexpr std::uint32_t kLsiHzMin = 24'000;
inline constexpr std::uint32_t kLsiHzMax = 40'000;
inline constexpr std::uint32_t kWatchdogDivider = 16;
inline constexpr std::uint32_t kWatchdogCounts = 300;

/// Earliest and latest reset after the last feed, in microseconds.
inline constexpr std::uint32_t kWatchdogUsMin =
    static_cast<std::uint32_t>(std::uint64_t{kWatchdogCounts} * kWatchdogDivider * 1'000'000 / kLsiHzMax);
inline constexpr std::uint32_t kWatchdogUsMax =
    static_cast<std::uint32_t>(std::uint64_t{kWatchdogCounts} * kWatchdogDivider * 1'000'000 / kLsiHzMin);
static_assert(kWatchdogUsMin >= 100'000 && kWatchdogUsMax <= 200'000);

class IndependentWatchdog final : public node::Watchdog {
  public:
    /// Cannot be stopped again. Call at the core's frequency after reset. Waits until the watchdog has loaded
    /// its period: about 0.3 ms, at most 2. If it never does, the first period lasts up to two seconds.
    void start();
    void feed() override;
};

}  // namespace octoskin::stm32g4
