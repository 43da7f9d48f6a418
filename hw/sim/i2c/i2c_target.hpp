// A device on a simulated I2C bus, byte by byte. The bus passes the time of each byte.
#pragma once

#include <cstdint>

#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

class I2cTarget {
  public:
    /// START (or repeated START) with an address. True to acknowledge.
    virtual bool on_start(std::uint8_t address, bool is_read, SimTime time) = 0;
    /// A byte from the controller. True to acknowledge.
    virtual bool on_write(std::uint8_t byte, SimTime time) = 0;
    /// The next byte to the controller.
    virtual std::uint8_t on_read(SimTime time) = 0;
    virtual void on_stop(SimTime time) = 0;

    /// True while it holds SDA low without a transfer, as a part does after a transfer that stopped in the
    /// middle of a byte.
    virtual bool holds_sda(SimTime) { return false; }
    /// Clocks given to an idle bus to free it.
    virtual void on_clocks(std::uint32_t, SimTime) {}

  protected:
    ~I2cTarget() = default;
};

}  // namespace octoskin::sim
