// Exceptions of the Cortex-M4: which are pending, active and enabled, and which is next (ARMv7-M ARM B1.5,
// B3.4). Numbers are exception numbers: interrupt n is 16 + n.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>

#include "hw/sim/stm32g474/violation.hpp"

namespace octoskin::sim::stm32 {

inline constexpr std::uint32_t kInterruptCount = 102;  // RM0440: FMAC, 101, is the last
inline constexpr std::uint32_t kExceptionCount = 16 + kInterruptCount;

namespace exception {
inline constexpr std::uint32_t kNmi = 2;
inline constexpr std::uint32_t kHardFault = 3;
inline constexpr std::uint32_t kMemManage = 4;
inline constexpr std::uint32_t kBusFault = 5;
inline constexpr std::uint32_t kUsageFault = 6;
inline constexpr std::uint32_t kSvCall = 11;
inline constexpr std::uint32_t kPendSv = 14;
inline constexpr std::uint32_t kSysTick = 15;
}  // namespace exception

/// PRIMASK, BASEPRI and FAULTMASK.
struct ExceptionMasks {
    bool is_primask = false;
    bool is_faultmask = false;
    std::uint8_t basepri = 0;
};

class Nvic {
  public:
    /// Below every configurable priority: nothing is active.
    static constexpr int kThreadPriority = 256;

    explicit Nvic(ViolationLog& log) : log_(log) { reset(); }
    void reset();

    void pend(std::uint32_t number);
    void unpend(std::uint32_t number);
    /// Level of an interrupt's line: high pends it, and pends it again when its handler ends.
    void set_line(std::uint32_t irq, bool is_high);
    void activate(std::uint32_t number);
    void deactivate(std::uint32_t number);
    [[nodiscard]] bool is_active(std::uint32_t number) const { return active_[number]; }
    [[nodiscard]] bool is_pending(std::uint32_t number) const { return pending_[number]; }
    [[nodiscard]] std::size_t active_count() const { return active_.count(); }
    /// MemManage, BusFault, UsageFault; SHCSR.
    void enable_fault(std::uint32_t number, bool is_enabled);
    [[nodiscard]] bool is_enabled(std::uint32_t number) const { return enabled_[number]; }

    void set_priority(std::uint32_t number, std::uint8_t priority);
    [[nodiscard]] std::uint8_t priority_byte(std::uint32_t number) const { return priority_[number]; }
    void set_priority_group(std::uint32_t prigroup);
    [[nodiscard]] std::uint32_t priority_group() const noexcept { return prigroup_; }

    /// Group priority of an exception; -2 NMI, -1 HardFault.
    [[nodiscard]] int group_priority(std::uint32_t number) const;
    /// Priority of the active exceptions, without masks.
    [[nodiscard]] int active_priority() const noexcept { return active_priority_; }
    /// The same with masks.
    [[nodiscard]] int execution_priority(const ExceptionMasks& masks) const;
    /// The exception that would preempt the active one without masks.
    [[nodiscard]] std::optional<std::uint32_t> candidate() const noexcept { return candidate_; }
    /// The candidate, if the masks allow it.
    [[nodiscard]] std::optional<std::uint32_t> deliverable(const ExceptionMasks& masks) const;
    /// The first pending and enabled exception, independent of active ones: ICSR.VECTPENDING.
    [[nodiscard]] std::uint32_t first_pending() const;

    /// Registers 0xE000E100..0xE000E4FF, by offset from 0xE000E000; size 1, 2 or 4 bytes.
    [[nodiscard]] std::uint32_t read_register(std::uint32_t offset) const;
    void write_register(std::uint32_t offset, std::uint32_t value, std::uint32_t size);

  private:
    using Exceptions = std::bitset<kExceptionCount>;

    void update();
    [[nodiscard]] std::uint32_t word(const Exceptions& bits, std::uint32_t index) const;

    ViolationLog& log_;
    Exceptions pending_;
    Exceptions active_;
    Exceptions enabled_;
    Exceptions lines_;
    std::array<std::uint8_t, kExceptionCount> priority_{};
    std::uint32_t prigroup_ = 0;
    int active_priority_ = kThreadPriority;
    std::optional<std::uint32_t> candidate_;
};

}  // namespace octoskin::sim::stm32
