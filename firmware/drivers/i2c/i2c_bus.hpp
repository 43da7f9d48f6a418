// What a driver needs of an I2C bus: one transfer in flight, never a wait. Ports implement it (interrupt or
// DMA driven on the STM32, a thread per bus on Linux), and so does the simulated bus.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"

namespace octoskin::i2c {

/// 7-bit address, never the shifted 8-bit form.
using Address = std::uint8_t;

/// `write`, then, if `read` is not empty, a repeated start and `read`. Both must outlive the transfer.
struct Transfer {
    Address address = 0;
    std::span<const std::uint8_t> write;
    std::span<std::uint8_t> read;
};

enum class TransferError : std::uint8_t {
    nack_address,      ///< nobody at that address
    nack_data,         ///< the device refused a byte of the index or data
    timeout,           ///< not done at the deadline (clock stretched, interrupt lost); the bus was reset
    arbitration_lost,  ///< SDA read back low where it was driven high
    bus_stuck,         ///< SDA or SCL held low before the start, and 9 clocks did not free it
};

enum class TransferState : std::uint8_t { idle, pending, done, failed };

class Bus {
  public:
    Bus() = default;
    Bus(const Bus&) = delete;
    Bus& operator=(const Bus&) = delete;

    /// True while a transfer is in flight (submitted, and its end not yet fetched by `poll`).
    [[nodiscard]] virtual bool is_busy() const = 0;

    /// Starts a transfer. Calling it while busy is a programmer's mistake. At `deadline` the transfer is
    /// given up with `timeout`. Returns at once.
    virtual void submit(const Transfer& transfer, NodeTime now, NodeTime deadline) = 0;

    /// How the transfer in flight stands at `now`. `done` and `failed` are told once and leave the bus idle;
    /// after `failed`, `error()` tells why. `idle` if nothing was submitted.
    [[nodiscard]] virtual TransferState poll(NodeTime now) = 0;
    [[nodiscard]] virtual TransferError error() const = 0;

    /// Frees a bus that a device holds: up to 9 clocks and a STOP, then a reset of the controller. A transfer
    /// in flight is dropped; its owner's next `poll` finds the bus idle. At most 1 ms. Returns whether both
    /// lines read high afterwards.
    virtual bool recover() = 0;

  protected:
    // Not virtual: nobody owns a bus through this interface, and firmware must not pull in operator delete.
    ~Bus() = default;
};

}  // namespace octoskin::i2c
