// An I2C bus on simulated time: transfers last as long as their bits, several devices may answer at once
// (wired AND), and faults are data.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "hw/sim/clock.hpp"
#include "hw/sim/i2c/i2c_target.hpp"

namespace octoskin::sim {

enum class I2cFaultKind : std::uint8_t {
    nack_address,      ///< no device acknowledges
    nack_byte,         ///< the written byte number `position` is refused (0 and 1 are the index)
    nack_read,         ///< the repeated START's address is not acknowledged
    flip_bit,          ///< bit `position` of the bytes read is inverted (0: most significant of the first)
    flip_written_bit,  ///< bit `position` of the bytes written arrives inverted (0: as above, of the index)
    lose_write,        ///< all is acknowledged, and no data byte arrives
    read_ones,         ///< every byte read, from number `position` on, is 0xFF: the device released SDA
    lose_arbitration,  ///< another controller drives SDA
    stretch,           ///< the clock is held low for ever: only the deadline ends it
    sda_stuck_low,     ///< SDA stays low from before the START on, until `position` clocks have been given
    redirect_write,    ///< the index arrives as `position`, several of its bits altered, for any sent index
};

/// A fault of the transfers number `first` to `first + count - 1` (counted from 0 on this bus). With an
/// address, only those of them that go to it. `sda_stuck_low` begins at `first` and ends by its clocks.
struct I2cFault {
    I2cFaultKind kind = I2cFaultKind::nack_address;
    std::uint64_t first = 0;
    std::uint64_t count = 1;
    std::uint32_t position = 0;
    std::optional<i2c::Address> address{};
};

class SimulatedI2cBus final : public i2c::Bus {
  public:
    /// `present` must outlive the bus. `hz`: 100,000 to 1,000,000.
    SimulatedI2cBus(const Present& present, std::uint32_t hz) : present_(present), hz_(hz) {}

    /// The target must outlive the bus.
    void attach(I2cTarget& target) { targets_.push_back(&target); }
    void inject(const I2cFault& fault) { faults_.push_back(fault); }

    [[nodiscard]] bool is_busy() const override { return transfer_.has_value(); }
    /// If SDA is low, up to 9 clocks and a STOP come first.
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override;
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override;
    [[nodiscard]] i2c::TransferError error() const override { return error_; }
    /// Drops the running transfer.
    bool recover() override;

    /// The controller was reset: the transfer is lost, and a target that was sending stays in the middle of
    /// its byte and holds SDA.
    void abandon();

    /// Whether a fault still holds a line.
    [[nodiscard]] bool is_held() const noexcept { return stuck_clocks_ > 0; }
    /// Start times of the transfers in which a fault altered or suppressed bytes to a target.
    [[nodiscard]] const std::vector<SimTime>& altered_writes() const noexcept { return altered_writes_; }
    /// End of the running transfer; empty if there is none, or if it never ends by itself.
    [[nodiscard]] std::optional<SimTime> transfer_end() const;
    [[nodiscard]] std::uint64_t transfer_count() const noexcept { return transfer_count_; }
    /// Clock periods since the start, START and STOP counted as one each.
    [[nodiscard]] std::uint64_t bit_count() const noexcept { return bit_count_; }
    /// Time the bus has been busy since the start.
    [[nodiscard]] Microseconds busy_time() const noexcept { return busy_time_; }

  private:
    using Failure = std::optional<i2c::TransferError>;

    [[nodiscard]] const I2cFault* fault(I2cFaultKind kind) const;
    [[nodiscard]] SimTime after_bits(std::uint64_t bits) const;
    [[nodiscard]] Failure run();
    [[nodiscard]] Failure free_sda();
    [[nodiscard]] Failure run_write();
    [[nodiscard]] Failure run_read();
    [[nodiscard]] bool pass_to_targets(std::size_t position, std::uint8_t byte);
    [[nodiscard]] bool start(bool is_read);
    void stop();
    void note_altered_write();
    void note_stuck_sda();
    void give_clocks(SimTime time);
    [[nodiscard]] bool is_sda_low(SimTime time);
    void end_transfer(SimTime ended);

    const Present& present_;
    std::uint32_t hz_;
    std::vector<I2cTarget*> targets_;
    std::vector<I2cTarget*> selected_;
    std::vector<I2cFault> faults_;

    std::optional<i2c::Transfer> transfer_;
    SimTime started_{};
    NodeTime deadline_{};
    std::uint64_t bits_ = 0;  ///< of the running transfer
    std::vector<std::uint8_t> answer_;
    Failure failure_;
    bool is_stretched_ = false;

    std::uint64_t transfer_count_ = 0;
    std::uint64_t bit_count_ = 0;
    Microseconds busy_time_{0};
    std::vector<SimTime> altered_writes_;
    std::uint32_t stuck_clocks_ = 0;  ///< still needed before SDA is released
    i2c::TransferError error_ = i2c::TransferError::timeout;
};

}  // namespace octoskin::sim
