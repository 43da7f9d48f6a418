// External interrupts (RM0440 15): an edge on a pin pends the interrupt of its line. Only the lines 0 to 15,
// of pins; the others belong to peripherals that are not modelled or wake no model. Events (WFE) are not
// modelled. An edge on a masked line is lost: the manual is not clear, and this is the harder case for a
// program.
#pragma once

#include <cstdint>
#include <functional>

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class Exti final : public Peripheral {
  public:
    static constexpr std::uint32_t kPinLines = 16;

    /// Of the pin that is a line's source.
    struct Hooks {
        std::function<bool(std::uint32_t line)> is_high;
        std::function<bool(std::uint32_t line)> is_input_off;  ///< analog: no level arrives
        /// When the level of one of these lines (bit: line) may next change by itself.
        std::function<BoardTime(std::uint32_t lines)> next_change;
    };

    Exti(const Surroundings& surroundings, Hooks hooks);

    [[nodiscard]] std::string_view name() const override { return "EXTI"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override { return bank_.read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    void advance() override;
    [[nodiscard]] BoardTime next_event() const override { return next_change_; }

    /// A pin may have changed.
    void sample();

  private:
    [[nodiscard]] std::uint32_t levels() const;
    [[nodiscard]] std::uint32_t triggered_lines() const;
    void write_mask(std::uint32_t value);
    void refuse_other_lines(std::uint32_t offset, std::uint32_t value);
    void pend(std::uint32_t lines);
    void clear(std::uint32_t lines);
    void watch();
    void update_lines();

    Surroundings env_;
    Hooks hooks_;
    RegisterBank bank_;
    std::uint32_t levels_ = 0;  ///< bit i: line i was high; of lines with a trigger
    BoardTime next_change_ = kNever;
};

}  // namespace octoskin::sim::stm32
