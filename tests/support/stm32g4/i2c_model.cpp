#include "tests/support/stm32g4/i2c_model.hpp"

#include <fmt/format.h>

#include <utility>

namespace octoskin::test {

I2cModel::I2cModel(AddressSpace& space, const Registers& registers) : space_(space), registers_(registers) {
    const auto at = [&](stm32g4::Register<stm32g4::I2cMap> where) { return registers.base() + where.offset; };
    word("ISR") = F("ISR.TXE").mask();
    space.on_write(at("CR1"), [this](std::uint32_t& control, std::uint32_t value) {
        control = value;
        if (F("CR1.PE").of(value) != 0) return;
        phase_ = Phase::idle;  // a reset of everything but the settings
        word("ISR") = F("ISR.TXE").mask();
        word("CR2") &= ~F("CR2.START").mask();
    });
    space.on_write(at("CR2"), [this](std::uint32_t& control, std::uint32_t value) {
        control = value;
        if (F("CR2.START").of(value) == 0) return;
        phase_ = Phase::starting;
        lower("ISR.TC");
    });
    space.on_write(at("TXDR"), [this](std::uint32_t& data, std::uint32_t value) {
        data = value & 0xFFU;
        lower("ISR.TXE");
        lower("ISR.TXIS");
    });
    space.on_write(at("ISR"), [this](std::uint32_t&, std::uint32_t value) {
        if (F("ISR.TXE").of(value) != 0) raise("ISR.TXE");
    });
    space.on_write(at("ICR"), [this](std::uint32_t&, std::uint32_t value) { word("ISR") &= ~value; });
    space.before_read(at("RXDR"), [this](std::uint32_t&) { lower("ISR.RXNE"); });
}

std::uint32_t& I2cModel::word(stm32g4::Register<stm32g4::I2cMap> where) {
    return space_.word(registers_, where);
}

bool I2cModel::is_interrupting() {
    const std::uint32_t flags = word("ISR");
    const std::uint32_t enabled = word("CR1");
    const auto raised = [&](F enable, std::uint32_t mask) {
        return enable.of(enabled) != 0 && (flags & mask) != 0;
    };
    return raised("CR1.TXIE", F("ISR.TXIS").mask()) || raised("CR1.RXIE", F("ISR.RXNE").mask()) ||
           raised("CR1.NACKIE", F("ISR.NACKF").mask()) || raised("CR1.STOPIE", F("ISR.STOPF").mask()) ||
           raised("CR1.TCIE", F("ISR.TC").mask()) ||
           raised("CR1.ERRIE", F("ISR.BERR").mask() | F("ISR.ARLO").mask() | F("ISR.OVR").mask());
}

bool I2cModel::step() {
    if (is_stretched || F("CR1.PE").of(word("CR1")) == 0) return false;
    switch (phase_) {
        case Phase::idle:
        case Phase::holding:
            return false;
        case Phase::starting:
            start();
            return true;
        case Phase::loading:
            load();
            return phase_ != Phase::loading || !is("ISR.TXIS");
        case Phase::shifting:
            shift();
            return true;
        case Phase::receiving:
            if (is("ISR.RXNE")) return false;  // the clock is stretched until RXDR is read
            receive();
            return true;
    }
    return false;
}

void I2cModel::start() {
    const std::uint32_t control = word("CR2");
    const bool is_read = F("CR2.RD_WRN").of(control) != 0;
    address_ = static_cast<std::uint8_t>(F("CR2.SADD").of(control) >> 1U);
    word("CR2") &= ~F("CR2.START").mask();
    log(fmt::format("{}{:02X}{}", is("ISR.BUSY") ? "R" : "S", address_, is_read ? "r" : "w"));
    raise("ISR.BUSY");
    moved_ = 0;
    if (std::exchange(reports_false_bus_error, false)) raise("ISR.BERR");
    if (std::exchange(loses_arbitration, false)) {
        lower("ISR.BUSY");
        raise("ISR.ARLO");
        phase_ = Phase::idle;
    } else if (!targets_.contains(address_)) {
        refuse();
    } else if (bytes() == 0) {
        end_of_bytes();
    } else {
        phase_ = is_read ? Phase::receiving : Phase::loading;
    }
}

/// A byte goes from TXDR to the wire at once; then the next one is requested.
void I2cModel::load() {
    if (is("ISR.TXE")) {
        raise("ISR.TXIS");
        return;
    }
    shifted_ = static_cast<std::uint8_t>(word("TXDR"));
    raise("ISR.TXE");
    if (moved_ + 1 < bytes()) raise("ISR.TXIS");
    phase_ = Phase::shifting;
}

void I2cModel::shift() {
    log(fmt::format("{:02X}", shifted_));
    if (refuses_byte == moved_) {
        refuse();
        return;
    }
    ++moved_;
    phase_ = Phase::loading;
    if (moved_ == bytes()) end_of_bytes();
}

void I2cModel::receive() {
    const auto& answer = targets_[address_];
    const std::uint8_t byte = moved_ < answer.size() ? answer[moved_] : std::uint8_t{0xFF};
    log(fmt::format("({:02X})", byte));
    word("RXDR") = byte;
    raise("ISR.RXNE");
    ++moved_;
    if (moved_ == bytes()) end_of_bytes();
}

/// The hardware sends the STOP by itself, for any value of AUTOEND; TXDR keeps its content.
void I2cModel::refuse() {
    log("n");
    lower("ISR.TXIS");
    raise("ISR.NACKF");
    stop();
}

void I2cModel::end_of_bytes() {
    if (F("CR2.AUTOEND").of(word("CR2")) != 0) {
        stop();
    } else {
        raise("ISR.TC");
        phase_ = Phase::holding;
    }
}

void I2cModel::stop() {
    log("P");
    raise("ISR.STOPF");
    lower("ISR.BUSY");
    phase_ = Phase::idle;
}

}  // namespace octoskin::test
