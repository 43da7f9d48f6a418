// An I2C bus whose transfers block in the kernel. One thread carries them out, so that the node never waits.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>

#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "firmware/port/linux/i2c_adapter.hpp"

namespace octoskin::linux_port {

/// A transfer that was given up at its deadline may still be in the kernel. Transfers keep their order: the
/// next one waits for the thread, until its own deadline. The thread has its own buffers, so data read late
/// is discarded.
class I2cThreadBus final : public i2c::Bus {
  public:
    using Clock = NodeTime (*)() noexcept;

    /// `adapter` must outlive the bus. `event` is an eventfd(2), incremented at each end of a transfer.
    /// `clock` is the clock of the times passed to `poll`; the thread reads it.
    I2cThreadBus(I2cAdapter& adapter, int event, Clock clock);
    /// Waits for a transfer in the kernel, without a limit: call `end` first.
    ~I2cThreadBus();
    /// Starts no further transfer. False if a transfer in the kernel does not return within `patience`. Then
    /// the process must exit without calling the destructor.
    [[nodiscard]] bool end(Microseconds patience);

    [[nodiscard]] bool is_busy() const override { return in_flight_.has_value(); }
    /// At most 256 bytes in each direction.
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override;
    /// A transfer that ended after `now` was read is still pending: its answer may describe an event later
    /// than `now`, if Linux delayed the node's loop. The event is incremented in that case, too.
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override;
    [[nodiscard]] i2c::TransferError error() const override { return error_; }
    /// The kernel's driver sends the freeing clocks itself, with each transfer that needs them, and does not
    /// show the line levels. So the result is false while a transfer is stuck in the kernel, and once after a
    /// transfer that found the bus held. The node then takes all sensors off the bus before it continues.
    bool recover() override;

    /// Deadline of the transfer in flight.
    [[nodiscard]] std::optional<NodeTime> deadline() const noexcept;

  private:
    static constexpr std::size_t kBytesMax = 256;
    using Bytes = std::array<std::uint8_t, kBytesMax>;
    struct InFlight {
        std::span<std::uint8_t> read;
        NodeTime deadline;
    };
    struct Order {
        std::uint64_t number = 0;
        i2c::Address address = 0;
        std::size_t write_size = 0;
        std::size_t read_size = 0;
        Bytes write{};
    };
    struct Outcome {
        std::uint64_t number = 0;
        int error_number = 0;
        NodeTime ended{};
        Bytes read{};
    };

    void work();
    void give_up();

    I2cAdapter& adapter_;
    int event_;
    Clock clock_;
    // --- the node's side
    std::optional<InFlight> in_flight_;
    std::uint64_t number_ = 0;  ///< number of the newest transfer
    i2c::TransferError error_ = i2c::TransferError::timeout;
    bool was_held_ = false;
    // --- shared
    std::mutex mutex_;
    std::condition_variable is_ordered_;
    std::condition_variable has_left_kernel_;
    std::optional<Order> order_;  ///< not yet started
    bool is_in_kernel_ = false;
    bool is_ending_ = false;
    Outcome outcome_;
    std::thread thread_;
};

}  // namespace octoskin::linux_port
