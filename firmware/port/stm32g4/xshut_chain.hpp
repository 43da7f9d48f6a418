// The first 40 XSHUT lines: a chain of five 74HC595 shift registers behind four pins. Their outputs stay off,
// and pull-downs keep the lines low, until the first pattern, all low, is in.
#pragma once

#include <cstdint>

namespace octoskin::stm32g4 {

class XshutChain {
  public:
    static constexpr std::uint8_t kLines = 40;

    /// All lines low, then outputs on.
    void start();

    /// Shifts all 40 levels out and shows them at once: about 30 us at 160 MHz.
    void set(std::uint8_t line, bool is_high);

  private:
    void shift_out() const;

    std::uint64_t levels_ = 0;  ///< bit i: line i
};

}  // namespace octoskin::stm32g4
