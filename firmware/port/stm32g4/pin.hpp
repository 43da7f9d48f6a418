// One pin of ports A, B and C.
#pragma once

#include <cstdint>

#include "firmware/port/stm32g4/registers/gpio.hpp"

namespace octoskin::stm32g4 {

enum class Drive : std::uint8_t { push_pull = 0, open_drain = 1 };
enum class Pull : std::uint8_t { none = 0, up = 1 };
enum class Speed : std::uint8_t { low = 0, medium = 1, high = 2 };

class Pin {
  public:
    constexpr Pin(const Peripheral<GpioMap>& port, std::uint8_t number) : port_(port), number_(number) {}

    void make_input(Pull pull) const;
    /// Set the level first: the pin drives it as soon as it is an output.
    void make_output(Drive drive, Speed speed = Speed::low) const;
    /// `function`: the AF number of the datasheet's table.
    void make_alternate(std::uint8_t function, Drive drive, Speed speed = Speed::low) const;

    void set(bool is_high) const;
    [[nodiscard]] bool is_high() const;

  private:
    void configure(std::uint32_t mode, Drive drive, Speed speed, Pull pull = Pull::none) const;

    Peripheral<GpioMap> port_;
    std::uint8_t number_;
};

/// Enables the clocks of ports A, B and C.
void enable_pins();

}  // namespace octoskin::stm32g4
