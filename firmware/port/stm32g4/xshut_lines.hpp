// The XSHUT lines of the board: 0 to 39 are the outputs of the 74HC595 chain, 40 to 47 pins of their own, for
// few sensors and no chain. Those pins are open drain: what releases a sensor is its carrier's pull-up.
#pragma once

#include <cstdint>

#include "firmware/core/ports.hpp"
#include "firmware/port/stm32g4/xshut_chain.hpp"

namespace octoskin::stm32g4 {

class XshutLines final : public node::XshutLines {
  public:
    /// All lines low. From a reset until then those of the chain are low too, and the pins float: their
    /// sensors stay where they are, or leave reset for 0x29.
    void start();

    /// `line` below `kNodeXshutLinesMax`. A line of the chain takes about 30 us at 160 MHz.
    void set(std::uint8_t line, bool is_high) override;

  private:
    XshutChain chain_;
};

}  // namespace octoskin::stm32g4
