// One GPIO port (RM0440 9): modes, levels, and the drive of each pin on its net.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

enum class PinMode : std::uint8_t { input = 0, output = 1, alternate = 2, analog = 3 };

class GpioPort final : public Peripheral {
  public:
    /// `letter`: 'A'..'G'.
    GpioPort(const Surroundings& surroundings, char letter);

    [[nodiscard]] std::string_view name() const override { return {name_.data(), name_.size()}; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    [[nodiscard]] bool takes_narrow_writes(std::uint32_t) const override { return true; }

    [[nodiscard]] PinMode mode(std::uint32_t pin) const;
    [[nodiscard]] bool is_open_drain(std::uint32_t pin) const;
    [[nodiscard]] std::uint32_t alternate_function(std::uint32_t pin) const;
    /// Whether an output drives its net low. In any other mode a pin drives nothing.
    [[nodiscard]] bool drives_low(std::uint32_t pin) const;
    [[nodiscard]] bool drives_high(std::uint32_t pin) const;
    /// The input level at the pin; low while it is analog.
    [[nodiscard]] bool level(std::uint32_t pin) const;

    /// Called after every write that may have changed the pins' drive.
    void on_change(std::function<void()> listener) { listeners_.push_back(std::move(listener)); }
    /// Sets the source of a pin's level. Without one the level is that of its pull-up or pull-down.
    void connect(std::uint32_t pin, std::function<bool()> level) { levels_.at(pin) = std::move(level); }

  private:
    std::array<char, 5> name_;
    Surroundings env_;
    RegisterBank bank_;
    std::vector<std::function<void()>> listeners_;
    std::array<std::function<bool()>, 16> levels_{};
};

}  // namespace octoskin::sim::stm32
