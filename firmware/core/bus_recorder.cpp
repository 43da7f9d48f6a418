#include "firmware/core/bus_recorder.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace octoskin::node {

namespace {

// The longest time for which a loop may leave an ended transfer unattended.
constexpr Microseconds kOverdue{100'000};

wire::TransferOutcome outcome_of(i2c::TransferError error) noexcept {
    switch (error) {
        case i2c::TransferError::nack_address:
            return wire::TransferOutcome::nack_address;
        case i2c::TransferError::nack_data:
            return wire::TransferOutcome::nack_data;
        case i2c::TransferError::timeout:
            return wire::TransferOutcome::timeout;
        case i2c::TransferError::arbitration_lost:
            return wire::TransferOutcome::arbitration_lost;
        case i2c::TransferError::bus_stuck:
            return wire::TransferOutcome::bus_stuck;
    }
    return wire::TransferOutcome::timeout;
}

}  // namespace

void BusRecorder::submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) {
    in_flight_ = {.transfer = transfer, .start = now, .deadline = deadline};
    bus_.submit(transfer, now, deadline);
}

i2c::TransferState BusRecorder::poll(NodeTime now) {
    const i2c::TransferState state = bus_.poll(now);
    if (!in_flight_ || state == i2c::TransferState::pending) return state;
    const InFlight ended = *std::exchange(in_flight_, std::nullopt);
    if (state == i2c::TransferState::done) record(ended, wire::TransferOutcome::done);
    if (state == i2c::TransferState::failed) record(ended, outcome_of(bus_.error()));
    return state;
}

bool BusRecorder::recover() {
    const bool is_free = bus_.recover();
    if (!in_flight_ || bus_.is_busy()) return is_free;
    record(*in_flight_, wire::TransferOutcome::timeout);
    in_flight_.reset();
    return is_free;
}

bool BusRecorder::is_overdue(NodeTime now) const noexcept {
    return in_flight_ && is_reached(in_flight_->deadline + kOverdue, now);
}

void BusRecorder::freeze(NodeTime now) noexcept {
    is_frozen_ = true;
    const std::size_t length = wire::kDumpHeaderBytes - sizeof(std::uint16_t) + used_;
    header_ = wire::encode(wire::DumpHeader{.length = static_cast<std::uint16_t>(length), .frozen = now});
}

std::uint8_t BusRecorder::dump_byte(std::size_t at_byte) const noexcept {
    assert(is_frozen_ && at_byte < dump_size());
    return at_byte < header_.size() ? header_[at_byte] : at(at_byte - header_.size());
}

void BusRecorder::record(const InFlight& ended, wire::TransferOutcome outcome) noexcept {
    if (is_frozen_) return;
    const auto& [transfer, start, deadline] = ended;
    const wire::TransferHeader header{.start = start,
                                      .address = transfer.address,
                                      .outcome = outcome,
                                      .written = static_cast<std::uint8_t>(transfer.write.size()),
                                      .read_asked = static_cast<std::uint8_t>(transfer.read.size())};
    make_room(wire::kTransferHeaderBytes + header.bytes_following());
    append(wire::encode(header));
    append(transfer.write);
    if (outcome == wire::TransferOutcome::done) append(transfer.read);
    ++transfers_;
}

void BusRecorder::make_room(std::size_t bytes) noexcept {
    // Two spans of at most 255 bytes and a header: any transfer fits once the others are gone.
    static_assert(kRecordedBytesMax >= wire::kTransferHeaderBytes + std::size_t{2} * 255);
    while (transfers_ == kRecordedTransfersMax || used_ + bytes > ring_.size()) drop_oldest();
}

void BusRecorder::drop_oldest() noexcept {
    assert(transfers_ > 0);
    wire::TransferHeader oldest;
    oldest.outcome = static_cast<wire::TransferOutcome>(at(5));
    oldest.written = at(6);
    oldest.read_asked = at(7);
    const std::size_t bytes = wire::kTransferHeaderBytes + oldest.bytes_following();
    first_ = (first_ + bytes) % ring_.size();
    used_ -= bytes;
    --transfers_;
}

void BusRecorder::append(std::span<const std::uint8_t> bytes) noexcept {
    for (const std::uint8_t byte : bytes) {
        ring_[(first_ + used_) % ring_.size()] = byte;
        ++used_;
    }
}

std::uint8_t BusRecorder::at(std::size_t offset) const noexcept {
    return ring_[(first_ + offset) % ring_.size()];
}

}  // namespace octoskin::node
