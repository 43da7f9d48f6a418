#include "hw/sim/stm32g474/cpu/cortex_m4.hpp"

#include <fmt/format.h>
#include <unicorn/unicorn.h>

#include <stdexcept>

#include "hw/sim/stm32g474/cpu/engine_registers.hpp"

// Unicorn 2.0.1 assumes that each store may change instructions: it allocates a tree of the pages to lock
// against other threads of QEMU (there are none), searches for code translated from there, and frees the
// tree. That takes more than half of the run time. Here no writable memory is executed (see map_memory), and
// `patch` clears the translated code itself. The library calls these three functions by name, so that these
// definitions replace its own; a test checks that they do.
#if UC_API_MAJOR == 2 && UC_API_MINOR == 0
extern "C" {
void* page_collection_lock_arm(void* engine, std::uint64_t begin, std::uint64_t end);
void page_collection_unlock_arm(void* pages);
void tb_invalidate_phys_page_fast_arm(void* engine, void* pages, std::uint64_t begin, int bytes,
                                      std::uintptr_t from);

void* page_collection_lock_arm(void*, std::uint64_t, std::uint64_t) {
    return nullptr;
}
void page_collection_unlock_arm(void*) {}
void tb_invalidate_phys_page_fast_arm(void*, void*, std::uint64_t, int, std::uintptr_t) {}
}
#endif

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kFlashBase = 0x0800'0000;
constexpr std::uint32_t kFlashBytes = 512 * 1024;
constexpr std::uint64_t kNeverReached = 0xFFFF'FFF0;
constexpr std::uint16_t kWfi = 0xBF30;
constexpr std::uint16_t kWfe = 0xBF20;
constexpr std::uint16_t kYield = 0xBF10;
constexpr std::uint32_t kEngineExceptionReturn = 8;
constexpr std::uint32_t kEngineSvc = 2;
constexpr std::uint32_t kEnginePrefetchAbort = 3;
constexpr std::uint32_t kEngineDataAbort = 4;
constexpr std::uint32_t kEngineBreakpoint = 7;

struct DeviceWindow {
    std::uint32_t address;
    std::uint32_t size;
};
constexpr DeviceWindow kDeviceWindows[] = {
    {0x4000'0000, 0x3'0000},   // APB1, APB2, AHB1
    {0x4800'0000, 0x2000},     // GPIO
    {0x5000'0000, 0x6'1000},   // ADC, DAC, RNG
    {0xE000'0000, 0x10'0000},  // private peripheral bus
};

void require(uc_err error, const char* what) {
    if (error != UC_ERR_OK)
        throw std::runtime_error(fmt::format("Unicorn: {}: {}", what, uc_strerror(error)));
}

constexpr bool is_wide(std::uint16_t first_half) {
    return first_half >> 11U >= 0x1D;  // ARMv7-M ARM A5.1: 0b11101, 0b11110, 0b11111
}

}  // namespace

CortexM4::CortexM4(BoardTime& now, ViolationLog& log, std::span<const MemoryRegion> memory,
                   MemoryMappedDevices& devices, std::uint32_t cycles_per_instruction)
    : now_(now),
      log_(log),
      devices_(devices),
      cycles_per_instruction_(cycles_per_instruction),
      counted_(kFlashBytes / 2) {
    // UC_MODE_MCLASS would give a Cortex-M33.
    require(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &engine_), "open");
    require(uc_ctl_set_cpu_model(engine_, UC_CPU_ARM_CORTEX_M4), "Cortex-M4");
    map_memory(memory);
    add_hooks();
    log_.set_where([this] { return pc(); });
}

CortexM4::~CortexM4() {
    uc_close(engine_);
}

void CortexM4::map_memory(std::span<const MemoryRegion> memory) {
    for (const MemoryRegion& region : memory) {
        const std::uint32_t rights = UC_PROT_READ | (region.is_writable ? UC_PROT_WRITE : UC_PROT_EXEC);
        require(uc_mem_map_ptr(engine_, region.address, region.bytes.size(), rights, region.bytes.data()),
                "memory");
    }
    const auto read = [](uc_engine*, std::uint64_t offset, unsigned size, void* user) -> std::uint64_t {
        auto [devices, base] = *static_cast<std::pair<MemoryMappedDevices*, std::uint32_t>*>(user);
        return devices->read(base + static_cast<std::uint32_t>(offset), size);
    };
    const auto write = [](uc_engine*, std::uint64_t offset, unsigned size, std::uint64_t value, void* user) {
        auto [devices, base] = *static_cast<std::pair<MemoryMappedDevices*, std::uint32_t>*>(user);
        devices->write(base + static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(value), size);
    };
    windows_.reserve(std::size(kDeviceWindows));
    for (const DeviceWindow& window : kDeviceWindows) {
        auto& user = windows_.emplace_back(&devices_, window.address);
        require(uc_mmio_map(engine_, window.address, window.size, read, &user, write, &user), "devices");
    }
}

void CortexM4::add_hooks() {
    // Captureless lambdas convert to the C function pointers that the engine needs.
    using BlockHook = void (*)(uc_engine*, std::uint64_t, std::uint32_t, void*);
    const BlockHook on_block = [](uc_engine*, std::uint64_t address, std::uint32_t size, void* self) {
        static_cast<CortexM4*>(self)->before_block(static_cast<std::uint32_t>(address), size);
    };
    using InterruptHook = void (*)(uc_engine*, std::uint32_t, void*);
    const InterruptHook on_interrupt = [](uc_engine* engine, std::uint32_t number, void* self) {
        static_cast<CortexM4*>(self)->engine_interrupt_ = number;
        uc_emu_stop(engine);
    };
    using InvalidMemoryHook = bool (*)(uc_engine*, uc_mem_type, std::uint64_t, int, std::int64_t, void*);
    const InvalidMemoryHook on_invalid_memory = [](uc_engine*, uc_mem_type, std::uint64_t address, int,
                                                   std::int64_t, void* self) {
        static_cast<CortexM4*>(self)->fault_address_ = static_cast<std::uint32_t>(address);
        return false;
    };
    // WFE and YIELD, which the engine does not know, are hints: they may do nothing.
    using InvalidInstructionHook = bool (*)(uc_engine*, void*);
    const InvalidInstructionHook on_invalid_instruction = [](uc_engine*, void* user) {
        const auto* self = static_cast<CortexM4*>(user);
        const std::uint16_t before = self->half_word(self->get(UC_ARM_REG_PC) - 2);
        return before == kWfe || before == kYield;
    };
    const auto add = [this](int type, void* hook) {
        uc_hook handle = 0;
        require(uc_hook_add(engine_, &handle, type, hook, this, 1, 0), "hook");
    };
    add(UC_HOOK_BLOCK, reinterpret_cast<void*>(on_block));
    add(UC_HOOK_INTR, reinterpret_cast<void*>(on_interrupt));
    add(UC_HOOK_MEM_INVALID, reinterpret_cast<void*>(on_invalid_memory));
    add(UC_HOOK_INSN_INVALID, reinterpret_cast<void*>(on_invalid_instruction));
}

void CortexM4::watch_reads(std::uint32_t address, std::uint32_t size, std::function<void()> on_read) {
    on_watched_read_ = std::move(on_read);
    using ReadHook = void (*)(uc_engine*, uc_mem_type, std::uint64_t, int, std::int64_t, void*);
    const ReadHook hook = [](uc_engine*, uc_mem_type, std::uint64_t, int, std::int64_t, void* self) {
        static_cast<CortexM4*>(self)->on_watched_read_();
    };
    uc_hook handle = 0;
    require(uc_hook_add(engine_, &handle, UC_HOOK_MEM_READ, reinterpret_cast<void*>(hook), this, address,
                        address + size - 1),
            "hook");
}

std::uint32_t CortexM4::get(int engine_register) const {
    return read_registers<1>(engine_, {engine_register}).front();
}

void CortexM4::set(int engine_register, std::uint32_t value) {
    write_registers<1>(engine_, {engine_register}, {value});
}

std::uint32_t CortexM4::pc() const {
    return get(UC_ARM_REG_PC);
}

std::uint32_t CortexM4::general_register(std::uint32_t number) const {
    return get(UC_ARM_REG_R0 + static_cast<int>(number));
}

void CortexM4::reset() {
    state_ = CoreState::running;
    lowest_stack_ = 0xFFFF'FFFF;
    is_slice_interrupted_ = false;
    for (int number = 0; number <= 12; ++number) set(UC_ARM_REG_R0 + number, 0);
    set(UC_ARM_REG_LR, 0xFFFF'FFFF);
    set(UC_ARM_REG_PRIMASK, 0);
    set(UC_ARM_REG_BASEPRI, 0);
    set(UC_ARM_REG_FAULTMASK, 0);
    set(UC_ARM_REG_CONTROL, 0);
    std::uint32_t vectors[2] = {};
    uc_mem_read(engine_, control_->vector_table(), vectors, sizeof vectors);
    if ((vectors[1] & 1U) == 0 || vectors[0] % 8 != 0) {
        log_.report(Rule::exception_model,
                    fmt::format("vector table: SP 0x{:08X}, reset 0x{:08X}", vectors[0], vectors[1]));
    }
    set_program_state(1U << 24, vectors[1] & ~1U);
    set(UC_ARM_REG_SP, vectors[0] & ~3U);
}

void CortexM4::jump(std::uint32_t address) {
    set(UC_ARM_REG_PC, address | 1U);
}

void CortexM4::patch(std::uint32_t address, std::span<const std::uint16_t> instructions) {
    require(uc_mem_write(engine_, address, instructions.data(), instructions.size_bytes()), "patch");
    // Clears the translated code, also of blocks that contain the address.
    require(uc_ctl_remove_cache(engine_, address, address + instructions.size_bytes()), "patch");
    counted_.assign(counted_.size(), {});
}

void CortexM4::run(BoardTime limit) {
    limit_ = limit;
    is_slice_interrupted_ = false;
    while (now_ < limit_ && state_ != CoreState::locked_up && !is_slice_interrupted_) {
        if (state_ == CoreState::sleeping) {
            if (is_idle()) return;
            state_ = CoreState::running;
            woken_at_ = now_;
        }
        if (const auto next = deliverable()) enter(*next);
        execute();
        check_registers();
    }
}

void CortexM4::execute() {
    has_stopped_itself_ = false;
    engine_interrupt_.reset();
    fault_address_.reset();
    const uc_err error = uc_emu_start(engine_, get(UC_ARM_REG_PC) | 1U, kNeverReached, 0, 0);
    if (engine_interrupt_) {
        on_engine_interrupt(*engine_interrupt_);
    } else if (error != UC_ERR_OK) {
        after_engine_error(error);
    } else if (!has_stopped_itself_) {
        if (half_word(pc() - 2) == kWfi) sleep();
    }
}

// Runs before each basic block. Stopping here leaves the block for the next slice; stopping inside a device's
// access would repeat the block's side effects.
void CortexM4::before_block(std::uint32_t address, std::uint32_t size) {
    if (must_stop()) {
        has_stopped_itself_ = true;
        uc_emu_stop(engine_);
        return;
    }
    const std::uint32_t count = instruction_count(address, size);
    instructions_ += count;
    spend(count * cycles_per_instruction_);
}

// CPSIE and MSR cannot be observed from outside. While an exception is masked, the masks are checked in each
// block.
bool CortexM4::must_stop() const {
    if (now_ >= limit_ || is_slice_interrupted_) return true;
    return deliverable().has_value();
}

std::optional<std::uint32_t> CortexM4::deliverable() const {
    const Nvic& nvic = control_->nvic();
    return nvic.candidate() ? nvic.deliverable(masks()) : std::nullopt;  // each mask is a call of the engine
}

void CortexM4::spend(std::uint32_t cycles) {
    cycles_ += cycles;
    now_.ps += cycles * ps_per_cycle_;
}

std::uint32_t CortexM4::instruction_count(std::uint32_t address, std::uint32_t size) {
    if (address - kFlashBase >= kFlashBytes) return count_instructions(address, size);
    CountedBlock& block = counted_[(address - kFlashBase) / 2];
    if (block.size != size) {
        block = {static_cast<std::uint16_t>(size),
                 static_cast<std::uint16_t>(count_instructions(address, size))};
    }
    return block.instructions;
}

std::uint32_t CortexM4::count_instructions(std::uint32_t address, std::uint32_t size) const {
    std::uint32_t count = 0;
    const std::uint32_t end = address + size;
    while (address < end) {
        address += is_wide(half_word(address)) ? 4U : 2U;
        ++count;
    }
    return count;
}

std::uint16_t CortexM4::half_word(std::uint32_t address) const {
    std::uint16_t value = 0;
    uc_mem_read(engine_, address, &value, sizeof value);
    return value;
}

void CortexM4::on_engine_interrupt(std::uint32_t number) {
    const std::uint32_t at = pc();
    if (number == kEngineExceptionReturn) {
        leave(at | 1U);
    } else if (number == kEngineSvc) {
        raise_enabled_fault(exception::kSvCall);
    } else if (number == kEngineBreakpoint) {
        log_.report(Rule::exception_model, fmt::format("BKPT at 0x{:08X} without a debugger", at));
        raise({0, std::nullopt});
    } else if (number == kEnginePrefetchAbort) {
        log_.report(Rule::memory, fmt::format("execution from 0x{:08X}", at));
        raise({cfsr::kInstructionBusError, std::nullopt});
    } else if (number == kEngineDataAbort) {
        log_.report(Rule::memory, fmt::format("unaligned access near 0x{:08X}", at));
        raise({cfsr::kUnaligned, std::nullopt});
    } else {
        log_.report(Rule::memory, fmt::format("instruction near 0x{:08X} is undefined ({})", at, number));
        raise({cfsr::kUndefinedInstruction, std::nullopt});
    }
}

void CortexM4::after_engine_error(int error) {
    const std::uint32_t at = pc();
    const std::uint32_t address = fault_address_.value_or(0);
    switch (error) {
        case UC_ERR_FETCH_UNMAPPED:
        case UC_ERR_FETCH_PROT:
            log_.report(Rule::memory, fmt::format("execution from 0x{:08X}", address));
            raise({cfsr::kInstructionBusError, std::nullopt});
            break;
        case UC_ERR_READ_UNMAPPED:
        case UC_ERR_READ_PROT:
            log_.report(Rule::memory, fmt::format("read of 0x{:08X}", address));
            raise({cfsr::kPreciseBusError, address});
            break;
        case UC_ERR_WRITE_UNMAPPED:
        case UC_ERR_WRITE_PROT:
            log_.report(Rule::memory, fmt::format("write to 0x{:08X}", address));
            raise({cfsr::kPreciseBusError, address});
            break;
        case UC_ERR_READ_UNALIGNED:
        case UC_ERR_WRITE_UNALIGNED:
            log_.report(Rule::memory, fmt::format("unaligned access to 0x{:08X}", address));
            raise({cfsr::kUnaligned, std::nullopt});
            break;
        case UC_ERR_INSN_INVALID:
        case UC_ERR_EXCEPTION:
            log_.report(Rule::memory, fmt::format("undefined instruction before 0x{:08X}", at));
            raise({cfsr::kUndefinedInstruction, std::nullopt});
            break;
        default:
            throw std::runtime_error(fmt::format("Unicorn stopped near 0x{:08X}: {}", at,
                                                 uc_strerror(static_cast<uc_err>(error))));
    }
}

void CortexM4::check_registers() {
    const auto [sp, control] = read_registers<2>(engine_, {UC_ARM_REG_SP, UC_ARM_REG_CONTROL});
    note_stack(sp);
    if ((control & 3U) != 0) log_.report(Rule::not_modelled, "CONTROL: process stack or unprivileged mode");
    check_fpu_use(control);
}

// The engine ignores CPACR; CONTROL.FPCA shows that floating point was used.
void CortexM4::check_fpu_use(std::uint32_t control) {
    if (control_->is_fpu_enabled() || (control & kFpContext) == 0) return;
    log_.report(Rule::fpu_disabled, "floating point while CPACR does not enable CP10 and CP11");
    set(UC_ARM_REG_CONTROL, control & ~kFpContext);
}

}  // namespace octoskin::sim::stm32
