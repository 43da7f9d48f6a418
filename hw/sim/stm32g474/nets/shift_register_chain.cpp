#include "hw/sim/stm32g474/nets/shift_register_chain.hpp"

namespace octoskin::sim::stm32 {

void ShiftRegisterChain::drive(const ShiftRegisterPins& pins) {
    constexpr std::uint64_t kAll = (std::uint64_t{1} << kOutputs) - 1;
    if (pins.is_shift_high && !pins_.is_shift_high) {
        shifted_ = (shifted_ << 1U | (pins.is_serial_high ? 1U : 0U)) & kAll;
    }
    if (pins.is_show_high && !pins_.is_show_high) shown_ = shifted_;
    pins_ = pins;
    const std::uint64_t visible = pins.is_output_off ? 0 : shown_;
    const std::uint64_t changed = visible ^ visible_;
    visible_ = visible;
    if (changed == 0) return;
    for (std::uint32_t output = 0; output < kOutputs; ++output) {
        if ((changed >> output & 1U) != 0) listener_(output, (visible >> output & 1U) != 0);
    }
}

}  // namespace octoskin::sim::stm32
