// What every peripheral of the chip offers to the bus it sits on, and what it may use.
#pragma once

#include <cstdint>
#include <string_view>

#include "hw/sim/stm32g474/board_time.hpp"
#include "hw/sim/stm32g474/violation.hpp"

namespace octoskin::sim::stm32 {

/// Where interrupt lines end. Levels, as on the chip.
class InterruptLines {
  public:
    virtual void set_line(std::uint32_t irq, bool is_high) = 0;
    virtual void pend_nmi() = 0;

  protected:
    ~InterruptLines() = default;
};

/// What every model may use. Must outlive the models.
struct Surroundings {
    const BoardTime& now;
    ViolationLog& log;
    InterruptLines& lines;
};

/// `advance` brings a model to the present: whoever accesses it calls it first, and whoever runs the board
/// calls it no later than `next_event`.
class Peripheral {
  public:
    virtual ~Peripheral() = default;
    [[nodiscard]] virtual std::string_view name() const = 0;
    [[nodiscard]] virtual std::uint32_t read(std::uint32_t offset) = 0;
    virtual void write(std::uint32_t offset, std::uint32_t value) = 0;
    /// As after a system reset, or after the peripheral's bit in RCC's reset registers.
    virtual void reset() = 0;
    /// Whether a byte or half-word may be written there; else such a write is a violation.
    [[nodiscard]] virtual bool takes_narrow_writes(std::uint32_t) const { return false; }
    virtual void advance() {}
    [[nodiscard]] virtual BoardTime next_event() const { return kNever; }
};

}  // namespace octoskin::sim::stm32
