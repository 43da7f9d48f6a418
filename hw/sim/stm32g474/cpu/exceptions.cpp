// Exception entry and return, faults and sleep (ARMv7-M ARM B1.5.6 to B1.5.19).
#include <fmt/format.h>
#include <unicorn/unicorn.h>

#include <algorithm>
#include <array>

#include "hw/sim/stm32g474/cpu/cortex_m4.hpp"
#include "hw/sim/stm32g474/cpu/engine_registers.hpp"

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kEntryCycles = 12;
constexpr std::uint32_t kThumb = 1U << 24;
constexpr std::uint32_t kAlignmentNote = 1U << 9;  // stacked xPSR: SP was moved to a multiple of 8
constexpr std::uint32_t kFlags = 0xF000'0000;      // APSR: N, Z, C, V
constexpr std::uint32_t kBasicFrameBytes = 0x20;
constexpr std::uint32_t kFpFrameBytes = 0x68;
constexpr std::uint32_t kExceptionNumber = 0x1FF;

constexpr std::uint32_t kReturnToHandler = 0xFFFF'FFF1;
constexpr std::uint32_t kReturnToThread = 0xFFFF'FFF9;
constexpr std::uint32_t kNoFpFrame = 1U << 4;

constexpr std::size_t kStackedCount = 6;  // of the general registers
constexpr EngineRegisters<kStackedCount> kStacked = {UC_ARM_REG_R0, UC_ARM_REG_R1,  UC_ARM_REG_R2,
                                                     UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR};

}  // namespace

struct CortexM4::Frame {
    std::array<std::uint32_t, kFpFrameBytes / 4> words{};
    std::uint32_t bytes = kBasicFrameBytes;
    std::uint32_t address = 0;
};

ExceptionMasks CortexM4::masks() const {
    const auto [primask, faultmask, basepri] =
        read_registers<3>(engine_, {UC_ARM_REG_PRIMASK, UC_ARM_REG_FAULTMASK, UC_ARM_REG_BASEPRI});
    return {(primask & 1U) != 0, (faultmask & 1U) != 0, static_cast<std::uint8_t>(basepri)};
}

void CortexM4::sleep() {
    if (control_->sleeps_deeply()) log_.report(Rule::not_modelled, "WFI with SLEEPDEEP");
    state_ = CoreState::sleeping;
    longest_awake_ps_ = std::max(longest_awake_ps_, now_.ps - woken_at_.ps);
}

// WFI wakes for an exception that would preempt with PRIMASK clear, also if its handler does not run.
bool CortexM4::is_idle() const {
    if (state_ == CoreState::locked_up) return true;
    if (state_ != CoreState::sleeping) return false;
    if (!control_->nvic().candidate()) return true;
    ExceptionMasks without_primask = masks();
    without_primask.is_primask = false;
    return !control_->nvic().deliverable(without_primask);
}

// Writing XPSR alone leaves the engine's cached mode flags as they were; writing the flags back rebuilds
// them.
void CortexM4::set_program_state(std::uint32_t xpsr, std::uint32_t pc) {
    write_registers<4>(engine_,
                       {UC_ARM_REG_XPSR_NZCVQG, UC_ARM_REG_XPSR, UC_ARM_REG_APSR_NZCV, UC_ARM_REG_PC},
                       {xpsr, xpsr, xpsr & kFlags, pc | 1U});
}

void CortexM4::enter(std::uint32_t number) {
    const auto [sp, control, xpsr, pc] =
        read_registers<4>(engine_, {UC_ARM_REG_SP, UC_ARM_REG_CONTROL, UC_ARM_REG_XPSR, UC_ARM_REG_PC});
    const bool has_fp = (control & kFpContext) != 0;
    check_fpu_use(control);

    Frame frame;
    std::ranges::copy(read_registers(engine_, kStacked), frame.words.begin());
    frame.words[6] = pc;
    frame.bytes = has_fp ? kFpFrameBytes : kBasicFrameBytes;
    if (has_fp) {
        for (int i = 0; i < 16; ++i) frame.words.at(8 + static_cast<std::size_t>(i)) = get(UC_ARM_REG_S0 + i);
        frame.words[24] = get(UC_ARM_REG_FPSCR);
    }
    const bool is_moved = (sp & 4U) != 0;
    frame.address = (sp - frame.bytes) & ~7U;
    frame.words[7] = (xpsr & ~kAlignmentNote) | (is_moved ? kAlignmentNote : 0);

    const bool is_pushed = push(frame);
    set(UC_ARM_REG_CONTROL, control & ~kFpContext);
    if (!is_pushed) {
        // Tail-chaining: the next exception starts without a new frame.
        log_.report(Rule::memory, fmt::format("exception {}: no stack at 0x{:08X}", number, frame.address));
        control_->note_fault(cfsr::kStackingBusError);
        const int priority = control_->nvic().execution_priority(masks());
        const bool takes_bus_fault = control_->nvic().is_enabled(exception::kBusFault) &&
                                     control_->nvic().group_priority(exception::kBusFault) < priority;
        if (priority <= -1) return lock_up("no stack for a fault's frame");
        if (!takes_bus_fault) control_->note_forced_hard_fault();
        number = takes_bus_fault ? exception::kBusFault : exception::kHardFault;
    }
    const bool was_thread = (xpsr & kExceptionNumber) == 0;
    std::uint32_t exc_return = was_thread ? kReturnToThread : kReturnToHandler;
    if (has_fp) exc_return &= ~kNoFpFrame;
    write_registers<2>(engine_, {UC_ARM_REG_SP, UC_ARM_REG_LR}, {frame.address, exc_return});
    std::uint32_t handler = 0;
    uc_mem_read(engine_, control_->vector_table() + 4 * number, &handler, sizeof handler);
    control_->nvic().activate(number);
    if ((handler & 1U) == 0) {
        log_.report(Rule::exception_model,
                    fmt::format("vector {}: 0x{:08X} has no Thumb bit", number, handler));
        return lock_up("a handler without the Thumb bit");
    }
    set_program_state(kThumb | number, handler & ~1U);
    spend(kEntryCycles);
    note_stack(frame.address);
}

bool CortexM4::push(const Frame& frame) {
    return uc_mem_write(engine_, frame.address, frame.words.data(), frame.bytes) == UC_ERR_OK;
}

void CortexM4::leave(std::uint32_t exc_return) {
    Nvic& nvic = control_->nvic();
    const auto [xpsr, control] = read_registers<2>(engine_, {UC_ARM_REG_XPSR, UC_ARM_REG_CONTROL});
    const std::uint32_t number = xpsr & kExceptionNumber;
    const std::uint32_t kind = exc_return | kNoFpFrame;
    const bool is_to_thread = kind == kReturnToThread;
    if ((!is_to_thread && kind != kReturnToHandler) || number == 0 || !nvic.is_active(number) ||
        is_to_thread != (nvic.active_count() == 1)) {
        log_.report(Rule::exception_model, fmt::format("EXC_RETURN 0x{:08X} from exception {} with {} active",
                                                       exc_return, number, nvic.active_count()));
        raise({cfsr::kInvalidReturn, std::nullopt});
        return;
    }
    check_fpu_use(control);
    if (number != exception::kNmi) set(UC_ARM_REG_FAULTMASK, 0);
    nvic.deactivate(number);
    if (!pop(exc_return)) return;
    spend(kEntryCycles);
    if (is_to_thread && control_->sleeps_on_exit()) sleep();
}

bool CortexM4::pop(std::uint32_t exc_return) {
    const bool has_fp = (exc_return & kNoFpFrame) == 0;
    Frame frame;
    frame.address = get(UC_ARM_REG_SP);
    frame.bytes = has_fp ? kFpFrameBytes : kBasicFrameBytes;
    if (uc_mem_read(engine_, frame.address, frame.words.data(), frame.bytes) != UC_ERR_OK) {
        log_.report(Rule::memory, fmt::format("exception return: no frame at 0x{:08X}", frame.address));
        raise({cfsr::kUnstackingBusError, std::nullopt});
        return false;
    }
    RegisterValues<kStackedCount> stacked{};
    std::ranges::copy_n(frame.words.begin(), kStackedCount, stacked.begin());
    write_registers(engine_, kStacked, stacked);
    const std::uint32_t xpsr = frame.words[7];
    if (has_fp) {
        for (int i = 0; i < 16; ++i) set(UC_ARM_REG_S0 + i, frame.words.at(8 + static_cast<std::size_t>(i)));
        set(UC_ARM_REG_FPSCR, frame.words[24]);
    }
    const std::uint32_t control = get(UC_ARM_REG_CONTROL);
    set(UC_ARM_REG_CONTROL, has_fp ? control | kFpContext : control & ~kFpContext);
    set_program_state(xpsr & ~kAlignmentNote, frame.words[6] & ~1U);
    set(UC_ARM_REG_SP, frame.address + frame.bytes + ((xpsr & kAlignmentNote) != 0 ? 4 : 0));
    return true;
}

void CortexM4::raise(const Fault& fault) {
    control_->note_fault(fault.cfsr_bits);
    if (fault.address) control_->note_bus_fault_address(*fault.address);
    const std::uint32_t number =
        fault.cfsr_bits >= cfsr::kUndefinedInstruction ? exception::kUsageFault : exception::kBusFault;
    raise_enabled_fault(number);
}

// Synchronous: taken at once, or as HardFault if it is disabled or its priority is too low.
void CortexM4::raise_enabled_fault(std::uint32_t number) {
    const Nvic& nvic = control_->nvic();
    const int priority = nvic.execution_priority(masks());
    if (nvic.is_enabled(number) && nvic.group_priority(number) < priority) {
        enter(number);
    } else if (priority > -1) {
        control_->note_forced_hard_fault();
        enter(exception::kHardFault);
    } else {
        lock_up("a fault in HardFault or NMI");
    }
}

void CortexM4::lock_up(const char* why) {
    log_.report(Rule::exception_model, fmt::format("lockup: {}", why));
    state_ = CoreState::locked_up;
}

}  // namespace octoskin::sim::stm32
