// An I2C bus whose transfers block in the kernel: one thread carries them out, so that the node never waits.
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

/// A transfer that is given up at its deadline may still be in the kernel. Its thread is not free before it
/// comes back, and transfers keep their order: the next one waits for it, until its own deadline. What the
/// kernel reads late goes nowhere, since the thread has buffers of its own.
class I2cThreadBus final : public i2c::Bus {
  public:
    using Clock = NodeTime (*)() noexcept;

    /// `adapter` must outlive the bus; `event` is an eventfd(2) that counts ended transfers up; `clock` is
    /// what the times given to `poll` are read from, asked by the thread.
    I2cThreadBus(I2cAdapter& adapter, int event, Clock clock);
    /// Waits for a transfer that is in the kernel, however long: see `end`.
    ~I2cThreadBus();
    /// No further transfer begins. False if one is in the kernel that does not come back within `patience`:
    /// the process can then only leave without the destructor.
    [[nodiscard]] bool end(Microseconds patience);

    [[nodiscard]] bool is_busy() const override { return in_flight_.has_value(); }
    /// At most 256 bytes each way.
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override;
    /// A transfer that ended after `now` was read is pending: its answer may be of something that happened
    /// after `now`, by as long as Linux kept the node's loop off the processor. The event is counted up then,
    /// too.
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override;
    [[nodiscard]] i2c::TransferError error() const override { return error_; }
    /// The kernel's driver gives the clocks, with each transfer that needs them, and tells no levels. So:
    /// false while a transfer is stuck in the kernel, and once after one that found the bus held, so that the
    /// node takes all sensors off the bus before it goes on.
    bool recover() override;

    /// Of the transfer in flight.
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
    std::uint64_t number_ = 0;  ///< of the newest transfer
    i2c::TransferError error_ = i2c::TransferError::timeout;
    bool was_held_ = false;
    // --- shared
    std::mutex mutex_;
    std::condition_variable is_ordered_;
    std::condition_variable has_left_kernel_;
    std::optional<Order> order_;  ///< not yet begun
    bool is_in_kernel_ = false;
    bool is_ending_ = false;
    Outcome outcome_;
    std::thread thread_;
};

}  // namespace octoskin::linux_port
