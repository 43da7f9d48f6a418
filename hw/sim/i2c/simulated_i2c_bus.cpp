#include "hw/sim/i2c/simulated_i2c_bus.hpp"

#include <algorithm>
#include <cassert>

namespace octoskin::sim {
namespace {

constexpr std::uint32_t kFreeingClocks =
    9;  // a byte and its acknowledge: by then every part has released SDA

std::uint8_t with_bit_flipped(std::uint8_t byte, std::size_t byte_number, const I2cFault* flip) {
    if (flip == nullptr || flip->position / 8 != byte_number) return byte;
    return static_cast<std::uint8_t>(byte ^ (0x80U >> (flip->position % 8)));
}

}  // namespace

// Simulates the whole transfer at once, every byte at its own time: nothing else reaches these devices before
// it ends, and its end time must be known.
void SimulatedI2cBus::submit(const i2c::Transfer& transfer, NodeTime, NodeTime deadline) {
    assert(!is_busy());
    transfer_ = transfer;
    started_ = present_.time;
    deadline_ = deadline;
    bits_ = 0;
    answer_.assign(transfer.read.size(), 0xFF);
    is_stretched_ = fault(I2cFaultKind::stretch) != nullptr;
    note_stuck_sda();
    failure_ = is_stretched_ ? i2c::TransferError::timeout : run();
}

std::optional<SimTime> SimulatedI2cBus::transfer_end() const {
    if (!transfer_ || is_stretched_) return std::nullopt;
    return after_bits(bits_);
}

i2c::TransferState SimulatedI2cBus::poll(NodeTime now) {
    if (!transfer_) return i2c::TransferState::idle;
    const auto end = transfer_end();
    if (end && present_.time >= *end) {
        if (!failure_) std::ranges::copy(answer_, transfer_->read.begin());
        end_transfer(*end);
    } else if (is_reached(deadline_, now)) {
        failure_ = i2c::TransferError::timeout;
        end_transfer(present_.time);
    } else {
        return i2c::TransferState::pending;
    }
    if (!failure_) return i2c::TransferState::done;
    error_ = *failure_;
    return i2c::TransferState::failed;
}

bool SimulatedI2cBus::recover() {
    if (transfer_) end_transfer(present_.time);
    if (is_sda_low(present_.time)) give_clocks(present_.time);
    return !is_sda_low(present_.time);
}

void SimulatedI2cBus::abandon() {
    if (!transfer_) return;
    const auto end = transfer_end();
    const bool is_mid_byte = end && present_.time < *end && !transfer_->read.empty();
    end_transfer(present_.time);
    if (is_mid_byte) stuck_clocks_ = kFreeingClocks;
}

void SimulatedI2cBus::end_transfer(SimTime ended) {
    busy_time_ += Microseconds{ended.us - started_.us};
    bit_count_ += bits_;
    ++transfer_count_;
    transfer_.reset();
}

const I2cFault* SimulatedI2cBus::fault(I2cFaultKind kind) const {
    for (const I2cFault& candidate : faults_) {
        const bool is_due =
            transfer_count_ >= candidate.first && transfer_count_ - candidate.first < candidate.count;
        const bool is_addressed = !candidate.address || transfer_->address == *candidate.address;
        if (candidate.kind == kind && is_due && is_addressed) return &candidate;
    }
    return nullptr;
}

SimTime SimulatedI2cBus::after_bits(std::uint64_t bits) const {
    return {started_.us + static_cast<std::int64_t>((bits * 1'000'000 + hz_ - 1) / hz_)};
}

SimulatedI2cBus::Failure SimulatedI2cBus::run() {
    if (const Failure failure = free_sda()) return failure;
    if (fault(I2cFaultKind::lose_arbitration) != nullptr) {
        bits_ += 10;
        return i2c::TransferError::arbitration_lost;
    }
    Failure failure;
    if (!transfer_->write.empty() || transfer_->read.empty()) failure = run_write();
    if (!failure && !transfer_->read.empty()) failure = run_read();
    ++bits_;
    stop();
    return failure;
}

SimulatedI2cBus::Failure SimulatedI2cBus::free_sda() {
    if (!is_sda_low(started_)) return std::nullopt;
    bits_ += kFreeingClocks + 1;
    give_clocks(after_bits(bits_));
    if (is_sda_low(after_bits(bits_))) return i2c::TransferError::bus_stuck;
    return std::nullopt;
}

SimulatedI2cBus::Failure SimulatedI2cBus::run_write() {
    if (!start(false) || fault(I2cFaultKind::nack_address) != nullptr) {
        return i2c::TransferError::nack_address;
    }
    const I2cFault* refused = fault(I2cFaultKind::nack_byte);
    for (std::size_t i = 0; i < transfer_->write.size(); ++i) {
        bits_ += 9;
        if (refused != nullptr && refused->position == i) return i2c::TransferError::nack_data;
        if (!pass_to_targets(i, transfer_->write[i])) return i2c::TransferError::nack_data;
    }
    return std::nullopt;
}

bool SimulatedI2cBus::pass_to_targets(std::size_t position, std::uint8_t byte) {
    constexpr std::size_t kIndexBytes = 2;
    if (position >= kIndexBytes && fault(I2cFaultKind::lose_write) != nullptr) {
        note_altered_write();
        return true;
    }
    std::uint8_t arriving = with_bit_flipped(byte, position, fault(I2cFaultKind::flip_written_bit));
    const I2cFault* redirect = fault(I2cFaultKind::redirect_write);
    if (redirect != nullptr && position < kIndexBytes)
        arriving = static_cast<std::uint8_t>(redirect->position >> (position == 0 ? 8U : 0U));
    if (arriving != byte) note_altered_write();
    bool is_acknowledged = false;
    for (I2cTarget* target : selected_) {
        is_acknowledged = target->on_write(arriving, after_bits(bits_)) || is_acknowledged;
    }
    return is_acknowledged;
}

void SimulatedI2cBus::note_altered_write() {
    if (altered_writes_.empty() || altered_writes_.back() != started_) altered_writes_.push_back(started_);
}

SimulatedI2cBus::Failure SimulatedI2cBus::run_read() {
    if (!start(true) || fault(I2cFaultKind::nack_address) != nullptr ||
        fault(I2cFaultKind::nack_read) != nullptr) {
        return i2c::TransferError::nack_address;
    }
    const I2cFault* ones = fault(I2cFaultKind::read_ones);
    const I2cFault* flip = fault(I2cFaultKind::flip_bit);
    for (std::size_t i = 0; i < answer_.size(); ++i) {
        bits_ += 9;
        std::uint8_t byte = 0xFF;  // pull-ups: any device that drives a 0 wins
        for (I2cTarget* target : selected_) {
            byte = static_cast<std::uint8_t>(byte & target->on_read(after_bits(bits_)));
        }
        if (ones != nullptr && i >= ones->position) byte = 0xFF;
        answer_[i] = with_bit_flipped(byte, i, flip);
    }
    return std::nullopt;
}

// START, address, acknowledge. Every device receives it; a missing acknowledge by a fault is on the line, the
// device did acknowledge.
bool SimulatedI2cBus::start(bool is_read) {
    bits_ += 10;
    selected_.clear();
    for (I2cTarget* target : targets_) {
        if (target->on_start(transfer_->address, is_read, after_bits(bits_))) selected_.push_back(target);
    }
    return !selected_.empty();
}

void SimulatedI2cBus::stop() {
    for (I2cTarget* target : selected_) target->on_stop(after_bits(bits_));
    selected_.clear();
}

void SimulatedI2cBus::note_stuck_sda() {
    for (const I2cFault& candidate : faults_) {
        if (candidate.kind == I2cFaultKind::sda_stuck_low && candidate.first == transfer_count_) {
            stuck_clocks_ = candidate.position;
        }
    }
}

void SimulatedI2cBus::give_clocks(SimTime time) {
    stuck_clocks_ -= std::min(stuck_clocks_, kFreeingClocks);
    for (I2cTarget* target : targets_) target->on_clocks(kFreeingClocks, time);
}

bool SimulatedI2cBus::is_sda_low(SimTime time) {
    return stuck_clocks_ > 0 ||
           std::ranges::any_of(targets_, [&](I2cTarget* target) { return target->holds_sda(time); });
}

}  // namespace octoskin::sim
