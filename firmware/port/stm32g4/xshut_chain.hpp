// The first 40 XSHUT lines: a chain of five 74HC595 shift registers on four pins. The outputs stay off, and
// pull-downs keep the lines low, until the first pattern, all low, has been loaded.
#pragma once

#include <cstdint>

namespace octoskin::stm32g4 {

class XshutChain {
  public:
    static constexpr std::uint8_t kLines = 40;

    /// Sets all lines low, then enables the outputs.
    void start();

    /// Shifts out all 40 levels and latches them together: about 30 us at 160 MHz.
    void set(std::uint8_t line, bool is_high);

  private:
    void shift_out() const;

    std::uint64_t levels_ = 0;  ///< bit i: line i
};

}  // namespace octoskin::stm32g4
