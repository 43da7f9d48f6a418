// The flash's registers (RM0440 5): wait states, and the option bytes that a program may read. Programming
// and erasing are not modelled: the image is loaded as the flashing tool leaves it.
#pragma once

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/peripherals/pwr.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class FlashInterface final : public Peripheral {
  public:
    FlashInterface(const Surroundings& surroundings, const Pwr& power);

    [[nodiscard]] std::string_view name() const override { return "FLASH"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override { bank_.reset(); }

    /// Called after every change of HCLK, voltage range or latency.
    void check_latency(std::uint32_t hclk_hz);
    /// A word at `offset` bytes in the flash was read and has two wrong bits: sets ECCR until the program
    /// clears it, and raises an NMI.
    void on_double_error(std::uint32_t offset);

  private:
    Surroundings env_;
    const Pwr& power_;
    RegisterBank bank_;
    std::uint32_t hclk_hz_ = 16'000'000;
};

/// Wait states that HCLK needs; 5 or more: not possible (RM0440 table 29, ST's HAL).
[[nodiscard]] std::uint32_t wait_states_needed(std::uint32_t hclk_hz, bool is_range_one, bool is_boosted);

}  // namespace octoskin::sim::stm32
