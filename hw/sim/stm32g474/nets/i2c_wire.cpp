#include "hw/sim/stm32g474/nets/i2c_wire.hpp"

#include <algorithm>
#include <bit>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kIndexBytes = 2;
constexpr std::uint32_t kByteBits = 8;

std::uint8_t with_bit_flipped(std::uint8_t byte, std::size_t byte_number, const I2cFault* flip) {
    if (flip == nullptr || flip->position / kByteBits != byte_number) return byte;
    return static_cast<std::uint8_t>(byte ^ (0x80U >> (flip->position % kByteBits)));
}

}  // namespace

void I2cWire::inject(const I2cFault& fault) {
    faults_.push_back(fault);
    if (!is_in_transfer_) note_stuck_sda();
}

const I2cFault* I2cWire::fault(I2cFaultKind kind) const {
    for (const I2cFault& candidate : faults_) {
        const bool is_due =
            transfer_count_ >= candidate.first && transfer_count_ - candidate.first < candidate.count;
        const bool is_addressed = !candidate.address || address_ == *candidate.address;
        if (candidate.kind == kind && is_due && is_addressed) return &candidate;
    }
    return nullptr;
}

void I2cWire::note_stuck_sda() {
    for (const I2cFault& candidate : faults_) {
        if (candidate.kind == I2cFaultKind::sda_stuck_low && candidate.first == transfer_count_) {
            stuck_clocks_ = candidate.position;
            ++fault_hits_;
        }
    }
}

void I2cWire::begin_transfer(std::uint8_t address) {
    is_in_transfer_ = true;
    address_ = address;
    written_ = read_ = 0;
}

void I2cWire::end_transfer() {
    if (!is_in_transfer_) return;
    is_in_transfer_ = false;
    byte_being_read_.reset();
    ++transfer_count_;
    note_stuck_sda();
}

I2cWire::Answer I2cWire::start(std::uint8_t address, bool is_read, SimTime time) {
    if (!is_in_transfer_) begin_transfer(address);
    if (!first_address_) first_address_ = time;
    byte_being_read_.reset();
    if (fault(I2cFaultKind::stretch) != nullptr) {
        is_stretched_ = true;
        ++fault_hits_;
        return Answer::stretched;
    }
    if (fault(I2cFaultKind::lose_arbitration) != nullptr) {
        ++fault_hits_;
        end_transfer();
        return Answer::arbitration_lost;
    }
    selected_.clear();
    for (I2cTarget* target : targets_) {
        if (target->on_start(address, is_read, time)) selected_.push_back(target);
    }
    const bool is_faulty = fault(I2cFaultKind::nack_address) != nullptr ||
                           (is_read && fault(I2cFaultKind::nack_read) != nullptr);
    const bool is_refused = selected_.empty() || is_faulty;
    if (is_refused) ++refused_count_;
    if (is_faulty && !selected_.empty()) ++fault_hits_;
    return is_refused ? Answer::refused : Answer::acknowledged;
}

I2cWire::Answer I2cWire::write(std::uint8_t byte, SimTime time) {
    const std::uint32_t position = written_++;
    const I2cFault* refused = fault(I2cFaultKind::nack_byte);
    const bool is_refused = refused != nullptr && refused->position == position;
    const bool is_lost = position >= kIndexBytes && fault(I2cFaultKind::lose_write) != nullptr;
    const std::uint8_t arriving = with_bit_flipped(byte, position, fault(I2cFaultKind::flip_written_bit));
    if (is_refused || is_lost || arriving != byte) ++fault_hits_;
    if (is_refused) return Answer::refused;
    if (is_lost) return Answer::acknowledged;
    bool is_acknowledged = false;
    for (I2cTarget* target : selected_) is_acknowledged = target->on_write(arriving, time) || is_acknowledged;
    return is_acknowledged ? Answer::acknowledged : Answer::refused;
}

std::uint8_t I2cWire::read(SimTime time) {
    const std::uint32_t position = read_++;
    std::uint8_t byte = 0xFF;  // pull-ups: any device that drives a 0 wins
    for (I2cTarget* target : selected_) byte = static_cast<std::uint8_t>(byte & target->on_read(time));
    const std::uint8_t driven = byte;
    const I2cFault* ones = fault(I2cFaultKind::read_ones);
    if (ones != nullptr && position >= ones->position) byte = 0xFF;
    byte_being_read_ = byte = with_bit_flipped(byte, position, fault(I2cFaultKind::flip_bit));
    if (byte != driven) ++fault_hits_;
    return byte;
}

void I2cWire::stop(SimTime time) {
    for (I2cTarget* target : selected_) target->on_stop(time);
    selected_.clear();
    end_transfer();
    if (on_stop_) on_stop_();
}

// A target that was sending continues as soon as it gets clocks: it holds SDA at every 0 up to the next 1 or
// to the acknowledge.
void I2cWire::abandon(std::uint32_t bits_done) {
    is_stretched_ = false;
    if (byte_being_read_ && bits_done < kByteBits) {
        const auto rest = static_cast<std::uint8_t>(*byte_being_read_ << bits_done);
        const auto zeros = static_cast<std::uint32_t>(std::countl_zero(rest));
        stuck_clocks_ = std::min(zeros, kByteBits - bits_done);
    }
    const std::uint32_t stuck = stuck_clocks_;
    end_transfer();
    stuck_clocks_ = std::max(stuck_clocks_, stuck);
}

void I2cWire::drive(bool scl_low, bool sda_low, SimTime time) {
    const bool was_scl_low = is_scl_low();
    const bool was_sda_low = is_sda_low(time);
    is_scl_driven_low_ = scl_low;
    is_sda_driven_low_ = sda_low;
    if (was_scl_low && !is_scl_low()) {
        stuck_clocks_ -= std::min(stuck_clocks_, 1U);
        for (I2cTarget* target : targets_) target->on_clocks(1, time);
    }
    // STOP: SDA rises while SCL is high.
    if (!was_scl_low && !is_scl_low() && was_sda_low && !is_sda_low(time)) {
        for (I2cTarget* target : targets_) target->on_stop(time);
        selected_.clear();
    }
}

bool I2cWire::is_sda_low(SimTime time) {
    return is_sda_driven_low_ || stuck_clocks_ > 0 ||
           std::ranges::any_of(targets_, [&](I2cTarget* target) { return target->holds_sda(time); });
}

}  // namespace octoskin::sim::stm32
