// A chain of five 74HC595: serial in, 40 outputs with pull-downs (datasheet: shifts and latches on rising
// edges, outputs off while OE is high).
#pragma once

#include <cstdint>
#include <functional>

namespace octoskin::sim::stm32 {

/// Levels at the chain's four pins.
struct ShiftRegisterPins {
    bool is_serial_high = false;
    bool is_shift_high = false;
    bool is_show_high = false;
    bool is_output_off = true;
};

class ShiftRegisterChain {
  public:
    static constexpr std::uint32_t kOutputs = 40;
    using Listener = std::function<void(std::uint32_t output, bool is_high)>;

    /// `listener` is called for each output that changes.
    explicit ShiftRegisterChain(Listener listener) : listener_(std::move(listener)) {}

    void drive(const ShiftRegisterPins& pins);
    [[nodiscard]] bool output(std::uint32_t number) const { return (visible_ >> number & 1U) != 0; }

  private:
    Listener listener_;
    ShiftRegisterPins pins_{};
    std::uint64_t shifted_ = 0x5A'5A5A'5A5A;  ///< the content of a register at power-up is undefined
    std::uint64_t shown_ = 0x5A'5A5A'5A5A;
    std::uint64_t visible_ = 0;
};

}  // namespace octoskin::sim::stm32
