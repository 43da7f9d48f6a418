// A sensor board as the experiment runs it: the node core in this process, or the flashed image on an
// emulated board in another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "hw/sim/clock.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// How a board starts.
struct BoardStart {
    NodeClock clock{};     ///< its microsecond counter, as it truly runs
    SimTime first_turn{};  ///< when the node core begins to work
};

class RigBoard {
  public:
    virtual ~RigBoard() = default;
    /// Runs up to `now`, the bus's present; several boards may do so at once until `finish_turn`.
    virtual void begin_turn(SimTime now) = 0;
    virtual void finish_turn() = 0;
    [[nodiscard]] virtual double i2c_busy_s(std::size_t bus) = 0;
    [[nodiscard]] virtual BoardStart start() = 0;
    /// What its program did against the chip's manuals, one a line; empty if nothing.
    [[nodiscard]] virtual std::string violations() { return {}; }
};

}  // namespace octoskin::sim
