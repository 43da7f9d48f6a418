#include "hw/sim/stm32g474/peripherals/gpio.hpp"

#include <fmt/format.h>

#include <span>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kModer = 0x00;
constexpr std::uint32_t kOtyper = 0x04;
constexpr std::uint32_t kPupdr = 0x0C;
constexpr std::uint32_t kIdr = 0x10;
constexpr std::uint32_t kOdr = 0x14;
constexpr std::uint32_t kBsrr = 0x18;
constexpr std::uint32_t kLckr = 0x1C;
constexpr std::uint32_t kAfrl = 0x20;
constexpr std::uint32_t kBrr = 0x28;
constexpr std::uint32_t kAll = 0xFFFF'FFFF;

struct PortSpecs {
    RegisterSpec registers[11];
};
// After reset, ports A and B have the debug pins in use (RM0440 9.4.1).
constexpr PortSpecs specs(std::uint32_t moder, std::uint32_t ospeedr, std::uint32_t pupdr) {
    return {{{0x00, "MODER", moder, kAll},
             {0x04, "OTYPER", 0, 0xFFFF},
             {0x08, "OSPEEDR", ospeedr, kAll},
             {0x0C, "PUPDR", pupdr, kAll},
             {0x10, "IDR", 0, 0},
             {0x14, "ODR", 0, 0xFFFF},
             {0x18, "BSRR", 0, kAll},
             {0x1C, "LCKR", 0, 0x1'FFFF},
             {0x20, "AFRL", 0, kAll},
             {0x24, "AFRH", 0, kAll},
             {0x28, "BRR", 0, 0xFFFF}}};
}
constexpr PortSpecs kPortA = specs(0xABFF'FFFF, 0x0C00'0000, 0x6400'0000);
constexpr PortSpecs kPortB = specs(0xFFFF'FEBF, 0x0000'00C0, 0x0000'0100);
constexpr PortSpecs kPortOther = specs(kAll, 0, 0);

std::span<const RegisterSpec> registers_of(char letter) {
    if (letter == 'A') return kPortA.registers;
    return letter == 'B' ? kPortB.registers : kPortOther.registers;
}

}  // namespace

GpioPort::GpioPort(const Surroundings& surroundings, char letter)
    : name_{'G', 'P', 'I', 'O', letter}, env_(surroundings), bank_(name(), registers_of(letter), env_.log) {}

void GpioPort::reset() {
    bank_.reset();
    for (const auto& listener : listeners_) listener();
}

PinMode GpioPort::mode(std::uint32_t pin) const {
    return static_cast<PinMode>(bank_.get(kModer) >> (2 * pin) & 3U);
}

bool GpioPort::is_open_drain(std::uint32_t pin) const {
    return (bank_.get(kOtyper) >> pin & 1U) != 0;
}

std::uint32_t GpioPort::alternate_function(std::uint32_t pin) const {
    return bank_.get(kAfrl + 4 * (pin / 8)) >> (4 * (pin % 8)) & 0xFU;
}

bool GpioPort::drives_low(std::uint32_t pin) const {
    return mode(pin) == PinMode::output && (bank_.get(kOdr) >> pin & 1U) == 0;
}

bool GpioPort::drives_high(std::uint32_t pin) const {
    return mode(pin) == PinMode::output && (bank_.get(kOdr) >> pin & 1U) != 0 && !is_open_drain(pin);
}

bool GpioPort::level(std::uint32_t pin) const {
    if (mode(pin) == PinMode::analog) return false;  // the input buffer is off
    if (drives_low(pin)) return false;
    if (drives_high(pin)) return true;
    const auto& net = levels_[pin];
    return net ? net() : (bank_.get(kPupdr) >> (2 * pin) & 3U) == 1;
}

std::uint32_t GpioPort::read(std::uint32_t offset) {
    if (offset != kIdr) return bank_.read(offset);
    std::uint32_t value = 0;
    for (std::uint32_t pin = 0; pin < 16; ++pin) value |= (level(pin) ? 1U : 0U) << pin;
    return value;
}

void GpioPort::write(std::uint32_t offset, std::uint32_t value) {
    if (offset == kBsrr) {
        bank_.set(kOdr, (bank_.get(kOdr) & ~(value >> 16U)) | (value & 0xFFFFU));  // set wins
    } else if (offset == kBrr) {
        bank_.clear_bits(kOdr, value & 0xFFFFU);
    } else if (offset == kLckr) {
        env_.log.report(Rule::not_modelled, fmt::format("{}.LCKR: locking", name()));
    } else {
        bank_.write(offset, value);
    }
    for (const auto& listener : listeners_) listener();
}

}  // namespace octoskin::sim::stm32
