// Interface between a device driver and an I2C bus. A bus has one transfer in flight and no call waits.
// Implemented by the ports (interrupts on the STM32, a thread per bus on Linux) and by the simulated bus.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"

namespace octoskin::i2c {

/// 7-bit address, never the shifted 8-bit form.
using Address = std::uint8_t;

/// Writes `write`. If `read` is not empty, a repeated start and the read follow. Both buffers must outlive
/// the transfer.
struct Transfer {
    Address address = 0;
    std::span<const std::uint8_t> write;
    std::span<std::uint8_t> read;
};

enum class TransferError : std::uint8_t {
    nack_address,      ///< no device acknowledges the address
    nack_data,         ///< the device refused a byte of the index or data
    timeout,           ///< not done at the deadline (clock stretched, interrupt lost); the bus was reset
    arbitration_lost,  ///< SDA read back low where it was driven high
    bus_stuck,         ///< SDA or SCL was low before the start and stayed low after 9 clocks
};

enum class TransferState : std::uint8_t { idle, pending, done, failed };

class Bus {
  public:
    Bus() = default;
    Bus(const Bus&) = delete;
    Bus& operator=(const Bus&) = delete;

    /// True from `submit` until `poll` has returned the end of the transfer.
    [[nodiscard]] virtual bool is_busy() const = 0;

    /// Starts a transfer and returns at once. Precondition: not busy. At `deadline` the transfer is given up
    /// with the error `timeout`.
    virtual void submit(const Transfer& transfer, NodeTime now, NodeTime deadline) = 0;

    /// State of the transfer in flight at `now`. `done` and `failed` are returned once and leave the bus
    /// idle. After `failed`, `error()` gives the reason. `idle` if nothing was submitted.
    [[nodiscard]] virtual TransferState poll(NodeTime now) = 0;
    [[nodiscard]] virtual TransferError error() const = 0;

    /// Frees a bus that a device holds: up to 9 clocks and a STOP, then a reset of the controller. A transfer
    /// in flight is dropped; the next `poll` of its owner returns `idle`. Takes at most 1 ms. Returns whether
    /// both lines read high afterwards.
    virtual bool recover() = 0;

  protected:
    // Not virtual: no object is deleted through this interface, and firmware must not link operator delete.
    ~Bus() = default;
};

}  // namespace octoskin::i2c
