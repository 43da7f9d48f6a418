#include "hw/sim/stm32g474/peripherals/rcc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kCr = 0x00;
constexpr std::uint32_t kCfgr = 0x08;
constexpr std::uint32_t kPllcfgr = 0x0C;
constexpr std::uint32_t kCifr = 0x1C;
constexpr std::uint32_t kCicr = 0x20;
constexpr std::uint32_t kAhb1Rstr = 0x28;
constexpr std::uint32_t kApb2Rstr = 0x40;
constexpr std::uint32_t kResetToEnable = 0x20;
constexpr std::uint32_t kCcipr = 0x88;
constexpr std::uint32_t kCsr = 0x94;
constexpr std::uint32_t kCcipr2 = 0x9C;

// RCC_CR's value after reset is 0x500 (HSION, HSIRDY); ST's register description says 0x63.
constexpr RegisterSpec kRegisters[] = {
    {0x00, "CR", 0x0000'0500, 0x010D'0300},
    {0x04, "ICSCR", 0x4000'0000, 0x7F00'0000},
    {0x08, "CFGR", 0x0000'0005, 0x7F00'3FF3},
    {0x0C, "PLLCFGR", 0x0000'1000, 0xFF73'7FF3},
    {0x18, "CIER", 0, 0x0000'063B},
    {0x1C, "CIFR", 0, 0},
    {0x20, "CICR", 0, 0x0000'073B},
    {0x28, "AHB1RSTR", 0, 0x0000'111F},
    {0x2C, "AHB2RSTR", 0, 0x050F'607F},
    {0x30, "AHB3RSTR", 0, 0x0000'0101},
    {0x38, "APB1RSTR1", 0, 0xD2FE'C13F},
    {0x3C, "APB1RSTR2", 0, 0x0000'0103},
    {0x40, "APB2RSTR", 0, 0x0437'F801},
    {0x48, "AHB1ENR", 0x0000'0100, 0x0000'111F},
    {0x4C, "AHB2ENR", 0, 0x050F'607F},
    {0x50, "AHB3ENR", 0, 0x0000'0101},
    {0x58, "APB1ENR1", 0x0000'0400, 0xD2FE'CD3F},
    {0x5C, "APB1ENR2", 0, 0x0000'0103},
    {0x60, "APB2ENR", 0, 0x0437'F801},
    {0x68, "AHB1SMENR", 0x0000'130F, 0x0000'131F},
    {0x6C, "AHB2SMENR", 0x050F'667F, 0x050F'667F},
    {0x70, "AHB3SMENR", 0x0000'0101, 0x0000'0101},
    {0x78, "APB1SMENR1", 0xD2FE'CD3F, 0xD2FE'CD3F},
    {0x7C, "APB1SMENR2", 0x0000'0103, 0x0000'0103},
    {0x80, "APB2SMENR", 0x0437'F801, 0x0437'F801},
    {0x88, "CCIPR", 0, 0xFFFF'FFFF},
    {0x90, "BDCR", 0, 0x0301'833D},
    {0x94, "CSR", 0x0C00'0000, 0x0080'0001},
    {0x98, "CRRCR", 0, 0x0000'0001},
    {0x9C, "CCIPR2", 0, 0x0030'0003},
};

constexpr std::uint32_t kHsiHz = 16'000'000;
constexpr std::uint32_t kHseHz = 24'000'000;
// CR
constexpr std::uint32_t kHsiOn = 8;
constexpr std::uint32_t kHseOn = 16;
constexpr std::uint32_t kHseReady = 17;
constexpr std::uint32_t kCssOn = 19;
constexpr std::uint32_t kPllOn = 24;
constexpr std::uint32_t kPllReady = 25;
// PLLCFGR
constexpr std::uint32_t kPllqEnable = 20;
constexpr std::uint32_t kPllrEnable = 24;
constexpr std::uint32_t kSourceHsi = 2;
constexpr std::uint32_t kSourceHse = 3;
// CFGR.SW
constexpr std::uint32_t kSwitchHsi = 1;
constexpr std::uint32_t kSwitchHse = 2;
constexpr std::uint32_t kSwitchPll = 3;
constexpr std::uint32_t kCssFlag = 1U << 8;

constexpr std::int64_t kPllLock = 40 * kPsPerUs;  // DS12288: at most 40 us
constexpr std::int64_t kLsiStart = 130 * kPsPerUs;
constexpr std::int64_t kStepPause = kPsPerUs;
constexpr std::uint32_t kStepAbove = 80'000'000;  // RM0440 7.2.7
constexpr std::uint32_t kSysclkMax = 170'000'000;

}  // namespace

Rcc::Rcc(const Surroundings& surroundings, const Crystal& crystal, Hooks hooks)
    : env_(surroundings), crystal_(crystal), hooks_(std::move(hooks)), bank_("RCC", kRegisters, env_.log) {}

void Rcc::reset() {
    const std::uint32_t csr = bank_.get(kCsr);
    bank_.reset();
    bank_.set(kCsr, csr);  // only software and power-up change it
    crystal_ready_at_ = pll_ready_at_ = kNever;
    is_stopped_ = false;
}

void Rcc::note_reset(ResetFlag flag) {
    // The chip pulls its own reset pin for every cause.
    bank_.set_bits(kCsr,
                   1U << static_cast<std::uint32_t>(flag) | 1U << static_cast<std::uint32_t>(ResetFlag::pin));
}

bool Rcc::is_enabled(ClockEnable enable) const {
    return is_set(enable.offset, enable.bit);
}

std::uint32_t Rcc::read(std::uint32_t offset) {
    return bank_.read(offset);
}

void Rcc::advance() {
    if (env_.now >= crystal_.fails_at && crystal_.is_present) {
        crystal_.is_present = false;
        crystal_.fails_at = kNever;
        lose_crystal();
    }
    if (env_.now >= crystal_.returns_at) {
        crystal_.returns_at = kNever;
        crystal_.is_present = true;
        if (is_set(kCr, kHseOn)) crystal_ready_at_ = env_.now + crystal_.starts_in.ps;
    }
    if (env_.now >= crystal_ready_at_) {
        crystal_ready_at_ = kNever;
        bank_.set_bits(kCr, 1U << kHseReady);
    }
    if (env_.now >= pll_ready_at_) {
        pll_ready_at_ = kNever;
        bank_.set_bits(kCr, 1U << kPllReady);
    }
    if (env_.now >= lsi_ready_at_) {
        lsi_ready_at_ = kNever;
        bank_.set_bits(kCsr, 2);
    }
}

BoardTime Rcc::next_event() const {
    const BoardTime failure = crystal_.is_present ? crystal_.fails_at : kNever;
    return std::min({crystal_ready_at_, pll_ready_at_, lsi_ready_at_, failure, crystal_.returns_at});
}

// RM0440 7.2.11: with the security system on, the core falls back to the internal oscillator and gets an NMI.
void Rcc::lose_crystal() {
    crystal_ready_at_ = kNever;
    if (!is_set(kCr, kHseReady)) return;
    const bool is_pll_fed = field(kPllcfgr, 0, 2) == kSourceHse && is_set(kCr, kPllOn);
    const std::uint32_t source = field(kCfgr, 2, 2);
    const bool is_core_fed = source == kSwitchHse || (source == kSwitchPll && is_pll_fed);
    hooks_.before_change();
    bank_.clear_bits(kCr, 1U << kHseReady);
    if (is_set(kCr, kCssOn)) {
        bank_.clear_bits(kCr, 1U << kHseOn | 1U << kCssOn);
        if (is_pll_fed) bank_.clear_bits(kCr, 1U << kPllOn | 1U << kPllReady);
        if (is_core_fed) bank_.set(kCfgr, (bank_.get(kCfgr) & ~0xFU) | kSwitchHsi << 2U | kSwitchHsi);
        bank_.set_bits(kCifr, kCssFlag);
        env_.lines.pend_nmi();
    } else {
        if (is_pll_fed) bank_.clear_bits(kCr, 1U << kPllReady);
        is_stopped_ = is_core_fed;
    }
    hooks_.after_change();
}

void Rcc::write(std::uint32_t offset, std::uint32_t value) {
    if (offset == kCr) {
        write_control(value);
    } else if (offset == kCfgr) {
        write_configuration(value);
    } else if (offset == kPllcfgr) {
        write_pll(value);
    } else if (offset == kCicr) {
        (void)bank_.checked(offset, value);
        bank_.clear_bits(kCifr, value);
    } else if (offset >= kAhb1Rstr && offset <= kApb2Rstr) {
        write_resets(offset, value);
    } else if (offset == kCsr) {
        const std::uint32_t stored = bank_.checked(offset, value);
        bank_.set(kCsr, stored);
        if ((stored >> 23U & 1U) != 0) bank_.clear_bits(kCsr, 0xFE00'0000);  // RMVF
        if ((stored & 1U) != 0 && (stored & 2U) == 0) lsi_ready_at_ = env_.now + kLsiStart;
        if ((stored & 1U) == 0) bank_.clear_bits(kCsr, 2);
    } else {
        hooks_.before_change();
        bank_.write(offset, value);
        hooks_.after_change();
    }
}

void Rcc::write_resets(std::uint32_t offset, std::uint32_t value) {
    const std::uint32_t before = bank_.get(offset);
    bank_.write(offset, value);
    const std::uint32_t set = bank_.get(offset) & ~before;
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
        if ((set >> bit & 1U) != 0) hooks_.reset_peripheral({offset + kResetToEnable, bit});
    }
}

void Rcc::write_control(std::uint32_t value) {
    std::uint32_t stored = bank_.checked(kCr, value);
    const auto turns = [&](std::uint32_t bit, bool on) {
        return is_set(kCr, bit) != on && ((stored >> bit & 1U) != 0) == on;
    };
    const std::uint32_t source = field(kCfgr, 2, 2);
    const bool is_pll_used = source == kSwitchPll;
    const bool is_crystal_used = source == kSwitchHse || (is_pll_used && field(kPllcfgr, 0, 2) == kSourceHse);
    const auto keep = [&](std::uint32_t bit, const char* what) {
        env_.log.report(Rule::clock_tree,
                        fmt::format("RCC.CR: {} switched off while it clocks the core", what));
        stored |= 1U << bit;
    };
    if (turns(kPllOn, false) && is_pll_used) keep(kPllOn, "PLL");
    if (turns(kHseOn, false) && is_crystal_used) keep(kHseOn, "HSE");
    if (turns(kHsiOn, false) && source == kSwitchHsi) keep(kHsiOn, "HSI");
    if (turns(kHseOn, true) && crystal_.is_present) crystal_ready_at_ = env_.now + crystal_.starts_in.ps;
    if (turns(kHseOn, false)) {
        crystal_ready_at_ = kNever;
        stored &= ~(1U << kHseReady);
    }
    const bool starts_pll = turns(kPllOn, true);
    if (turns(kPllOn, false)) {
        pll_ready_at_ = kNever;
        stored &= ~(1U << kPllReady);
    }
    bank_.set(kCr, stored);
    if (starts_pll) {
        check_pll();
        if (pll_input_hz() != 0) pll_ready_at_ = env_.now + kPllLock;
    }
}

void Rcc::write_pll(std::uint32_t value) {
    if (is_set(kCr, kPllOn)) {
        constexpr std::uint32_t kOutputEnables = 1U << 16 | 1U << kPllqEnable | 1U << kPllrEnable;
        if (((value ^ bank_.get(kPllcfgr)) & ~kOutputEnables) != 0) {
            env_.log.report(Rule::clock_tree, "RCC.PLLCFGR written while the PLL is on");
            return;
        }
    }
    hooks_.before_change();
    bank_.write(kPllcfgr, value);
    hooks_.after_change();
}

void Rcc::check_pll() {
    const std::uint32_t source = field(kPllcfgr, 0, 2);
    const std::uint32_t input = pll_input_hz();
    if (source < kSourceHsi || input == 0) {
        env_.log.report(Rule::clock_tree, "PLL started without a ready source");
        return;
    }
    const std::uint32_t n = field(kPllcfgr, 8, 7);
    if (n < 8 || n > 127) env_.log.report(Rule::clock_tree, fmt::format("PLLN={}", n));
    const std::uint32_t divided = input / (field(kPllcfgr, 4, 4) + 1);
    if (divided < 2'660'000 || divided > 16'000'000)
        env_.log.report(Rule::clock_tree, fmt::format("PLL input {} Hz, not 2.66..16 MHz", divided));
    if (vco_hz() < 96'000'000 || vco_hz() > 344'000'000)
        env_.log.report(Rule::clock_tree, fmt::format("VCO {} Hz, not 96..344 MHz", vco_hz()));
}

void Rcc::write_configuration(std::uint32_t value) {
    std::uint32_t stored = bank_.checked(kCfgr, value);
    const std::uint32_t wanted = stored & 3U;
    const std::uint32_t present = field(kCfgr, 2, 2);
    const bool is_ready = (wanted == kSwitchHsi && is_set(kCr, 10)) ||
                          (wanted == kSwitchHse && is_set(kCr, kHseReady)) ||
                          (wanted == kSwitchPll && is_set(kCr, kPllReady) && is_set(kPllcfgr, kPllrEnable));
    if (!is_ready) {
        env_.log.report(Rule::clock_tree, fmt::format("RCC.CFGR.SW={}: that source is not ready", wanted));
        stored = (stored & ~3U) | present;
    }
    const std::uint32_t hclk_before = hclk_hz();
    const std::uint32_t divider_before = ahb_divider();
    hooks_.before_change();
    const std::uint32_t shown = wanted == kSwitchPll && refuses_pll_ ? present : stored & 3U;
    bank_.set(kCfgr, (stored & ~0xCU) | shown << 2U);
    check_step(hclk_before, divider_before, present != shown);
    hooks_.after_change();
}

// RM0440 7.2.7: from below to above 80 MHz only by way of HPRE = /2, for at least 1 us.
void Rcc::check_step(std::uint32_t hclk_before, std::uint32_t divider_before, bool has_switched) {
    if (sysclk_hz() > kSysclkMax)
        env_.log.report(Rule::clock_tree, fmt::format("SYSCLK {} Hz > 170 MHz", sysclk_hz()));
    const bool is_fast = hclk_hz() > kStepAbove;
    if (has_switched) switched_to_pll_at_ = env_.now;
    if (has_switched && is_fast && hclk_before <= kStepAbove) {
        env_.log.report(Rule::clock_tree, "SYSCLK switched to above 80 MHz without HPRE = /2 in between");
    }
    if (!has_switched && is_fast && divider_before > 1 && ahb_divider() == 1 &&
        env_.now < switched_to_pll_at_ + kStepPause) {
        env_.log.report(Rule::clock_tree, "HPRE = /1 less than 1 us after the switch to above 80 MHz");
    }
}

std::uint32_t Rcc::pll_input_hz() const {
    const std::uint32_t source = field(kPllcfgr, 0, 2);
    if (source == kSourceHsi) return kHsiHz;
    return source == kSourceHse && is_set(kCr, kHseReady) ? kHseHz : 0;
}

std::uint32_t Rcc::vco_hz() const {
    const std::uint64_t input = pll_input_hz();
    return static_cast<std::uint32_t>(input * field(kPllcfgr, 8, 7) / (field(kPllcfgr, 4, 4) + 1));
}

std::uint32_t Rcc::pll_output_hz(std::uint32_t divider_position) const {
    return vco_hz() / (2 * (field(kPllcfgr, divider_position, 2) + 1));
}

std::uint32_t Rcc::sysclk_hz() const {
    switch (field(kCfgr, 2, 2)) {
        case kSwitchHse:
            return kHseHz;
        case kSwitchPll:
            return pll_output_hz(25);
        default:
            return kHsiHz;
    }
}

std::uint32_t Rcc::ahb_divider() const {
    constexpr std::uint32_t kDividers[] = {2, 4, 8, 16, 64, 128, 256, 512};
    const std::uint32_t code = field(kCfgr, 4, 4);
    return code < 8 ? 1 : kDividers[code - 8];
}

std::uint32_t Rcc::hclk_hz() const {
    return sysclk_hz() / ahb_divider();
}

std::uint32_t Rcc::pclk1_hz() const {
    const std::uint32_t code = field(kCfgr, 8, 3);
    return code < 4 ? hclk_hz() : hclk_hz() >> (code - 3);
}

std::uint32_t Rcc::timer1_hz() const {
    return field(kCfgr, 8, 3) < 4 ? pclk1_hz() : 2 * pclk1_hz();
}

std::uint32_t Rcc::i2c_hz(std::uint32_t number) const {
    const std::uint32_t select = number == 4 ? field(kCcipr2, 0, 2) : field(kCcipr, 10 + 2 * number, 2);
    if (select == 1) return sysclk_hz();
    return select == 2 ? kHsiHz : pclk1_hz();
}

std::uint32_t Rcc::fdcan_hz() const {
    switch (field(kCcipr, 24, 2)) {
        case 0:
            return is_set(kCr, kHseReady) ? kHseHz : 0;
        case 1:
            return is_set(kCr, kPllReady) && is_set(kPllcfgr, kPllqEnable) ? pll_output_hz(21) : 0;
        default:
            return pclk1_hz();
    }
}

bool Rcc::is_fdcan_from_crystal() const {
    const std::uint32_t select = field(kCcipr, 24, 2);
    const std::uint32_t source = field(kCfgr, 2, 2);
    const bool is_pll_from_crystal = field(kPllcfgr, 0, 2) == kSourceHse && is_set(kCr, kHseReady);
    if (select == 0) return is_set(kCr, kHseReady);
    if (select == 1) return is_pll_from_crystal;
    return source == kSwitchHse || (source == kSwitchPll && is_pll_from_crystal);
}

std::uint32_t Rcc::lpuart_hz() const {
    switch (field(kCcipr, 10, 2)) {
        case 0:
            return pclk1_hz();
        case 1:
            return sysclk_hz();
        case 2:
            return kHsiHz;
        default:
            return 32'768;
    }
}

}  // namespace octoskin::sim::stm32
