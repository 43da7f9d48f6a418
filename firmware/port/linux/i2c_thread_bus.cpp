#include "firmware/port/linux/i2c_thread_bus.hpp"

#include <sys/eventfd.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace octoskin::linux_port {

I2cThreadBus::I2cThreadBus(I2cAdapter& adapter, int event, Clock clock)
    : adapter_(adapter), event_(event), clock_(clock) {
    thread_ = std::thread([this] { work(); });
}

I2cThreadBus::~I2cThreadBus() {
    (void)end(Microseconds{0});
    thread_.join();
}

bool I2cThreadBus::end(Microseconds patience) {
    std::unique_lock lock(mutex_);
    is_ending_ = true;
    is_ordered_.notify_one();
    return has_left_kernel_.wait_for(lock, patience, [this] { return !is_in_kernel_; });
}

void I2cThreadBus::submit(const i2c::Transfer& transfer, NodeTime, NodeTime deadline) {
    assert(!is_busy());
    assert(transfer.write.size() <= kBytesMax && transfer.read.size() <= kBytesMax);
    in_flight_ = {.read = transfer.read, .deadline = deadline};
    Order order{.number = ++number_,
                .address = transfer.address,
                .write_size = transfer.write.size(),
                .read_size = transfer.read.size()};
    std::copy(transfer.write.begin(), transfer.write.end(), order.write.begin());
    {
        const std::lock_guard lock(mutex_);
        order_ = order;
    }
    is_ordered_.notify_one();
}

i2c::TransferState I2cThreadBus::poll(NodeTime now) {
    if (!in_flight_) return i2c::TransferState::idle;
    std::unique_lock lock(mutex_);
    if (outcome_.number == number_ && is_reached(outcome_.ended, now)) {
        const std::span<std::uint8_t> read = std::exchange(in_flight_, std::nullopt)->read;
        if (outcome_.error_number == 0) {
            std::copy_n(outcome_.read.begin(), read.size(), read.begin());
            return i2c::TransferState::done;
        }
        error_ = transfer_error(outcome_.error_number);
        was_held_ = error_ == i2c::TransferError::bus_stuck;
        return i2c::TransferState::failed;
    }
    if (!is_reached(in_flight_->deadline, now)) return i2c::TransferState::pending;
    lock.unlock();
    give_up();
    error_ = i2c::TransferError::timeout;
    return i2c::TransferState::failed;
}

bool I2cThreadBus::recover() {
    give_up();
    const bool was_held = std::exchange(was_held_, false);
    const std::lock_guard lock(mutex_);
    return !is_in_kernel_ && !was_held;
}

std::optional<NodeTime> I2cThreadBus::deadline() const noexcept {
    return in_flight_ ? std::optional(in_flight_->deadline) : std::nullopt;
}

void I2cThreadBus::give_up() {
    in_flight_.reset();
    const std::lock_guard lock(mutex_);
    order_.reset();
}

void I2cThreadBus::work() {
    std::unique_lock lock(mutex_);
    while (true) {
        is_ordered_.wait(lock, [this] { return is_ending_ || order_.has_value(); });
        if (is_ending_) return;
        const Order order = *std::exchange(order_, std::nullopt);
        is_in_kernel_ = true;
        lock.unlock();
        Outcome outcome{.number = order.number};
        outcome.error_number = adapter_.transfer({.address = order.address,
                                                  .write = std::span(order.write).first(order.write_size),
                                                  .read = std::span(outcome.read).first(order.read_size)});
        outcome.ended = clock_();
        lock.lock();
        is_in_kernel_ = false;
        outcome_ = outcome;
        has_left_kernel_.notify_one();
        (void)::eventfd_write(event_, 1);
    }
}

}  // namespace octoskin::linux_port
