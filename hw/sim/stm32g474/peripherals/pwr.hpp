// Power control (RM0440 6): voltage range and boost, which limit the flash's read rate.
#pragma once

#include <functional>

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class Pwr final : public Peripheral {
  public:
    Pwr(const Surroundings& surroundings, std::function<void()> after_change);

    [[nodiscard]] std::string_view name() const override { return "PWR"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override { return bank_.read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override { bank_.reset(); }

    /// Range 1: 150 MHz, with boost 170; range 2: 26.
    [[nodiscard]] bool is_range_one() const { return (bank_.get(0x00) >> 9U & 3U) == 1; }
    [[nodiscard]] bool is_boosted() const { return (bank_.get(0x80) >> 8U & 1U) == 0; }
    /// UCPD1_DBDIS: the pull-downs of 5.1 kOhm on PB4 and PB6 are off.
    [[nodiscard]] bool are_dead_battery_pulls_off() const { return (bank_.get(0x08) >> 14U & 1U) != 0; }

  private:
    Surroundings env_;
    std::function<void()> after_change_;
    RegisterBank bank_;
};

}  // namespace octoskin::sim::stm32
