#include "firmware/port/stm32g4/watchdog.hpp"

#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/registers/timer.hpp"

namespace octoskin::stm32g4 {

namespace {
constexpr std::uint32_t kStart = 0xCCCC;  // RM0440, IWDG_KR
constexpr std::uint32_t kUnlock = 0x5555;
constexpr std::uint32_t kRefresh = 0xAAAA;
constexpr std::uint32_t kDivideBy16 = 2;  // IWDG_PR
static_assert(kWatchdogDivider == 16);

// At the 16 MHz that the core has after reset: looks every 10 us, for 2 ms at most. Five periods of the slow
// clock (RM0440) after its start are a fifth of that.
constexpr std::uint32_t kTurnCycles = 160;
constexpr std::uint32_t kUpdateTurns = 200;

bool is_updating() {
    using F = Field<IwdgMap>;
    const std::uint32_t status = iwdg.read("SR");
    return F("SR.PVU").of(status) != 0 || F("SR.RVU").of(status) != 0;
}
}  // namespace

void IndependentWatchdog::start() {
    iwdg.write("KR", kStart);
    iwdg.write("KR", kUnlock);
    iwdg.write("PR", kDivideBy16);
    iwdg.write("RLR", kWatchdogCounts - 1);
    // The slow clock takes the new values over within a few of its periods. A feed before that loads the old
    // ones: the first period could last up to two seconds.
    for (std::uint32_t turns = 0; is_updating() && turns < kUpdateTurns; ++turns) cpu::spin(kTurnCycles);
    feed();
}

void IndependentWatchdog::feed() {
    iwdg.write("KR", kRefresh);
}

}  // namespace octoskin::stm32g4
