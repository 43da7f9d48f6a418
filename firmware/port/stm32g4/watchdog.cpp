#include "firmware/port/stm32g4/watchdog.hpp"

#include "firmware/port/stm32g4/registers/timer.hpp"

namespace octoskin::stm32g4 {

namespace {
constexpr std::uint32_t kStart = 0xCCCC;  // RM0440, IWDG_KR
constexpr std::uint32_t kUnlock = 0x5555;
constexpr std::uint32_t kRefresh = 0xAAAA;
constexpr std::uint32_t kDivideBy16 = 2;  // IWDG_PR
static_assert(kWatchdogDivider == 16);
}  // namespace

void IndependentWatchdog::start() {
    iwdg.write("KR", kStart);
    iwdg.write("KR", kUnlock);
    iwdg.write("PR", kDivideBy16);
    iwdg.write("RLR", kWatchdogCounts - 1);
    feed();
}

void IndependentWatchdog::feed() {
    iwdg.write("KR", kRefresh);
}

}  // namespace octoskin::stm32g4
