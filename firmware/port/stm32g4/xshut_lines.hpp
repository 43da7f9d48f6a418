// The XSHUT lines of the board: 0 to 39 are the outputs of the 74HC595 chain; 40 to 47 are separate pins, for
// boards with few sensors and no chain. These pins are open drain: the pull-up on the sensor's carrier
// releases the sensor.
#pragma once

#include <cstdint>

#include "firmware/core/ports.hpp"
#include "firmware/port/stm32g4/xshut_chain.hpp"

namespace octoskin::stm32g4 {

class XshutLines final : public node::XshutLines {
  public:
    /// Sets all lines low. Between reset and this call the chain's lines are low, but the pins float: their
    /// sensors keep their state, or leave reset with address 0x29.
    void start();

    /// `line` < `kNodeXshutLinesMax`. A line of the chain takes about 30 us at 160 MHz.
    void set(std::uint8_t line, bool is_high) override;

  private:
    XshutChain chain_;
};

}  // namespace octoskin::stm32g4
