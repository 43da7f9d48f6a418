// The Cortex-M4F: Unicorn executes the instructions; exceptions, sleep, time and faults are modelled here by
// ARMv7-M ARM B1.5. Only the main stack is used: a program that selects the process stack is reported.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "hw/sim/stm32g474/board_time.hpp"
#include "hw/sim/stm32g474/cpu/system_control.hpp"
#include "hw/sim/stm32g474/violation.hpp"

struct uc_struct;

namespace octoskin::sim::stm32 {

/// Target of loads and stores outside memory. Reads and writes of 1, 2 or 4 bytes.
class MemoryMappedDevices {
  public:
    virtual std::uint32_t read(std::uint32_t address, std::uint32_t size) = 0;
    virtual void write(std::uint32_t address, std::uint32_t value, std::uint32_t size) = 0;

  protected:
    ~MemoryMappedDevices() = default;
};

/// Memory of the core: executable if not writable, else data. The board owns it; a reset keeps its content.
struct MemoryRegion {
    std::uint32_t address;
    std::span<std::uint8_t> bytes;
    bool is_writable;
};

/// State of the core at the time of a report.
enum class CoreState : std::uint8_t { running, sleeping, locked_up };

class CortexM4 {
  public:
    /// Everything must outlive the core. Each instruction takes `cycles_per_instruction` cycles, exception
    /// entry and return 12 each.
    CortexM4(BoardTime& now, ViolationLog& log, std::span<const MemoryRegion> memory,
             MemoryMappedDevices& devices, std::uint32_t cycles_per_instruction);
    ~CortexM4();
    CortexM4(const CortexM4&) = delete;
    CortexM4& operator=(const CortexM4&) = delete;

    /// The system control space must be reset before: SP and PC come from its vector table.
    void attach(SystemControl& control) { control_ = &control; }
    /// Calls `on_read` at each load from these bytes of memory; one range per core. It must not stop the
    /// core.
    void watch_reads(std::uint32_t address, std::uint32_t size, std::function<void()> on_read);
    void reset();
    void set_hclk(std::uint32_t hz) { ps_per_cycle_ = period_ps(hz); }

    /// Runs to `limit` or to the first basic block after it, or until it sleeps or locks up, or until
    /// `interrupt_slice`. `now` advances with each block.
    void run(BoardTime limit);
    /// Ends `run` before the next basic block. May be called from `devices`.
    void interrupt_slice() noexcept { is_slice_interrupted_ = true; }
    /// Lowers the end of the slice to `limit`, if that is earlier.
    void shorten_slice(BoardTime limit) noexcept {
        if (limit < limit_) limit_ = limit;
    }

    /// Asleep without an interrupt that wakes it: time may jump to the next event.
    [[nodiscard]] bool is_idle() const;
    [[nodiscard]] CoreState state() const noexcept { return state_; }
    [[nodiscard]] std::uint64_t instructions() const noexcept { return instructions_; }
    [[nodiscard]] std::uint64_t cycles() const noexcept { return cycles_; }
    [[nodiscard]] std::uint32_t pc() const;
    [[nodiscard]] std::uint32_t general_register(std::uint32_t number) const;
    /// The lowest stack pointer seen at an exception entry or the end of a slice.
    [[nodiscard]] std::uint32_t lowest_stack() const noexcept { return lowest_stack_; }
    /// The longest time between two sleeps: an upper bound of one turn of a main loop that sleeps.
    [[nodiscard]] std::int64_t longest_awake_ps() const noexcept { return longest_awake_ps_; }
    void forget_longest_awake() noexcept { longest_awake_ps_ = 0; }
    /// For tests: starts at another address than the reset handler.
    void jump(std::uint32_t address);
    /// For tests: replaces instructions in memory that the core does not write.
    void patch(std::uint32_t address, std::span<const std::uint16_t> instructions);

  private:
    struct Fault {
        std::uint32_t cfsr_bits;
        std::optional<std::uint32_t> address;
    };
    struct Frame;

    // --- engine (cortex_m4.cpp)
    void map_memory(std::span<const MemoryRegion> memory);
    void add_hooks();
    void before_block(std::uint32_t address, std::uint32_t size);
    [[nodiscard]] bool must_stop() const;
    /// The next exception to take, if the masks allow it.
    [[nodiscard]] std::optional<std::uint32_t> deliverable() const;
    void execute();
    void on_engine_interrupt(std::uint32_t number);
    void after_engine_error(int error);
    [[nodiscard]] std::uint32_t instruction_count(std::uint32_t address, std::uint32_t size);
    [[nodiscard]] std::uint32_t count_instructions(std::uint32_t address, std::uint32_t size) const;
    [[nodiscard]] std::uint16_t half_word(std::uint32_t address) const;
    [[nodiscard]] std::uint32_t get(int engine_register) const;
    void set(int engine_register, std::uint32_t value);
    void spend(std::uint32_t cycles);
    void check_registers();
    void check_fpu_use(std::uint32_t control);
    void note_stack(std::uint32_t sp) noexcept { lowest_stack_ = std::min(lowest_stack_, sp); }

    // --- exceptions (exceptions.cpp)
    [[nodiscard]] ExceptionMasks masks() const;
    void sleep();
    void enter(std::uint32_t number);
    void set_program_state(std::uint32_t xpsr, std::uint32_t pc);
    [[nodiscard]] bool push(const Frame& frame);
    void leave(std::uint32_t exc_return);
    [[nodiscard]] bool pop(std::uint32_t exc_return);
    void raise(const Fault& fault);
    void raise_enabled_fault(std::uint32_t number);
    void lock_up(const char* why);

    BoardTime& now_;
    ViolationLog& log_;
    MemoryMappedDevices& devices_;
    SystemControl* control_ = nullptr;
    uc_struct* engine_ = nullptr;
    std::vector<std::pair<MemoryMappedDevices*, std::uint32_t>> windows_;  ///< devices and base address
    std::uint32_t cycles_per_instruction_;
    std::int64_t ps_per_cycle_ = period_ps(16'000'000);

    BoardTime limit_{};
    CoreState state_ = CoreState::running;
    bool is_slice_interrupted_ = false;
    bool has_stopped_itself_ = false;  ///< this class stopped the engine
    std::optional<std::uint32_t> engine_interrupt_;
    std::optional<std::uint32_t> fault_address_;
    std::function<void()> on_watched_read_;
    std::uint64_t instructions_ = 0;
    std::uint64_t cycles_ = 0;
    std::uint32_t lowest_stack_ = 0xFFFF'FFFF;
    BoardTime woken_at_{};
    std::int64_t longest_awake_ps_ = 0;

    struct CountedBlock {  ///< small: the table is read at each block
        std::uint16_t size = 0;
        std::uint16_t instructions = 0;
    };
    std::vector<CountedBlock> counted_;  ///< of flash, by half-word
};

}  // namespace octoskin::sim::stm32
