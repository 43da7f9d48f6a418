#include "firmware/port/stm32g4/i2c_controller.hpp"

#include <cassert>

#include "firmware/port/stm32g4/cpu.hpp"

namespace octoskin::stm32g4 {

namespace {

using F = Field<I2cMap>;

constexpr std::uint32_t kControl = F("CR1.PE")(1) | F("CR1.TXIE")(1) | F("CR1.RXIE")(1) | F("CR1.NACKIE")(1) |
                                   F("CR1.STOPIE")(1) | F("CR1.TCIE")(1) | F("CR1.ERRIE")(1);
constexpr std::uint32_t kAllFlags =
    F("ICR.NACKCF")(1) | F("ICR.STOPCF")(1) | F("ICR.BERRCF")(1) | F("ICR.ARLOCF")(1) | F("ICR.OVRCF")(1);

constexpr int kFreeingClocks =
    9;  // a byte and its acknowledge: after these, every device has released the bus
constexpr Microseconds kHalfClock{5};  // 100 kHz
constexpr Drive kOpen = Drive::open_drain;

std::uint32_t addressed(i2c::Address address, std::size_t bytes) {
    return F("CR2.SADD")(std::uint32_t{address} << 1U) | F("CR2.NBYTES")(static_cast<std::uint32_t>(bytes));
}

}  // namespace

void I2cController::start(std::uint32_t timing) {
    rcc.set(wiring_.clock, 1);
    (void)rcc.read(wiring_.clock.in);
    disable();
    wiring_.registers.write("TIMINGR", timing);
    wiring_.scl.make_alternate(wiring_.function, kOpen);
    wiring_.sda.make_alternate(wiring_.function, kOpen);
    enable();
    cpu::enable(wiring_.event, cpu::Priority::transfer);
    cpu::enable(wiring_.error, cpu::Priority::transfer);
}

void I2cController::enable() const {
    wiring_.registers.write("CR1", kControl);
}

/// Releases both lines and clears all flags. The disable must last 3 APB clocks (RM0440); the reads take this
/// time.
void I2cController::disable() const {
    wiring_.registers.write("CR1", 0);
    (void)wiring_.registers.read("CR1");
    (void)wiring_.registers.read("CR1");
    (void)wiring_.registers.read("CR1");
}

// --- called from the main loop

bool I2cController::is_line_free() const {
    return !wiring_.registers.is_set("ISR.BUSY") && wiring_.scl.is_high() && wiring_.sda.is_high();
}

void I2cController::submit(const i2c::Transfer& transfer, NodeTime, NodeTime deadline) {
    assert(!is_busy());
    assert(transfer.write.size() <= kI2cBytesMax && transfer.read.size() <= kI2cBytesMax);
    // A START on a busy bus would wait for ever without an error.
    const bool is_free = is_line_free() || recover();
    transfer_ = transfer;
    deadline_ = deadline;
    written_ = 0;
    received_ = 0;
    refusal_.reset();
    if (!is_free) {
        fail(i2c::TransferError::bus_stuck);
    } else if (transfer.write.empty() && !transfer.read.empty()) {
        begin_read();
    } else {
        begin_write();
    }
}

i2c::TransferState I2cController::poll(NodeTime now) {
    if (is_in_flight() && is_reached(deadline_, now)) {
        const cpu::MaskedSection masked;
        if (is_in_flight()) {  // it may have ended just before the mask
            disable();
            enable();
            fail(i2c::TransferError::timeout);
        }
    }
    if (phase_ == Phase::idle) return i2c::TransferState::idle;
    if (is_in_flight()) return i2c::TransferState::pending;
    const bool is_done = phase_ == Phase::done;
    phase_ = Phase::idle;
    return is_done ? i2c::TransferState::done : i2c::TransferState::failed;
}

std::optional<NodeTime> I2cController::deadline() const {
    if (!is_in_flight()) return std::nullopt;
    return deadline_;
}

bool I2cController::recover() {
    disable();  // no more interrupts from here on
    phase_ = Phase::idle;
    const bool is_free = free_lines();
    enable();
    return is_free;
}

/// UM10204 3.1.16 "bus clear", then a STOP, so that a device in the middle of a transfer returns to idle.
bool I2cController::free_lines() const {
    const auto drive = [this](const Pin& pin, bool is_high) {
        pin.set(is_high);
        timer_.wait(kHalfClock);
    };
    const Pin& scl = wiring_.scl;
    const Pin& sda = wiring_.sda;
    scl.set(true);
    sda.set(true);
    scl.make_output(kOpen);
    sda.make_output(kOpen);
    timer_.wait(kHalfClock);
    for (int i = 0; i < kFreeingClocks && !sda.is_high(); ++i) {
        drive(scl, false);
        drive(scl, true);
    }
    drive(scl, false);
    drive(sda, false);
    drive(scl, true);
    drive(sda, true);
    const bool is_free = scl.is_high() && sda.is_high();
    scl.make_alternate(wiring_.function, kOpen);
    sda.make_alternate(wiring_.function, kOpen);
    return is_free;
}

// --- called from the main loop and from the interrupt

/// The first byte is written before the START: ST's workaround for a transmission that stalls after the first
/// byte (erratum I2C2-190208).
void I2cController::begin_write() {
    phase_ = Phase::writing;
    if (!transfer_.write.empty()) feed();
    const bool is_last = transfer_.read.empty();
    wiring_.registers.write("CR2", addressed(transfer_.address, transfer_.write.size()) |
                                       F("CR2.AUTOEND")(is_last ? 1 : 0) | F("CR2.START")(1));
}

void I2cController::begin_read() {
    phase_ = Phase::reading;
    wiring_.registers.write("CR2", addressed(transfer_.address, transfer_.read.size()) | F("CR2.RD_WRN")(1) |
                                       F("CR2.AUTOEND")(1) | F("CR2.START")(1));
}

void I2cController::fail(i2c::TransferError error) {
    error_ = error;
    phase_ = Phase::failed;
}

// --- called from the interrupt

void I2cController::on_interrupt() {
    const std::uint32_t isr = wiring_.registers.read("ISR");
    const auto is_set = [isr](F flag) __attribute__((always_inline)) {
        return flag.of(isr) != 0;
    };
    if (!is_in_flight()) {
        wiring_.registers.write("ICR", kAllFlags);
        return;
    }
    if (is_set("ISR.ARLO")) {
        disable();
        enable();
        fail(i2c::TransferError::arbitration_lost);
        return;
    }
    // The controller may report a bus error that did not happen. If the transfer did fail, its deadline ends
    // it.
    if (is_set("ISR.BERR") || is_set("ISR.OVR")) {
        wiring_.registers.write("ICR", F("ICR.BERRCF")(1) | F("ICR.OVRCF")(1));
    }
    if (is_set("ISR.NACKF")) note_nack(isr);
    if (is_set("ISR.TXIS")) feed();
    if (is_set("ISR.RXNE")) take();
    if (is_set("ISR.TC")) begin_read();
    if (is_set("ISR.STOPF")) end();
}

/// The controller requests no more bytes than NBYTES; an extra request would be answered with 0.
void I2cController::feed() {
    const bool is_left = written_ < transfer_.write.size();
    wiring_.registers.write("TXDR", is_left ? transfer_.write[written_] : std::uint8_t{0});
    if (is_left) ++written_;
}

void I2cController::take() {
    const auto byte = static_cast<std::uint8_t>(wiring_.registers.get("RXDR.RXDATA"));
    if (received_ < transfer_.read.size()) transfer_.read[received_++] = byte;
}

/// The controller sends the STOP itself. The address was refused if the first byte, written before the START,
/// is still waiting. In a read, only the address can be refused.
void I2cController::note_nack(std::uint32_t isr) {
    wiring_.registers.write("ICR", F("ICR.NACKCF")(1));
    const bool is_first_waiting = written_ <= 1 && F("ISR.TXE").of(isr) == 0;
    const bool is_address = phase_ == Phase::reading || transfer_.write.empty() || is_first_waiting;
    refusal_ = is_address ? i2c::TransferError::nack_address : i2c::TransferError::nack_data;
}

void I2cController::end() {
    wiring_.registers.write("ICR", F("ICR.STOPCF")(1));
    wiring_.registers.write("CR2", 0);
    // An unsent byte would become the first byte of the next transfer: writing TXE flushes it.
    wiring_.registers.write("ISR", F("ISR.TXE")(1));
    const bool is_whole = written_ == transfer_.write.size() && received_ == transfer_.read.size();
    if (refusal_) {
        fail(*refusal_);
    } else if (!is_whole) {
        fail(i2c::TransferError::nack_data);  // another device sent the STOP
    } else {
        phase_ = Phase::done;
    }
}

}  // namespace octoskin::stm32g4
