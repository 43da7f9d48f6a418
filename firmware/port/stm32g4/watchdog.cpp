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

// At the core's 16 MHz after reset: checks every 10 us, for at most 2 ms. Loading the registers takes five
// periods of the slow clock (RM0440) after its start, a fifth of that.
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
    // The watchdog loads the new values within a few periods of the slow clock. A feed before that would load
    // the old ones: the first period could then last up to two seconds.
    for (std::uint32_t turns = 0; is_updating() && turns < kUpdateTurns; ++turns) cpu::spin(kTurnCycles);
    feed();
}

void IndependentWatchdog::feed() {
    iwdg.write("KR", kRefresh);
}

}  // namespace octoskin::stm32g4
