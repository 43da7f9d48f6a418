// The thread's promises, against an adapter that is slow or stuck on demand. What a real one does, a virtual
// machine shows: tests/system/hil.
#include "firmware/port/linux/i2c_thread_bus.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace octoskin::linux_port {
namespace {

using i2c::TransferError;
using i2c::TransferState;

/// Answers with the bytes written, counted up; a closed gate holds it in the kernel.
class GatedAdapter final : public I2cAdapter {
  public:
    int transfer(const i2c::Transfer& transfer) override {
        std::unique_lock lock(mutex_);
        ++begun_;
        changed_.notify_all();
        changed_.wait(lock, [this] { return is_open_; });
        written_.emplace_back(transfer.write.begin(), transfer.write.end());
        std::uint8_t next = transfer.write.empty() ? 0 : transfer.write[0];
        for (std::uint8_t& byte : transfer.read) byte = ++next;
        return error_number_;
    }
    void set_open(bool is_open) {
        const std::lock_guard lock(mutex_);
        is_open_ = is_open;
        changed_.notify_all();
    }
    void answer_with(int error_number) {
        const std::lock_guard lock(mutex_);
        error_number_ = error_number;
    }
    void await_begun(int count) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this, count] { return begun_ >= count; });
    }
    std::vector<std::vector<std::uint8_t>> written() {
        const std::lock_guard lock(mutex_);
        return written_;
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_open_ = true;
    int begun_ = 0;
    int error_number_ = 0;
    std::vector<std::vector<std::uint8_t>> written_;
};

/// What the thread's clock reads.
std::atomic<std::uint32_t> thread_clock_us = 0;
NodeTime thread_now() noexcept {
    return {thread_clock_us};
}

class I2cThreadBusTest : public testing::Test {
  protected:
    I2cThreadBusTest() { thread_clock_us = 0; }
    ~I2cThreadBusTest() override {
        adapter_.set_open(true);
        bus_.reset();
        ::close(event_);
    }
    void submit(std::uint8_t first, NodeTime deadline = {1'000}) {
        write_[0] = first;
        bus_->submit({.address = 0x29, .write = write_, .read = read_}, {0}, deadline);
    }
    /// A transfer's end wakes whoever waits for the event.
    void await_end() {
        pollfd ended{.fd = event_, .events = POLLIN, .revents = 0};
        ASSERT_EQ(::poll(&ended, 1, 10'000), 1);
        eventfd_t count = 0;
        ASSERT_EQ(::eventfd_read(event_, &count), 0);
    }
    TransferState outcome() {
        await_end();
        return bus_->poll({0});
    }

    GatedAdapter adapter_;
    int event_ = ::eventfd(0, EFD_CLOEXEC);
    std::unique_ptr<I2cThreadBus> bus_ = std::make_unique<I2cThreadBus>(adapter_, event_, thread_now);
    std::array<std::uint8_t, 2> write_{0x01, 0x0F};
    std::array<std::uint8_t, 3> read_{};
};

TEST_F(I2cThreadBusTest, is_idle_before_the_first_transfer) {
    EXPECT_FALSE(bus_->is_busy());
    EXPECT_EQ(bus_->poll({0}), TransferState::idle);
    EXPECT_EQ(bus_->deadline(), std::nullopt);
    EXPECT_TRUE(bus_->recover());
}

TEST_F(I2cThreadBusTest, tells_the_end_once_and_hands_over_the_bytes) {
    submit(0x10);
    EXPECT_TRUE(bus_->is_busy());
    EXPECT_EQ(bus_->deadline(), NodeTime{1'000});
    EXPECT_EQ(outcome(), TransferState::done);
    EXPECT_EQ(read_, (std::array<std::uint8_t, 3>{0x11, 0x12, 0x13}));
    EXPECT_FALSE(bus_->is_busy());
    EXPECT_EQ(bus_->poll({0}), TransferState::idle);
}

TEST_F(I2cThreadBusTest, is_pending_while_the_kernel_has_it) {
    adapter_.set_open(false);
    submit(0x10);
    adapter_.await_begun(1);
    EXPECT_EQ(bus_->poll({999}), TransferState::pending);
    adapter_.set_open(true);
    EXPECT_EQ(outcome(), TransferState::done);
}

// The loop reads its clock, loses the processor for 5 ms, and asks only then: data that became ready
// meanwhile would seem to have been ready at the time it read.
TEST_F(I2cThreadBusTest, tells_no_end_before_its_time) {
    thread_clock_us = 505;
    submit(0x10);
    await_end();
    EXPECT_EQ(bus_->poll({500}), TransferState::pending);
    EXPECT_EQ(bus_->poll({504}), TransferState::pending);
    EXPECT_TRUE(bus_->is_busy());
    EXPECT_EQ(bus_->poll({505}), TransferState::done);
    EXPECT_EQ(read_, (std::array<std::uint8_t, 3>{0x11, 0x12, 0x13}));
}

TEST_F(I2cThreadBusTest, tells_the_end_across_the_wrap_of_the_clock) {
    thread_clock_us = 10;
    submit(0x10);
    await_end();
    EXPECT_EQ(bus_->poll({0xFFFFFFF0U}), TransferState::pending);
    EXPECT_EQ(bus_->poll({10}), TransferState::done);
}

TEST_F(I2cThreadBusTest, gives_up_at_the_deadline_and_keeps_late_bytes_away) {
    adapter_.set_open(false);
    submit(0x10);
    adapter_.await_begun(1);
    EXPECT_EQ(bus_->poll({1'000}), TransferState::failed);
    EXPECT_EQ(bus_->error(), TransferError::timeout);
    EXPECT_FALSE(bus_->is_busy());
    adapter_.set_open(true);
    await_end();
    EXPECT_EQ(bus_->poll({2'000}), TransferState::idle);
    EXPECT_EQ(read_, (std::array<std::uint8_t, 3>{}));
}

TEST_F(I2cThreadBusTest, begins_the_next_one_only_after_the_stuck_one_and_tells_them_apart) {
    adapter_.set_open(false);
    submit(0x10);
    adapter_.await_begun(1);
    ASSERT_EQ(bus_->poll({1'000}), TransferState::failed);
    submit(0x20, {5'000});
    EXPECT_EQ(bus_->poll({4'000}), TransferState::pending);
    adapter_.set_open(true);
    adapter_.await_begun(2);
    while (bus_->poll({4'000}) == TransferState::pending) await_end();
    EXPECT_EQ(read_[0], 0x21);
    EXPECT_EQ(adapter_.written(), (std::vector<std::vector<std::uint8_t>>{{0x10, 0x0F}, {0x20, 0x0F}}));
}

TEST_F(I2cThreadBusTest, never_begins_what_was_given_up_before_the_thread_was_free) {
    adapter_.set_open(false);
    submit(0x10);
    adapter_.await_begun(1);
    ASSERT_EQ(bus_->poll({1'000}), TransferState::failed);
    submit(0x20);
    ASSERT_EQ(bus_->poll({1'000}), TransferState::failed);
    submit(0x30);
    adapter_.set_open(true);
    while (bus_->poll({0}) == TransferState::pending) await_end();
    EXPECT_EQ(read_[0], 0x31);
    EXPECT_EQ(adapter_.written(), (std::vector<std::vector<std::uint8_t>>{{0x10, 0x0F}, {0x30, 0x0F}}));
}

TEST_F(I2cThreadBusTest, drops_the_transfer_when_recovered_and_says_that_the_kernel_is_stuck) {
    adapter_.set_open(false);
    submit(0x10);
    adapter_.await_begun(1);
    EXPECT_FALSE(bus_->recover());
    EXPECT_EQ(bus_->poll({0}), TransferState::idle);
    adapter_.set_open(true);
    await_end();
    EXPECT_TRUE(bus_->recover());
}

TEST_F(I2cThreadBusTest, asks_once_for_all_sensors_in_reset_after_a_held_bus) {
    adapter_.answer_with(EBUSY);
    submit(0x10);
    EXPECT_EQ(outcome(), TransferState::failed);
    EXPECT_EQ(bus_->error(), TransferError::bus_stuck);
    EXPECT_FALSE(bus_->recover());
    EXPECT_TRUE(bus_->recover());
}

TEST_F(I2cThreadBusTest, tells_the_kernels_errors_as_the_drivers) {
    const std::vector<std::pair<int, TransferError>> cases{
        {ENXIO, TransferError::nack_address},      {EREMOTEIO, TransferError::nack_address},
        {EIO, TransferError::nack_data},           {ETIMEDOUT, TransferError::timeout},
        {EAGAIN, TransferError::arbitration_lost}, {EBUSY, TransferError::bus_stuck},
        {ENODEV, TransferError::bus_stuck},        {EOPNOTSUPP, TransferError::bus_stuck}};
    for (const auto& [error_number, error] : cases) {
        adapter_.answer_with(error_number);
        submit(0x10);
        EXPECT_EQ(outcome(), TransferState::failed);
        EXPECT_EQ(bus_->error(), error) << error_number;
    }
}

TEST_F(I2cThreadBusTest, says_in_time_that_a_transfer_does_not_come_back_at_the_end) {
    adapter_.set_open(false);
    submit(0x10);
    adapter_.await_begun(1);
    EXPECT_FALSE(bus_->end(Microseconds{1'000}));
    adapter_.set_open(true);
    EXPECT_TRUE(bus_->end(Microseconds{10'000'000}));
}

TEST_F(I2cThreadBusTest, ends_at_once_where_nothing_is_in_the_kernel) {
    EXPECT_TRUE(bus_->end(Microseconds{0}));
}

TEST_F(I2cThreadBusTest, ends_with_a_transfer_in_flight) {
    adapter_.set_open(false);
    submit(0x10);
    adapter_.await_begun(1);
    adapter_.set_open(true);
    bus_.reset();
    EXPECT_EQ(adapter_.written().size(), 1U);
}

}  // namespace
}  // namespace octoskin::linux_port
