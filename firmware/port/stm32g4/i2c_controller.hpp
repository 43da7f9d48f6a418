// One I2C bus of the chip. Each byte is moved by an interrupt; the core sleeps in between. RM0440, "I2C".
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "firmware/port/stm32g4/i2c_wiring.hpp"
#include "firmware/port/stm32g4/microsecond_timer.hpp"

namespace octoskin::stm32g4 {

/// Largest number of bytes that one transfer writes or reads: the byte counter has 8 bits.
inline constexpr std::size_t kI2cBytesMax = 255;

class I2cController final : public i2c::Bus {
  public:
    constexpr I2cController(const I2cWiring& wiring, const MicrosecondTimer& timer)
        : wiring_(wiring), timer_(timer) {}

    /// Enables the controller. `timing`: value of TIMINGR.
    void start(std::uint32_t timing);

    [[nodiscard]] bool is_busy() const override { return phase_ != Phase::idle; }
    /// A busy bus is freed first, which takes up to 150 us. Writes and reads of up to `kI2cBytesMax` bytes.
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override;
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override;
    [[nodiscard]] i2c::TransferError error() const override { return error_; }
    bool recover() override;

    /// Whether a transfer ended and `poll` has not returned its end yet.
    [[nodiscard]] bool has_ended() const { return phase_ == Phase::done || phase_ == Phase::failed; }
    /// Deadline of the transfer in flight.
    [[nodiscard]] std::optional<NodeTime> deadline() const;

    /// Call from the handlers of both interrupts of the controller.
    void on_interrupt();

  private:
    enum class Phase : std::uint8_t { idle, writing, reading, done, failed };

    [[nodiscard]] bool is_in_flight() const { return phase_ == Phase::writing || phase_ == Phase::reading; }
    [[nodiscard]] bool is_line_free() const;
    void begin_write();
    void begin_read();
    void feed();
    void take();
    void note_nack(std::uint32_t isr);
    void end();
    void fail(i2c::TransferError error);
    void enable() const;
    void disable() const;
    [[nodiscard]] bool free_lines() const;

    const I2cWiring& wiring_;
    const MicrosecondTimer& timer_;

    /// During a transfer, this and all members below belong to the interrupt, else to the main loop.
    std::atomic<Phase> phase_ = Phase::idle;
    i2c::Transfer transfer_;
    NodeTime deadline_;
    std::size_t written_ = 0;  ///< bytes given to the controller
    std::size_t received_ = 0;
    std::optional<i2c::TransferError> refusal_;
    i2c::TransferError error_ = i2c::TransferError::timeout;
};

}  // namespace octoskin::stm32g4
