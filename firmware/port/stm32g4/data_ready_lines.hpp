// The data-ready lines of the four buses: PB12 to PB15, which are lines 12 to 15 of EXTI and share an
// interrupt. A line is listened to from one question about it to its next falling edge: however it chatters,
// it brings no more interrupts than questions are asked.
#pragma once

#include <cstdint>

#include "firmware/core/ports.hpp"

namespace octoskin::stm32g4 {

class DataReadyLines final : public node::DataReadyLines {
  public:
    /// Listens to the buses in `buses` (bit b: bus b); the pins of the others are left alone.
    void start(std::uint8_t buses);

    bool take_fall(std::uint8_t bus) override;

    /// A line fell since the last `acknowledge_event`: a reason to look, whoever asks then.
    [[nodiscard]] bool has_event() const { return has_event_; }
    void acknowledge_event() { has_event_ = false; }
    /// From the interrupt handler of lines 10 to 15.
    void on_interrupt();

  private:
    volatile std::uint32_t fallen_ = 0;  ///< bit b: bus b; not listened to until asked about
    volatile bool has_event_ = false;
};

}  // namespace octoskin::stm32g4
