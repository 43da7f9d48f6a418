#include "firmware/port/stm32g4/pin.hpp"

#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"

namespace octoskin::stm32g4 {

namespace {
constexpr std::uint32_t kInput = 0;  // MODER
constexpr std::uint32_t kOutput = 1;
constexpr std::uint32_t kAlternate = 2;
}  // namespace

void Pin::configure(std::uint32_t mode, Drive drive, Speed speed, Pull pull) const {
    using F = Field<GpioMap>;
    port_.set(F("OTYPER.OT#")[number_], static_cast<std::uint32_t>(drive));
    port_.set(F("OSPEEDR.OSPEEDR#")[number_], static_cast<std::uint32_t>(speed));
    port_.set(F("PUPDR.PUPDR#")[number_], static_cast<std::uint32_t>(pull));
    port_.set(F("MODER.MODER#")[number_], mode);
}

void Pin::make_input(Pull pull) const {
    configure(kInput, Drive::push_pull, Speed::low, pull);
}

void Pin::make_output(Drive drive, Speed speed) const {
    configure(kOutput, drive, speed);
}

void Pin::make_alternate(std::uint8_t function, Drive drive, Speed speed) const {
    using F = Field<GpioMap>;
    if (number_ < 8) {
        port_.set(F("AFRL.AFRL#")[number_], function);
    } else {
        port_.set(F("AFRH.AFRH#")[number_ - 8U], function);
    }
    configure(kAlternate, drive, speed);
}

void Pin::set(bool is_high) const {
    using F = Field<GpioMap>;
    port_.write("BSRR", is_high ? F("BSRR.BS#")[number_](1) : F("BSRR.BR#")[number_](1));
}

bool Pin::is_high() const {
    return port_.is_set(Field<GpioMap>("IDR.IDR#")[number_]);
}

void enable_pins() {
    using F = Field<RccMap>;
    rcc.write("AHB2ENR", rcc.read("AHB2ENR") | F("AHB2ENR.GPIOAEN")(1) | F("AHB2ENR.GPIOBEN")(1) |
                             F("AHB2ENR.GPIOCEN")(1));
    (void)rcc.read("AHB2ENR");
}

}  // namespace octoskin::stm32g4
