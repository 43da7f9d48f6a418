// All that the node core wants from a board, and what a board tells about itself.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"

namespace octoskin::node {

/// The XSHUT outputs of a board. All of them are low until the node raises one.
class XshutLines {
  public:
    virtual void set(std::uint8_t line, bool is_high) = 0;

  protected:
    ~XshutLines() = default;
};

/// The transmit side of the CAN controller.
class CanTransmitter {
  public:
    /// Takes a frame if there is room; false means try again later. Never waits.
    [[nodiscard]] virtual bool send(const wire::CanFrame& frame) = 0;

  protected:
    ~CanTransmitter() = default;
};

/// A light by which a person finds the board that the `identify` command means.
class Indicator {
  public:
    virtual void set(bool is_on) = 0;

  protected:
    ~Indicator() = default;
};

/// What a board tells about itself.
struct Identity {
    std::array<std::uint8_t, 12> uid{};
    std::uint32_t build_id = 0;
    wire::ResetCause reset_cause = wire::ResetCause::power_on;
};

/// Everything referred to must outlive the node.
struct Ports {
    std::span<i2c::Bus* const> buses;  ///< one per I2C bus of the board, index as in the configuration
    XshutLines& xshut;
    CanTransmitter& can;
    Indicator* indicator = nullptr;  ///< boards without a light have none
};

}  // namespace octoskin::node
