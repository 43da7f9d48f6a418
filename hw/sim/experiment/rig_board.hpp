// A sensor board of the experiment: the node core in this process, or the flashed image on an emulated board
// in another process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "hw/sim/clock.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// How a board starts.
struct BoardStart {
    NodeClock clock{};     ///< its true microsecond counter
    SimTime first_turn{};  ///< when the node core starts
};

class RigBoard {
  public:
    virtual ~RigBoard() = default;
    /// Runs up to `now`, the bus's present time. Several boards may run at once until `finish_turn`.
    virtual void begin_turn(SimTime now) = 0;
    virtual void finish_turn() = 0;
    [[nodiscard]] virtual double i2c_busy_s(std::size_t bus) = 0;
    [[nodiscard]] virtual BoardStart start() = 0;
    /// Violations of the chip's manuals by its program, one per line; empty if none.
    [[nodiscard]] virtual std::string violations() { return {}; }
};

}  // namespace octoskin::sim
