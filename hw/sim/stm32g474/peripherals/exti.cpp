#include "hw/sim/stm32g474/peripherals/exti.hpp"

#include <fmt/format.h>

#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kImr1 = 0x00;
constexpr std::uint32_t kEmr1 = 0x04;
constexpr std::uint32_t kRtsr1 = 0x08;
constexpr std::uint32_t kFtsr1 = 0x0C;
constexpr std::uint32_t kSwier1 = 0x10;
constexpr std::uint32_t kPr1 = 0x14;
constexpr std::uint32_t kPins = 0xFFFF;

// ST's register description; the interrupts of lines that belong to peripherals are unmasked after reset.
constexpr RegisterSpec kRegisters[] = {
    {0x00, "IMR1", 0xFF82'0000, 0xFFFF'FFFF}, {0x04, "EMR1", 0, 0xFFFF'FFFF},
    {0x08, "RTSR1", 0, 0xE07D'FFFF},          {0x0C, "FTSR1", 0, 0xE07D'FFFF},
    {0x10, "SWIER1", 0, 0xE07D'FFFF},         {0x14, "PR1", 0, 0xE07D'FFFF},
    {0x20, "IMR2", 0xFFFF'FF87, 0x0000'0FFF}, {0x24, "EMR2", 0, 0x0000'0FFF},
    {0x28, "RTSR2", 0, 0x0000'03C3},          {0x2C, "FTSR2", 0, 0x0000'03C3},
    {0x30, "SWIER2", 0, 0x0000'03C3},         {0x34, "PR2", 0, 0x0000'03C3},
};

struct SharedInterrupt {
    std::uint32_t irq;
    std::uint32_t lines;
};
constexpr SharedInterrupt kInterrupts[] = {{6, 0x1},   {7, 0x2},     {8, 0x4},    {9, 0x8},
                                           {10, 0x10}, {23, 0x03E0}, {40, 0xFC00}};

}  // namespace

Exti::Exti(const Surroundings& surroundings, Hooks hooks)
    : env_(surroundings), hooks_(std::move(hooks)), bank_("EXTI", kRegisters, env_.log) {}

void Exti::reset() {
    bank_.reset();
    next_change_ = kNever;
    update_lines();
}

std::uint32_t Exti::triggered_lines() const {
    return (bank_.get(kRtsr1) | bank_.get(kFtsr1)) & kPins;
}

std::uint32_t Exti::levels() const {
    const std::uint32_t lines = triggered_lines();
    std::uint32_t high = 0;
    for (std::uint32_t line = 0; line < kPinLines; ++line) {
        if ((lines >> line & 1U) != 0 && hooks_.is_high(line)) high |= 1U << line;
    }
    return high;
}

void Exti::sample() {
    if (triggered_lines() == 0) return;
    const std::uint32_t before = std::exchange(levels_, levels());
    pend((levels_ & ~before & bank_.get(kRtsr1)) | (before & ~levels_ & bank_.get(kFtsr1)));
    watch();
}

void Exti::advance() {
    if (next_change_ <= env_.now) sample();
}

/// A line that is masked or pending needs no sampling.
void Exti::watch() {
    const std::uint32_t awaited = triggered_lines() & bank_.get(kImr1) & ~bank_.get(kPr1);
    next_change_ = awaited == 0 ? kNever : hooks_.next_change(awaited);
}

void Exti::pend(std::uint32_t lines) {
    bank_.set_bits(kPr1, lines & bank_.get(kImr1));
    update_lines();
}

void Exti::clear(std::uint32_t lines) {
    bank_.clear_bits(kPr1, lines);
    bank_.clear_bits(kSwier1, lines);
}

void Exti::write(std::uint32_t offset, std::uint32_t value) {
    sample();  // the state until now
    const std::uint32_t stored = bank_.checked(offset, value);
    refuse_other_lines(offset, stored);
    switch (offset) {
        case kPr1:
            clear(stored);
            break;
        case kSwier1:
            pend(stored & ~bank_.get(kSwier1) & kPins);
            bank_.set_bits(kSwier1, stored);
            break;
        case kImr1:
            write_mask(stored);
            break;
        case kEmr1:
            if (stored != 0) env_.log.report(Rule::not_modelled, "EXTI.EMR1: events");
            break;
        default:
            bank_.write(offset, stored);
    }
    levels_ = levels();  // selecting a trigger is no edge
    watch();
    update_lines();
}

void Exti::write_mask(std::uint32_t value) {
    const std::uint32_t opened = value & ~bank_.get(kImr1) & kPins;
    for (std::uint32_t line = 0; line < kPinLines; ++line) {
        if ((opened >> line & 1U) != 0 && hooks_.is_input_off(line))
            env_.log.report(Rule::pin_function,
                            fmt::format("EXTI.IMR1: line {} listens to an analog pin", line));
    }
    bank_.set(kImr1, value);
}

void Exti::refuse_other_lines(std::uint32_t offset, std::uint32_t value) {
    const std::uint32_t before = offset == kPr1 ? 0 : bank_.read(offset);
    const std::uint32_t ours = offset <= kPr1 ? kPins : 0;
    if (((value ^ before) & ~ours) != 0)
        env_.log.report(Rule::not_modelled, fmt::format("EXTI: lines of no pin, at offset 0x{:X}", offset));
}

void Exti::update_lines() {
    const std::uint32_t raised = bank_.get(kPr1) & bank_.get(kImr1);
    for (const SharedInterrupt& interrupt : kInterrupts)
        env_.lines.set_line(interrupt.irq, (raised & interrupt.lines) != 0);
}

}  // namespace octoskin::sim::stm32
