// The data-ready lines of the four buses: PB12 to PB15, EXTI lines 12 to 15, which share one interrupt. After
// a falling edge a line is masked until `take_fall` is called for it, so a line that toggles fast causes no
// more interrupts than calls.
#pragma once

#include <cstdint>

#include "firmware/core/ports.hpp"

namespace octoskin::stm32g4 {

class DataReadyLines final : public node::DataReadyLines {
  public:
    /// Enables the lines of the buses in `buses` (bit b: bus b). Does not touch the pins of the others.
    void start(std::uint8_t buses);

    bool take_fall(std::uint8_t bus) override;

    /// A line fell since the last `acknowledge_event`.
    [[nodiscard]] bool has_event() const { return has_event_; }
    void acknowledge_event() { has_event_ = false; }
    /// Call from the interrupt handler of lines 10 to 15.
    void on_interrupt();

  private:
    volatile std::uint32_t fallen_ = 0;  ///< bit b: bus b fell; its line is masked until `take_fall`
    volatile bool has_event_ = false;
};

}  // namespace octoskin::stm32g4
