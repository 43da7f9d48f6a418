#include "hw/sim/stm32g474/cpu/system_control.hpp"

#include <fmt/format.h>

#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kDwtCtrl = 0xE000'1000;
constexpr std::uint32_t kDwtCyccnt = 0xE000'1004;
constexpr std::uint32_t kIctr = 0xE000'E004;
constexpr std::uint32_t kActlr = 0xE000'E008;
constexpr std::uint32_t kSysTick = 0xE000'E010;
constexpr std::uint32_t kSysTickEnd = 0xE000'E020;
constexpr std::uint32_t kNvic = 0xE000'E100;
constexpr std::uint32_t kNvicEnd = 0xE000'E4F0;
constexpr std::uint32_t kCpuid = 0xE000'ED00;
constexpr std::uint32_t kIcsr = 0xE000'ED04;
constexpr std::uint32_t kVtor = 0xE000'ED08;
constexpr std::uint32_t kAircr = 0xE000'ED0C;
constexpr std::uint32_t kScr = 0xE000'ED10;
constexpr std::uint32_t kCcr = 0xE000'ED14;
constexpr std::uint32_t kShpr1 = 0xE000'ED18;
constexpr std::uint32_t kShprEnd = 0xE000'ED24;
constexpr std::uint32_t kShcsr = 0xE000'ED24;
constexpr std::uint32_t kCfsr = 0xE000'ED28;
constexpr std::uint32_t kHfsr = 0xE000'ED2C;
constexpr std::uint32_t kDfsr = 0xE000'ED30;
constexpr std::uint32_t kMmfar = 0xE000'ED34;
constexpr std::uint32_t kBfar = 0xE000'ED38;
constexpr std::uint32_t kAfsr = 0xE000'ED3C;
constexpr std::uint32_t kCpacr = 0xE000'ED88;
constexpr std::uint32_t kDhcsr = 0xE000'EDF0;
constexpr std::uint32_t kDemcr = 0xE000'EDFC;
constexpr std::uint32_t kStir = 0xE000'EF00;
constexpr std::uint32_t kFpccr = 0xE000'EF34;
constexpr std::uint32_t kFpcar = 0xE000'EF38;
constexpr std::uint32_t kFpdscr = 0xE000'EF3C;

constexpr std::uint32_t kFlashBase = 0x0800'0000;
constexpr std::uint32_t kCcrReset = 0x200;          // STKALIGN
constexpr std::uint32_t kFpccrReset = 0xC000'0000;  // ASPEN, LSPEN

}  // namespace

SystemControl::SystemControl(const BoardTime& now, ViolationLog& log, SystemControlHooks hooks)
    : log_(log),
      hooks_(std::move(hooks)),
      nvic_(log),
      systick_(now, log, hooks_.hclk_hz, [this] { nvic_.pend(exception::kSysTick); }) {
    reset();
}

void SystemControl::reset() {
    nvic_.reset();
    systick_.reset();
    // Address 0 is an alias of the flash at reset; here the flash's own address is used.
    vtor_ = kFlashBase;
    ccr_ = kCcrReset;
    fpccr_ = kFpccrReset;
    scr_ = cfsr_ = hfsr_ = bfar_ = cpacr_ = fpdscr_ = demcr_ = actlr_ = dwt_control_ = 0;
}

void SystemControl::note_bus_fault_address(std::uint32_t address) noexcept {
    bfar_ = address;
    cfsr_ |= cfsr::kBusFaultAddressValid;
}

std::uint32_t SystemControl::read(std::uint32_t address, std::uint32_t size) {
    const std::uint32_t word = read_word(address & ~3U);
    const std::uint32_t shifted = word >> (8 * (address & 3U));
    return size == 4 ? shifted : shifted & ((1U << (8 * size)) - 1U);
}

std::uint32_t SystemControl::read_word(std::uint32_t address) {
    if (address >= kSysTick && address < kSysTickEnd) {
        systick_.advance();
        return systick_.read(address - kSysTick);
    }
    if (address >= kNvic && address < kNvicEnd) return nvic_.read_register(address & 0xFFFU);
    if (address >= kShpr1 && address < kShprEnd) {
        std::uint32_t value = 0;
        for (std::uint32_t byte = 0; byte < 4; ++byte) {
            value |= std::uint32_t{nvic_.priority_byte(4 + address - kShpr1 + byte)} << (8 * byte);
        }
        return value;
    }
    switch (address) {
        case kDwtCtrl:
            return 0x4000'0000 | dwt_control_;
        case kDwtCyccnt:
            return (dwt_control_ & 1U) != 0 ? static_cast<std::uint32_t>(hooks_.cycles() - cycle_zero_)
                                            : static_cast<std::uint32_t>(cycle_zero_);
        case kIctr:
            return 3;  // 97..128 interrupts
        case kActlr:
            return actlr_;
        case kCpuid:
            return 0x410F'C241;  // Cortex-M4 r0p1
        case kIcsr:
            return interrupt_control_state();
        case kVtor:
            return vtor_;
        case kAircr:
            return 0xFA05'0000 | nvic_.priority_group() << 8U;
        case kScr:
            return scr_;
        case kCcr:
            return ccr_;
        case kShcsr:
            return (nvic_.is_enabled(exception::kMemManage) ? 1U << 16 : 0U) |
                   (nvic_.is_enabled(exception::kBusFault) ? 1U << 17 : 0U) |
                   (nvic_.is_enabled(exception::kUsageFault) ? 1U << 18 : 0U);
        case kCfsr:
            return cfsr_;
        case kHfsr:
            return hfsr_;
        case kDfsr:
        case kMmfar:
        case kAfsr:
        case kDhcsr:  // no debugger
        case kFpcar:
            return 0;
        case kBfar:
            return bfar_;
        case kCpacr:
            return cpacr_;
        case kDemcr:
            return demcr_;
        case kFpccr:
            return fpccr_;
        case kFpdscr:
            return fpdscr_;
        default:
            log_.report(Rule::not_modelled, fmt::format("core register 0x{:08X} read", address));
            return 0;
    }
}

std::uint32_t SystemControl::interrupt_control_state() const {
    std::uint32_t value = nvic_.first_pending() << 12U;
    for (std::uint32_t number = 1; number < kExceptionCount; ++number) {
        if (number >= 16 && nvic_.is_pending(number)) value |= 1U << 22;
        if (nvic_.is_active(number) && nvic_.group_priority(number) == nvic_.active_priority()) {
            value = (value & ~0x1FFU) | number;
        }
    }
    if (nvic_.active_count() <= 1) value |= 1U << 11;  // RETTOBASE
    if (nvic_.is_pending(exception::kSysTick)) value |= 1U << 26;
    if (nvic_.is_pending(exception::kPendSv)) value |= 1U << 28;
    if (nvic_.is_pending(exception::kNmi)) value |= 1U << 31;
    return value;
}

void SystemControl::write(std::uint32_t address, std::uint32_t value, std::uint32_t size) {
    if (address >= kNvic && address < kNvicEnd) {
        nvic_.write_register(address & 0xFFFU, value, size);
    } else if (address >= kShpr1 && address < kShprEnd) {
        write_system_priority(address, value, size);
    } else if (size != 4) {
        log_.report(Rule::access_width, fmt::format("core register 0x{:08X}: {}-byte write", address, size));
    } else if (address >= kSysTick && address < kSysTickEnd) {
        systick_.advance();
        systick_.write(address - kSysTick, value);
    } else {
        write_word(address, value);
    }
}

void SystemControl::write_system_priority(std::uint32_t address, std::uint32_t value, std::uint32_t size) {
    for (std::uint32_t byte = 0; byte < size; ++byte) {
        nvic_.set_priority(4 + address - kShpr1 + byte, static_cast<std::uint8_t>(value >> (8 * byte)));
    }
}

void SystemControl::write_word(std::uint32_t address, std::uint32_t value) {
    switch (address) {
        case kDwtCtrl:
            if ((demcr_ >> 24U & 1U) == 0)
                log_.report(Rule::wrong_state, "DWT.CTRL written with DEMCR.TRCENA=0");
            if ((value & 1U) != dwt_control_) cycle_zero_ = hooks_.cycles() - cycle_zero_;
            dwt_control_ = value & 1U;
            break;
        case kDwtCyccnt:
            cycle_zero_ = (dwt_control_ & 1U) != 0 ? hooks_.cycles() - value : value;
            break;
        case kActlr:
            actlr_ = value;
            break;
        case kIcsr:
            write_interrupt_control_state(value);
            break;
        case kVtor:
            write_vector_table(value);
            break;
        case kAircr:
            write_application_interrupt(value);
            break;
        case kScr:
            if ((value & 4U) != 0) log_.report(Rule::not_modelled, "SCB.SCR.SLEEPDEEP: Stop modes");
            scr_ = value & 0x16U;
            break;
        case kCcr:
            ccr_ = value;
            break;
        case kShcsr:
            write_handler_control(value);
            break;
        case kCfsr:
            cfsr_ &= ~value;
            break;
        case kHfsr:
            hfsr_ &= ~value;
            break;
        case kDfsr:
        case kAfsr:
        case kMmfar:
            break;
        case kBfar:
            bfar_ = value;
            break;
        case kCpacr:
            cpacr_ = value & 0x00F0'0000U;
            break;
        case kDemcr:
            demcr_ = value;
            break;
        case kStir:
            nvic_.pend(16 + (value & 0x1FFU));
            break;
        case kFpccr:
            if ((value & 0x8000'0000U) == 0) log_.report(Rule::not_modelled, "FPCCR.ASPEN=0");
            fpccr_ = value;
            break;
        case kFpdscr:
            fpdscr_ = value;
            break;
        default:
            log_.report(Rule::not_modelled,
                        fmt::format("core register 0x{:08X}: write of 0x{:X}", address, value));
    }
}

void SystemControl::write_vector_table(std::uint32_t value) {
    if ((value & 0x1FFU) != 0) {  // 118 words: the next power of two is 512 bytes
        log_.report(Rule::exception_model, fmt::format("VTOR=0x{:08X} is not a multiple of 512", value));
    }
    vtor_ = value & ~0x1FFU;
}

void SystemControl::write_interrupt_control_state(std::uint32_t value) {
    if ((value >> 31U & 1U) != 0) nvic_.pend(exception::kNmi);
    if ((value >> 28U & 1U) != 0) nvic_.pend(exception::kPendSv);
    if ((value >> 27U & 1U) != 0) nvic_.unpend(exception::kPendSv);
    if ((value >> 26U & 1U) != 0) nvic_.pend(exception::kSysTick);
    if ((value >> 25U & 1U) != 0) nvic_.unpend(exception::kSysTick);
}

void SystemControl::write_application_interrupt(std::uint32_t value) {
    if (value >> 16U != 0x05FA) {
        log_.report(Rule::wrong_state, fmt::format("AIRCR=0x{:08X} without its key: ignored", value));
        return;
    }
    nvic_.set_priority_group(value >> 8U & 7U);
    if ((value & 4U) != 0) hooks_.request_reset();
}

void SystemControl::write_handler_control(std::uint32_t value) {
    nvic_.enable_fault(exception::kMemManage, (value >> 16U & 1U) != 0);
    nvic_.enable_fault(exception::kBusFault, (value >> 17U & 1U) != 0);
    nvic_.enable_fault(exception::kUsageFault, (value >> 18U & 1U) != 0);
}

}  // namespace octoskin::sim::stm32
