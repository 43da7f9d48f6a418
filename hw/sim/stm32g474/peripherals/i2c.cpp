#include "hw/sim/stm32g474/peripherals/i2c.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kCr1 = 0x00;
constexpr std::uint32_t kCr2 = 0x04;
constexpr std::uint32_t kTimingr = 0x10;
constexpr std::uint32_t kIsr = 0x18;
constexpr std::uint32_t kIcr = 0x1C;
constexpr std::uint32_t kRxdr = 0x24;
constexpr std::uint32_t kTxdr = 0x28;

constexpr RegisterSpec kRegisters[] = {
    {0x00, "CR1", 0, 0x00FF'DFFF},  {0x04, "CR2", 0, 0x07FF'FFFF},     {0x08, "OAR1", 0, 0x0000'87FF},
    {0x0C, "OAR2", 0, 0x0000'87FE}, {0x10, "TIMINGR", 0, 0xF0FF'FFFF}, {0x14, "TIMEOUTR", 0, 0x8FFF'9FFF},
    {0x18, "ISR", 1, 0x0000'0003},  {0x1C, "ICR", 0, 0x0000'3F38},     {0x20, "PECR", 0, 0},
    {0x24, "RXDR", 0, 0},           {0x28, "TXDR", 0, 0x0000'00FF},
};

// CR1
constexpr std::uint32_t kModelledControl = 0x0000'1FFF;  // enable, interrupts, filters
// CR2
constexpr std::uint32_t kReadBit = 10;
constexpr std::uint32_t kStart = 1U << 13;
constexpr std::uint32_t kStop = 1U << 14;
constexpr std::uint32_t kReload = 24;
constexpr std::uint32_t kAutoEnd = 25;
// ISR
constexpr std::uint32_t kTxe = 1U << 0;
constexpr std::uint32_t kTxis = 1U << 1;
constexpr std::uint32_t kRxne = 1U << 2;
constexpr std::uint32_t kNackf = 1U << 4;
constexpr std::uint32_t kStopf = 1U << 5;
constexpr std::uint32_t kTc = 1U << 6;
constexpr std::uint32_t kTcr = 1U << 7;
constexpr std::uint32_t kArlo = 1U << 9;
constexpr std::uint32_t kBusy = 1U << 15;
constexpr std::uint32_t kErrors = 0x3F00;  // BERR ARLO OVR PECERR TIMEOUT ALERT

constexpr std::uint32_t kAddressBits = 10;  // START, address, acknowledge
constexpr std::uint32_t kByteBits = 9;

struct InterruptPair {
    std::uint32_t event;
    std::uint32_t error;
};
constexpr InterruptPair kInterrupts[] = {{31, 32}, {33, 34}, {92, 93}, {82, 83}};

// UM10204 table 10, picoseconds: low and high of the clock.
struct ClockMinima {
    std::int64_t period;
    std::int64_t low;
    std::int64_t high;
};
constexpr ClockMinima kStandard{10'000'000, 4'700'000, 4'000'000};
constexpr ClockMinima kFast{2'500'000, 1'300'000, 600'000};

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

// PE=0 lets both lines go and clears flags and the state machine (RM0440 41.4.6).
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

std::int64_t I2c::clock_period() const {
    const std::uint32_t timing = bank_.get(kTimingr);
    const std::uint64_t hz = hooks_.kernel_hz();
    const std::uint64_t clocks =
        std::uint64_t{(timing & 0xFFU) + (timing >> 8U & 0xFFU) + 2} * ((timing >> 28U) + 1);
    // Twice filter (50..260 ns) and synchronisation (2..3 clocks), a rise and a fall.
    const std::int64_t edges = edges_ == BusEdges::typical ? 2 * 110'000 + 120'000 + span_of(5, hz)
                                                           : 2 * 260'000 + 600'000 + span_of(6, hz);
    return span_of(clocks, hz) + edges;
}

// --- what software does

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

void I2c::check_start() {
    if (phase_ != Phase::idle && phase_ != Phase::complete) {
        env_.log.report(Rule::start_while_busy, fmt::format("{}: START in the middle of a transfer", name()));
    } else if (phase_ == Phase::idle && is_bus_busy()) {
        env_.log.report(Rule::start_while_busy,
                        fmt::format("{}: START while a line is low: it waits in silence", name()));
    }
    if (is_checked_) return;
    is_checked_ = true;
    if (!hooks_.has_pins()) {
        env_.log.report(Rule::pin_function,
                        fmt::format("{}: START, but its pins are not alternate, open-drain", name()));
    }
    check_timing();
}

// At the fastest: 50 ns of filter, two clocks, no rise time.
void I2c::check_timing() {
    const std::uint32_t timing = bank_.get(kTimingr);
    const std::uint64_t hz = hooks_.kernel_hz();
    const std::uint64_t prescaler = (timing >> 28U) + 1;
    const std::int64_t added = 50'000 + span_of(2, hz);
    const std::int64_t low = span_of(((timing & 0xFFU) + 1) * prescaler, hz) + added;
    const std::int64_t high = span_of(((timing >> 8U & 0xFFU) + 1) * prescaler, hz) + added;
    const ClockMinima& minima = low + high >= kStandard.period ? kStandard : kFast;
    if (low + high < kFast.period || low < minima.low || high < minima.high) {
        env_.log.report(Rule::bus_timing, fmt::format("{}.TIMINGR=0x{:08X} at {} Hz: low {} ns, high {} ns",
                                                      name(), timing, hz, low / 1000, high / 1000));
    }
}

// --- what happens on the wire

void I2c::wait_bits(Phase phase, std::uint32_t bits) {
    // Several bytes may pass within one call of advance: each begins where the one before ended.
    const BoardTime from = event_at_ != kNever ? event_at_ : env_.now;
    phase_ = phase;
    phase_begun_ = from;
    event_at_ = from + static_cast<std::int64_t>(bits) * clock_period();
    wire_.count_bits(bits);
}

void I2c::advance() {
    while (event_at_ <= env_.now) {
        const BoardTime at = event_at_;
        switch (phase_) {
            case Phase::address:
                end_address();
                break;
            case Phase::sending:
                end_sending();
                break;
            case Phase::receiving:
                end_receiving();
                break;
            case Phase::stopping:
                end_stop();
                break;
            case Phase::idle:
            case Phase::waiting_for_bus:
            case Phase::wants_byte:
            case Phase::complete:
            case Phase::wants_room:
            case Phase::stretched:
                break;
        }
        if (event_at_ == at) event_at_ = kNever;  // nothing followed
        update();
    }
}

void I2c::begin_start() {
    bank_.clear_bits(kIsr, kTc);
    if (phase_ == Phase::idle) {
        if (is_bus_busy()) {
            phase_ = Phase::waiting_for_bus;
            transfer_begun_ = phase_begun_ = env_.now;
            return;
        }
        transfer_begun_ = env_.now;
    }
    event_at_ = kNever;
    is_reading_ = control(kReadBit, 1) != 0;
    bytes_left_ = to_load_ = control(16, 8);
    wait_bits(Phase::address, kAddressBits);
}

void I2c::end_address() {
    const auto address = static_cast<std::uint8_t>(control(1, 7));
    const I2cWire::Answer answer = wire_.start(address, is_reading_, hooks_.true_time());
    bank_.clear_bits(kCr2, kStart);
    switch (answer) {
        case I2cWire::Answer::refused:
            refuse();
            break;
        case I2cWire::Answer::arbitration_lost:
            bank_.set_bits(kIsr, kArlo);
            phase_ = Phase::idle;
            busy_ps_ += event_at_.ps - transfer_begun_.ps;
            break;
        case I2cWire::Answer::stretched:
            phase_ = Phase::stretched;
            break;
        case I2cWire::Answer::acknowledged:
            if (bytes_left_ == 0) {
                after_byte();
            } else if (is_reading_) {
                begin_receiving();
            } else {
                load_shift_register();
            }
            break;
    }
}

void I2c::load_shift_register() {
    if (has_flag(kTxe)) {
        phase_ = Phase::wants_byte;
        phase_begun_ = event_at_ != kNever ? event_at_ : env_.now;
        bank_.set_bits(kIsr, kTxis);
        return;
    }
    shift_register_ = static_cast<std::uint8_t>(bank_.get(kTxdr));
    --to_load_;
    bank_.set_bits(kIsr, kTxe | (to_load_ > 0 ? kTxis : 0));
    wait_bits(Phase::sending, kByteBits);
}

void I2c::end_sending() {
    if (wire_.write(shift_register_, hooks_.true_time()) != I2cWire::Answer::acknowledged) return refuse();
    --bytes_left_;
    bytes_left_ == 0 ? after_byte() : load_shift_register();
}

void I2c::begin_receiving() {
    shift_register_ = wire_.read(hooks_.true_time());
    wait_bits(Phase::receiving, kByteBits);
}

void I2c::end_receiving() {
    if (has_flag(kRxne)) {
        phase_ = Phase::wants_room;
        return;
    }
    store_received();
}

void I2c::store_received() {
    bank_.set(kRxdr, shift_register_);
    bank_.set_bits(kIsr, kRxne);
    --bytes_left_;
    bytes_left_ == 0 ? after_byte() : begin_receiving();
}

void I2c::after_byte() {
    if (control(kReload, 1) != 0) {
        bank_.set_bits(kIsr, kTcr);
        phase_ = Phase::complete;
    } else if (control(kAutoEnd, 1) != 0 || (bank_.get(kCr2) & kStop) != 0) {
        begin_stop();
    } else {
        bank_.set_bits(kIsr, kTc);
        phase_ = Phase::complete;
    }
}

// The hardware sends a STOP of its own, whatever AUTOEND says.
void I2c::refuse() {
    bank_.set_bits(kIsr, kNackf);
    bank_.clear_bits(kIsr, kTxis);
    begin_stop();
}

void I2c::begin_stop() {
    bank_.clear_bits(kIsr, kTc);
    wait_bits(Phase::stopping, 1);
}

void I2c::end_stop() {
    wire_.stop(hooks_.true_time());
    busy_ps_ += event_at_.ps - transfer_begun_.ps;
    phase_ = Phase::idle;
    bank_.set_bits(kIsr, kStopf);
    bank_.clear_bits(kCr2, kStop);
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
