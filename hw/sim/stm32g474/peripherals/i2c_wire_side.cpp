// I2C's side of the wire, byte by byte.
#include <algorithm>
#include <utility>

#include "hw/sim/stm32g474/peripherals/i2c.hpp"
#include "hw/sim/stm32g474/peripherals/i2c_registers.hpp"

namespace octoskin::sim::stm32 {

using namespace i2c_model;

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
        if (event_at_ == at) event_at_ = kNever;  // no further event was set
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

// The hardware sends a STOP by itself, for any value of AUTOEND.
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

}  // namespace octoskin::sim::stm32
