#include "hw/sim/stm32g474/peripherals/i2c.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hw/sim/stm32g474/peripherals/i2c_registers.hpp"

namespace octoskin::sim::stm32 {

using namespace i2c_model;

namespace {

constexpr RegisterSpec kRegisters[] = {
    {0x00, "CR1", 0, 0x00FF'DFFF},  {0x04, "CR2", 0, 0x07FF'FFFF},     {0x08, "OAR1", 0, 0x0000'87FF},
    {0x0C, "OAR2", 0, 0x0000'87FE}, {0x10, "TIMINGR", 0, 0xF0FF'FFFF}, {0x14, "TIMEOUTR", 0, 0x8FFF'9FFF},
    {0x18, "ISR", 1, 0x0000'0003},  {0x1C, "ICR", 0, 0x0000'3F38},     {0x20, "PECR", 0, 0},
    {0x24, "RXDR", 0, 0},           {0x28, "TXDR", 0, 0x0000'00FF},
};

struct InterruptPair {
    std::uint32_t event;
    std::uint32_t error;
};
constexpr InterruptPair kInterrupts[] = {{31, 32}, {33, 34}, {92, 93}, {82, 83}};

}  // namespace

I2c::I2c(const Surroundings& surroundings, std::uint32_t number, I2cWire& wire, BusEdges edges, Hooks hooks)
    : name_{'I', '2', 'C', static_cast<char>('0' + number)},
      env_(surroundings),
      number_(number),
      wire_(wire),
      edges_(edges),
      hooks_(std::move(hooks)),
      bank_(name(), kRegisters, env_.log) {}

void I2c::reset() {
    disable();
    bank_.reset();
    was_read_disabled_ = true;
    update();
}

// PE=0 releases both lines and clears flags and the state machine (RM0440 41.4.6).
void I2c::disable() {
    if (phase_ != Phase::idle) {
        const std::int64_t since = env_.now.ps - phase_begun_.ps;
        const auto bits = static_cast<std::uint32_t>(std::min<std::int64_t>(since / clock_period(), 9));
        wire_.abandon(phase_ == Phase::receiving ? bits : 9);
        busy_ps_ += env_.now.ps - transfer_begun_.ps;
    }
    phase_ = Phase::idle;
    event_at_ = kNever;
    bank_.set(kIsr, kTxe);
    bank_.clear_bits(kCr2, kStart | kStop);
    is_checked_ = false;
}

bool I2c::takes_narrow_writes(std::uint32_t offset) const {
    return offset == kTxdr;
}

bool I2c::is_bus_busy() {
    return phase_ != Phase::idle || wire_.is_scl_low() || wire_.is_sda_low(hooks_.true_time());
}

// --- software side

std::uint32_t I2c::read(std::uint32_t offset) {
    if (offset == kRxdr) return read_data();
    if (offset == kIsr) return bank_.get(kIsr) | (is_enabled() && is_bus_busy() ? kBusy : 0);
    if (offset == kCr1 && !is_enabled()) was_read_disabled_ = true;
    return bank_.read(offset);
}

std::uint32_t I2c::read_data() {
    if (!has_flag(kRxne)) env_.log.report(Rule::data_lost, fmt::format("{}.RXDR read while empty", name()));
    bank_.clear_bits(kIsr, kRxne);
    const std::uint32_t data = bank_.get(kRxdr);
    if (phase_ == Phase::wants_room) store_received();
    update();
    return data;
}

void I2c::write(std::uint32_t offset, std::uint32_t value) {
    switch (offset) {
        case kCr1:
            write_control_1(value);
            break;
        case kCr2:
            write_control_2(value);
            break;
        case kTimingr:
            if (is_enabled()) {
                env_.log.report(Rule::wrong_state, fmt::format("{}.TIMINGR written with PE=1", name()));
            }
            bank_.write(offset, value);
            break;
        case kIsr:
            write_status(value);
            break;
        case kIcr:
            (void)bank_.checked(kIcr, value);
            bank_.clear_bits(kIsr, value & (kNackf | kStopf | kErrors));
            break;
        case kTxdr:
            write_data(value);
            break;
        default:
            bank_.write(offset, value);
    }
    update();
}

void I2c::write_control_1(std::uint32_t value) {
    const bool was_enabled = is_enabled();
    bank_.write(kCr1, value);
    if ((value & ~kModelledControl) != 0)
        env_.log.report(Rule::not_modelled,
                        fmt::format("{}.CR1=0x{:X}: DMA, target mode or SMBus", name(), value));
    if (was_enabled && !is_enabled()) {
        disable();
        was_read_disabled_ = false;
    }
    if (!was_enabled && is_enabled() && !was_read_disabled_) {
        env_.log.report(Rule::wrong_state,
                        fmt::format("{}.CR1: PE set again without reading it back as 0 (3 clocks)", name()));
    }
}

void I2c::write_control_2(std::uint32_t value) {
    if (!is_enabled()) {
        if ((value & kStart) != 0)
            env_.log.report(Rule::wrong_state, fmt::format("{}: START with PE=0", name()));
        bank_.write(kCr2, value & ~(kStart | kStop));
        return;
    }
    const bool is_pending = (bank_.get(kCr2) & kStart) != 0;
    if (is_pending) {
        env_.log.report(Rule::wrong_state, fmt::format("{}.CR2 written while START is still set", name()));
    }
    if ((value >> 11U & 3U) != 0)
        env_.log.report(Rule::not_modelled, fmt::format("{}: 10-bit addresses", name()));
    // START and STOP cannot be cleared by writing 0.
    bank_.write(kCr2, value | (bank_.get(kCr2) & (kStart | kStop)));
    if ((value & kStart) != 0 && !is_pending) {
        check_start();
        begin_start();
    } else if ((value & kStop) != 0 && phase_ == Phase::complete) {
        begin_stop();
    } else if (phase_ == Phase::complete && has_flag(kTcr) && control(16, 8) != 0) {
        bytes_left_ = to_load_ = control(16, 8);
        bank_.clear_bits(kIsr, kTcr);
        is_reading_ ? begin_receiving() : load_shift_register();
    }
}

void I2c::write_status(std::uint32_t value) {
    (void)bank_.checked(kIsr, value);
    if ((value & kTxe) != 0) bank_.set_bits(kIsr, kTxe);  // flushes TXDR
    if ((value & kTxis) != 0) env_.log.report(Rule::not_modelled, fmt::format("{}.ISR.TXIS set", name()));
}

void I2c::write_data(std::uint32_t value) {
    if (!is_enabled()) env_.log.report(Rule::wrong_state, fmt::format("{}.TXDR written with PE=0", name()));
    if (!has_flag(kTxe)) {
        env_.log.report(Rule::data_lost, fmt::format("{}.TXDR overwritten before its byte was sent", name()));
    }
    bank_.write(kTxdr, value);
    bank_.clear_bits(kIsr, kTxe | kTxis);
    if (phase_ == Phase::wants_byte) load_shift_register();
}

void I2c::update() {
    const std::uint32_t flags = is_enabled() ? bank_.get(kIsr) : 0;
    const std::uint32_t enabled = bank_.get(kCr1);
    const auto asks = [&](std::uint32_t enable, std::uint32_t flag) {
        return (enabled >> enable & 1U) != 0 && (flags & flag) != 0;
    };
    env_.lines.set_line(kInterrupts[number_ - 1].event, asks(1, kTxis) || asks(2, kRxne) || asks(4, kNackf) ||
                                                            asks(5, kStopf) || asks(6, kTc | kTcr));
    env_.lines.set_line(kInterrupts[number_ - 1].error, asks(7, kErrors));
}

}  // namespace octoskin::sim::stm32
