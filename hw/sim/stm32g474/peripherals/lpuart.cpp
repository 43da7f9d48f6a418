#include "hw/sim/stm32g474/peripherals/lpuart.hpp"

#include <fmt/format.h>

#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kIrq = 91;
constexpr std::uint32_t kCr1 = 0x00;
constexpr std::uint32_t kBrr = 0x0C;
constexpr std::uint32_t kIsr = 0x1C;
constexpr std::uint32_t kIcr = 0x20;
constexpr std::uint32_t kTdr = 0x28;
constexpr std::uint32_t kPresc = 0x2C;
constexpr std::uint32_t kTransmitEmpty = 1U << 7;
constexpr std::uint32_t kTransmitComplete = 1U << 6;
constexpr std::uint32_t kTransmitAcknowledge = 1U << 21;
constexpr std::uint32_t kBaud = 115'200;

constexpr RegisterSpec kRegisters[] = {
    {0x00, "CR1", 0, 0xF3FF'7FFF},   {0x04, "CR2", 0, 0xFF0F'B010}, {0x08, "CR3", 0, 0xFEF0'F7C9},
    {0x0C, "BRR", 0, 0x000F'FFFF},   {0x18, "RQR", 0, 0x0000'001E}, {0x1C, "ISR", 0x0000'00C0, 0},
    {0x20, "ICR", 0, 0x0012'025F},   {0x24, "RDR", 0, 0},           {0x28, "TDR", 0, 0x0000'01FF},
    {0x2C, "PRESC", 0, 0x0000'000F},
};

}  // namespace

Lpuart::Lpuart(const Surroundings& surroundings, Hooks hooks)
    : env_(surroundings), hooks_(std::move(hooks)), bank_("LPUART1", kRegisters, env_.log) {}

void Lpuart::reset() {
    bank_.reset();
    waiting_.reset();
    shifting_.reset();
    shifted_at_ = kNever;
    update_line();
}

bool Lpuart::takes_narrow_writes(std::uint32_t offset) const {
    return offset == kTdr;
}

std::uint32_t Lpuart::read(std::uint32_t offset) {
    return bank_.read(offset);
}

void Lpuart::advance() {
    if (env_.now < shifted_at_) return;
    hooks_.on_byte(*shifting_);
    shifting_.reset();
    shifted_at_ = kNever;
    load();
    update_line();
}

/// Moves a byte from the data register into the shift register.
void Lpuart::load() {
    if (shifting_ || !is_on()) return;
    if (!waiting_) {
        bank_.set_bits(kIsr, kTransmitComplete);
        return;
    }
    shifting_ = std::exchange(waiting_, std::nullopt);
    bank_.set_bits(kIsr, kTransmitEmpty);
    const std::uint64_t clocks = std::uint64_t{10} * bank_.get(kBrr) / 256;  // start, 8 bits, stop
    shifted_at_ = env_.now + span_of(clocks, hooks_.clock_hz());
}

void Lpuart::check_baud_rate() {
    const std::uint32_t divider = bank_.get(kBrr);
    if (divider < 0x300) {
        env_.log.report(Rule::bus_timing, fmt::format("LPUART1.BRR=0x{:X} is below 0x300", divider));
        return;
    }
    const std::uint64_t baud = std::uint64_t{256} * hooks_.clock_hz() / divider;
    if (baud < kBaud * 98ULL / 100 || baud > kBaud * 102ULL / 100)
        env_.log.report(Rule::bus_timing, fmt::format("LPUART1 at {} baud, not 115200", baud));
    if (!hooks_.has_pin()) env_.log.report(Rule::pin_function, "LPUART1 enabled without its TX pin");
}

void Lpuart::write(std::uint32_t offset, std::uint32_t value) {
    const bool was_on = is_on();
    switch (offset) {
        case kTdr:
            if (!is_on())
                env_.log.report(Rule::wrong_state, "LPUART1.TDR written while the transmitter is off");
            if (waiting_) env_.log.report(Rule::data_lost, "LPUART1.TDR overwritten");
            waiting_ = static_cast<char>(value & 0xFFU);
            bank_.clear_bits(kIsr, kTransmitEmpty | kTransmitComplete);
            load();
            break;
        case kBrr:
        case kPresc:
            if ((bank_.get(kCr1) & 1U) != 0)
                env_.log.report(Rule::wrong_state,
                                fmt::format("LPUART1: offset 0x{:X} written with UE=1", offset));
            bank_.write(offset, value);
            break;
        case kIcr:
            (void)bank_.checked(offset, value);
            bank_.clear_bits(kIsr, value & kTransmitComplete);
            break;
        default:
            bank_.write(offset, value);
    }
    if (!was_on && is_on()) {
        bank_.set_bits(kIsr, kTransmitAcknowledge);
        check_baud_rate();
    }
    update_line();
}

void Lpuart::update_line() {
    const std::uint32_t enabled = bank_.get(kCr1) & bank_.get(kIsr);
    env_.lines.set_line(kIrq, (enabled & (kTransmitEmpty | kTransmitComplete)) != 0);
}

}  // namespace octoskin::sim::stm32
