// Interface of every peripheral to its bus, and the services that it may use.
#pragma once

#include <cstdint>
#include <string_view>

#include "hw/sim/stm32g474/board_time.hpp"
#include "hw/sim/stm32g474/violation.hpp"

namespace octoskin::sim::stm32 {

/// Receiver of interrupt lines, by level as on the chip.
class InterruptLines {
  public:
    virtual void set_line(std::uint32_t irq, bool is_high) = 0;
    virtual void pend_nmi() = 0;

  protected:
    ~InterruptLines() = default;
};

/// Services for every model. Must outlive the models.
struct Surroundings {
    const BoardTime& now;
    ViolationLog& log;
    InterruptLines& lines;
};

/// `advance` brings a model to the present time. Call it before each access, and from the board's loop no
/// later than `next_event`.
class Peripheral {
  public:
    virtual ~Peripheral() = default;
    [[nodiscard]] virtual std::string_view name() const = 0;
    [[nodiscard]] virtual std::uint32_t read(std::uint32_t offset) = 0;
    virtual void write(std::uint32_t offset, std::uint32_t value) = 0;
    /// Resets it as a system reset or the peripheral's bit in RCC's reset registers does.
    virtual void reset() = 0;
    /// Whether a byte or half-word may be written there; else such a write is a violation.
    [[nodiscard]] virtual bool takes_narrow_writes(std::uint32_t) const { return false; }
    virtual void advance() {}
    [[nodiscard]] virtual BoardTime next_event() const { return kNever; }
};

}  // namespace octoskin::sim::stm32
