#include "hw/sim/stm32g474/peripherals/timer2.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kIrq = 28;
constexpr std::uint32_t kCr1 = 0x00;
constexpr std::uint32_t kDier = 0x0C;
constexpr std::uint32_t kSr = 0x10;
constexpr std::uint32_t kEgr = 0x14;
constexpr std::uint32_t kCcmr1 = 0x18;
constexpr std::uint32_t kCcmr2 = 0x1C;
constexpr std::uint32_t kCnt = 0x24;
constexpr std::uint32_t kPsc = 0x28;
constexpr std::uint32_t kArr = 0x2C;
constexpr std::uint32_t kCcr1 = 0x34;
constexpr std::uint32_t kUpdate = 1;
constexpr std::uint32_t kModelledInterrupts = 0x1F;  // update and four compares

constexpr RegisterSpec kRegisters[] = {
    {0x00, "CR1", 0, 0x0000'1BFF},   {0x04, "CR2", 0, 0x0200'00F8},   {0x08, "SMCR", 0, 0x0331'FFFF},
    {0x0C, "DIER", 0, 0x00F0'5F5F},  {0x10, "SR", 0, 0x00F0'1E5F},    {0x14, "EGR", 0, 0x0000'005F},
    {0x18, "CCMR1", 0, 0x0101'FFFF}, {0x1C, "CCMR2", 0, 0x0101'FFFF}, {0x20, "CCER", 0, 0x0000'BBBB},
    {0x24, "CNT", 0, 0xFFFF'FFFF},   {0x28, "PSC", 0, 0x0000'FFFF},   {0x2C, "ARR", 0xFFFF'FFFF, 0xFFFF'FFFF},
    {0x34, "CCR1", 0, 0xFFFF'FFFF},  {0x38, "CCR2", 0, 0xFFFF'FFFF},  {0x3C, "CCR3", 0, 0xFFFF'FFFF},
    {0x40, "CCR4", 0, 0xFFFF'FFFF},
};

constexpr std::uint32_t compare_register(std::uint32_t channel) {
    return kCcr1 + 4 * channel;
}

}  // namespace

Timer2::Timer2(const Surroundings& surroundings, std::function<std::uint32_t()> clock_hz)
    : env_(surroundings), clock_hz_(std::move(clock_hz)), bank_("TIM2", kRegisters, env_.log) {}

void Timer2::reset() {
    bank_.reset();
    counter_ = 0;
    divider_ = 1;
    part_ = 0;
    counted_to_ = env_.now;
    update_line();
}

/// Counts until the counter is `value`: at least 1.
std::uint64_t Timer2::counts_to(std::uint32_t value) const {
    if (value > bank_.get(kArr)) return ~std::uint64_t{0};
    const std::uint64_t ahead = (std::uint64_t{value} + modulus() - counter_) % modulus();
    return ahead == 0 ? modulus() : ahead;
}

std::int64_t Timer2::span_of_counts(std::uint64_t counts) const {
    return span_of(counts * divider_ - part_, clock_hz_());
}

void Timer2::advance() {
    if (!is_counting()) {
        counted_to_ = env_.now;
        return;
    }
    const std::uint64_t clocks = periods_in(env_.now.ps - counted_to_.ps, clock_hz_());
    counted_to_ = counted_to_ + span_of(clocks, clock_hz_());
    const std::uint64_t all = part_ + clocks;
    const std::uint64_t counts = all / divider_;
    part_ = all % divider_;
    if (counts == 0) return;
    std::uint32_t events = 0;
    for (std::uint32_t channel = 0; channel < 4; ++channel) {
        if (counts >= counts_to(bank_.get(compare_register(channel)))) events |= 2U << channel;
    }
    if (counts >= modulus() - counter_) events |= kUpdate;
    counter_ = static_cast<std::uint32_t>((counter_ + counts) % modulus());
    if (events != 0) {
        bank_.set_bits(kSr, events);
        update_line();
    }
}

BoardTime Timer2::next_event() const {
    const std::uint32_t enabled = bank_.get(kDier) & ~bank_.get(kSr);
    if (!is_counting() || (enabled & kModelledInterrupts) == 0) return kNever;
    std::uint64_t counts = ~std::uint64_t{0};
    if ((enabled & kUpdate) != 0) counts = modulus() - counter_;
    for (std::uint32_t channel = 0; channel < 4; ++channel) {
        if ((enabled >> (channel + 1) & 1U) != 0)
            counts = std::min(counts, counts_to(bank_.get(compare_register(channel))));
    }
    return counts == ~std::uint64_t{0} ? kNever : counted_to_ + span_of_counts(counts);
}

std::uint32_t Timer2::read(std::uint32_t offset) {
    return offset == kCnt ? counter_ : bank_.read(offset);
}

void Timer2::update_event() {
    divider_ = std::uint64_t{bank_.get(kPsc)} + 1;
    counter_ = 0;
    part_ = 0;
    counted_to_ = zeroed_at_ = env_.now;
    bank_.set_bits(kSr, kUpdate);
}

void Timer2::write(std::uint32_t offset, std::uint32_t value) {
    switch (offset) {
        case kSr:
            bank_.set(kSr, bank_.get(kSr) & value);  // cleared by 0
            break;
        case kEgr:
            (void)bank_.checked(kEgr, value);
            if ((value & kUpdate) != 0) update_event();
            bank_.set_bits(kSr, value & 0x1EU);
            break;
        case kCnt:
            counter_ = value;
            part_ = 0;
            break;
        case kCr1:
            if ((value & 0x70U) != 0) env_.log.report(Rule::not_modelled, "TIM2.CR1: only counting up");
            bank_.write(offset, value);
            break;
        case kCcmr1:
        case kCcmr2:
            if ((value & 0x0303U) != 0) env_.log.report(Rule::not_modelled, "TIM2: input capture");
            bank_.write(offset, value);
            break;
        case kDier:
            if ((value & ~kModelledInterrupts) != 0)
                env_.log.report(Rule::not_modelled, fmt::format("TIM2.DIER=0x{:X}", value));
            bank_.write(offset, value);
            break;
        default:
            bank_.write(offset, value);
    }
    update_line();
}

void Timer2::update_line() {
    env_.lines.set_line(kIrq, (bank_.get(kDier) & bank_.get(kSr) & kModelledInterrupts) != 0);
}

}  // namespace octoskin::sim::stm32
