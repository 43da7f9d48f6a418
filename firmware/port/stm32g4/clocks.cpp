#include "firmware/port/stm32g4/clocks.hpp"

#include "firmware/port/stm32g4/clock_plan.hpp"
#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"

namespace octoskin::stm32g4 {

namespace {

constexpr Microseconds kCrystalLimit{
    50'000};  // crystals of this size start within 2 ms; a slow one is accepted, too
constexpr Microseconds kLockLimit{1'000};  // the PLL locks within 40 us
constexpr Microseconds kSwitchLimit{1'000};

constexpr std::uint32_t kSelectInternal = 1;  // CFGR.SW
constexpr std::uint32_t kSelectCrystal = 2;
constexpr std::uint32_t kSelectPll = 3;
constexpr std::uint32_t kHalfSpeed = 8;      // CFGR.HPRE: divided by 2
constexpr std::uint32_t kFullSpeed = 0;      // CFGR.HPRE: not divided
constexpr std::uint32_t kCanFromPllq = 1;    // CCIPR.FDCANSEL
constexpr std::uint32_t kPowerRangeOne = 1;  // PWR_CR1.VOS

/// Waits until `field` has `value`. False after `limit`.
bool shows(const MicrosecondTimer& timer, Field<RccMap> field, std::uint32_t value, Microseconds limit) {
    const NodeTime begun = timer.now();
    while (rcc.get(field) != value) {
        if (elapsed(begun, timer.now()) > limit) return false;
    }
    return true;
}

void raise_core_voltage() {
    rcc.set("APB1ENR1.PWREN", 1);
    (void)rcc.read("APB1ENR1");  // the enable takes two clocks
    // Without this, PB4 and PB6 keep USB-C's dead-battery pull-downs of 5.1 kOhm.
    pwr.set("CR3.UCPD1_DBDIS", 1);
    pwr.set("CR1.VOS", kPowerRangeOne);
    pwr.set("CR5.R1MODE", 0);  // boost: above 150 MHz
}

bool start_crystal(const MicrosecondTimer& timer) {
    rcc.set("CR.HSEON", 1);
    if (shows(timer, "CR.HSERDY", 1, kCrystalLimit)) return true;
    rcc.set("CR.HSEON", 0);
    return false;
}

bool lock_pll(const MicrosecondTimer& timer, const ClockPlan& plan) {
    rcc.set("CR.PLLON", 0);
    if (!shows(timer, "CR.PLLRDY", 0, kLockLimit)) return false;
    rcc.write("PLLCFGR", plan.pllcfgr());
    rcc.set("CR.PLLON", 1);
    return shows(timer, "CR.PLLRDY", 1, kLockLimit);
}

bool prepare_flash(const MicrosecondTimer& timer, std::uint32_t core_hz) {
    const std::uint32_t wait_states = flash_wait_states(core_hz);
    // Field by field: the register also holds DBG_SWEN, and a 0 there disables the debugger.
    flash.set("ACR.LATENCY", wait_states);
    flash.set("ACR.PRFTEN", 1);
    flash.set("ACR.ICEN", 1);
    flash.set("ACR.DCEN", 1);
    const NodeTime begun = timer.now();
    while (flash.get("ACR.LATENCY") != wait_states) {
        if (elapsed(begun, timer.now()) > kSwitchLimit) return false;
    }
    return true;
}

/// Above 80 MHz the switch from a low frequency must run at half the target for a microsecond (RM0440).
bool switch_to_pll(MicrosecondTimer& timer, const ClockPlan& plan) {
    rcc.set("CFGR.PPRE1", 0);
    rcc.set("CFGR.PPRE2", 0);
    rcc.set("CFGR.HPRE", kHalfSpeed);
    rcc.set("CFGR.SW", kSelectPll);
    if (!shows(timer, "CFGR.SWS", kSelectPll, kSwitchLimit)) return false;
    timer.start(plan.core_hz() / 2);
    timer.wait(Microseconds{2});
    rcc.set("CFGR.HPRE", kFullSpeed);
    timer.start(plan.core_hz());
    return true;
}

/// The core's frequency according to the registers.
std::uint32_t core_hz_now(const ClockPlan& plan) {
    const std::uint32_t source = rcc.get("CFGR.SWS");
    const bool is_half = rcc.get("CFGR.HPRE") == kHalfSpeed;
    const std::uint32_t system_hz = source == kSelectPll       ? plan.core_hz()
                                    : source == kSelectCrystal ? kCrystalHz
                                                               : kInternalHz;
    return is_half ? system_hz / 2 : system_hz;
}

/// Returns to the internal oscillator after any failed step.
Clocks fall_back(MicrosecondTimer& timer, const ClockPlan& plan) {
    rcc.set("CFGR.SW", kSelectInternal);
    if (shows(timer, "CFGR.SWS", kSelectInternal, kSwitchLimit)) rcc.set("CFGR.HPRE", kFullSpeed);
    const std::uint32_t core_hz = core_hz_now(plan);
    timer.start(core_hz);
    return {.source = ClockSource::unlocked, .core_hz = core_hz, .can_hz = 0};
}

}  // namespace

Clocks start_clocks(MicrosecondTimer& timer) {
    timer.start(kInternalHz);
    raise_core_voltage();
    const bool has_crystal = start_crystal(timer);
    const ClockPlan& plan = has_crystal ? kCrystalPlan : kInternalPlan;
    if (!lock_pll(timer, plan) || !prepare_flash(timer, plan.core_hz()) || !switch_to_pll(timer, plan)) {
        return fall_back(timer, plan);
    }
    if (!has_crystal) return {.source = ClockSource::internal, .core_hz = plan.core_hz(), .can_hz = 0};
    rcc.set("CR.CSSON", 1);
    rcc.set("CCIPR.FDCANSEL", kCanFromPllq);
    return {.source = ClockSource::crystal, .core_hz = plan.core_hz(), .can_hz = plan.can_hz()};
}

bool is_crystal_running() {
    rcc.set("CR.HSEON", 1);
    return rcc.is_set("CR.HSERDY");
}

}  // namespace octoskin::stm32g4
