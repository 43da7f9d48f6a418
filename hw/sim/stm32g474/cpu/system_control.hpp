// The registers of the private peripheral bus: system control block, NVIC, SysTick, FPU control, cycle
// counter (ARMv7-M ARM B3.2, C1.8). Accesses to other registers are reported.
#pragma once

#include <cstdint>
#include <functional>

#include "hw/sim/stm32g474/cpu/nvic.hpp"
#include "hw/sim/stm32g474/cpu/systick.hpp"
#include "hw/sim/stm32g474/violation.hpp"

namespace octoskin::sim::stm32 {

/// Bits of CFSR.
namespace cfsr {
inline constexpr std::uint32_t kInstructionBusError = 1U << 8;
inline constexpr std::uint32_t kPreciseBusError = 1U << 9;
inline constexpr std::uint32_t kUnstackingBusError = 1U << 11;
inline constexpr std::uint32_t kStackingBusError = 1U << 12;
inline constexpr std::uint32_t kBusFaultAddressValid = 1U << 15;
inline constexpr std::uint32_t kUndefinedInstruction = 1U << 16;
inline constexpr std::uint32_t kInvalidState = 1U << 17;
inline constexpr std::uint32_t kInvalidReturn = 1U << 18;
inline constexpr std::uint32_t kNoCoprocessor = 1U << 19;
inline constexpr std::uint32_t kUnaligned = 1U << 24;
}  // namespace cfsr

/// Callbacks to the core and the chip.
struct SystemControlHooks {
    std::function<std::uint32_t()> hclk_hz;
    std::function<std::uint64_t()> cycles;  ///< since power-up, without sleep
    std::function<void()> request_reset;    ///< AIRCR.SYSRESETREQ
};

class SystemControl {
  public:
    SystemControl(const BoardTime& now, ViolationLog& log, SystemControlHooks hooks);

    void reset();
    void advance() { systick_.advance(); }
    [[nodiscard]] BoardTime next_event() const { return systick_.next_event(); }
    /// Absolute addresses 0xE0000000..0xE000FFFF.
    [[nodiscard]] std::uint32_t read(std::uint32_t address, std::uint32_t size);
    void write(std::uint32_t address, std::uint32_t value, std::uint32_t size);

    [[nodiscard]] Nvic& nvic() noexcept { return nvic_; }
    [[nodiscard]] std::uint32_t vector_table() const noexcept { return vtor_; }
    [[nodiscard]] bool is_fpu_enabled() const noexcept { return (cpacr_ >> 20U & 0xFU) == 0xF; }
    [[nodiscard]] bool sleeps_on_exit() const noexcept { return (scr_ & 2U) != 0; }
    [[nodiscard]] bool sleeps_deeply() const noexcept { return (scr_ & 4U) != 0; }

    void note_fault(std::uint32_t cfsr_bits) noexcept { cfsr_ |= cfsr_bits; }
    void note_bus_fault_address(std::uint32_t address) noexcept;
    void note_forced_hard_fault() noexcept { hfsr_ |= 1U << 30; }

  private:
    [[nodiscard]] std::uint32_t read_word(std::uint32_t address);
    [[nodiscard]] std::uint32_t interrupt_control_state() const;
    void write_word(std::uint32_t address, std::uint32_t value);
    void write_interrupt_control_state(std::uint32_t value);
    void write_application_interrupt(std::uint32_t value);
    void write_handler_control(std::uint32_t value);
    void write_vector_table(std::uint32_t value);
    void write_system_priority(std::uint32_t address, std::uint32_t value, std::uint32_t size);

    ViolationLog& log_;
    SystemControlHooks hooks_;
    Nvic nvic_;
    SysTick systick_;
    std::uint32_t vtor_ = 0;
    std::uint32_t scr_ = 0;
    std::uint32_t ccr_ = 0;
    std::uint32_t cfsr_ = 0;
    std::uint32_t hfsr_ = 0;
    std::uint32_t bfar_ = 0;
    std::uint32_t cpacr_ = 0;
    std::uint32_t fpccr_ = 0;
    std::uint32_t fpdscr_ = 0;
    std::uint32_t demcr_ = 0;
    std::uint32_t actlr_ = 0;
    std::uint32_t dwt_control_ = 0;
    std::uint64_t cycle_zero_ = 0;
};

}  // namespace octoskin::sim::stm32
