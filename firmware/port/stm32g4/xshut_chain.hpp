// The XSHUT lines of up to 40 sensors: a chain of five 74HC595 shift registers behind four pins. Their
// outputs stay off, and pull-downs keep the lines low, until the first pattern, all low, is in.
#pragma once

#include <cstdint>

#include "common/config/node_config.hpp"
#include "firmware/core/ports.hpp"

namespace octoskin::stm32g4 {

class XshutChain final : public node::XshutLines {
  public:
    /// All lines low, then outputs on.
    void start();

    /// Shifts all 40 levels out and shows them at once: about 30 us at 160 MHz.
    void set(std::uint8_t line, bool is_high) override;

  private:
    void shift_out() const;

    std::uint64_t levels_ = 0;  ///< bit i: line i
};

}  // namespace octoskin::stm32g4
