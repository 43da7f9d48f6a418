// Simulated time, and the clocks that are derived from it.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/time.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// A node's free-running microsecond counter: an arbitrary value at the start of the simulation, and a
/// crystal error of `drift_ppm`.
class NodeClock {
  public:
    constexpr NodeClock() = default;
    constexpr NodeClock(NodeTime at_start, double drift_ppm) : at_start_(at_start), drift_ppm_(drift_ppm) {}

    [[nodiscard]] NodeTime to_node(SimTime time) const noexcept {
        const double drift_us = static_cast<double>(time.us) * drift_ppm_ * 1e-6;
        return at_start_ + Microseconds{time.us + static_cast<std::int64_t>(std::floor(drift_us))};
    }

    [[nodiscard]] constexpr double drift_ppm() const noexcept { return drift_ppm_; }

  private:
    NodeTime at_start_{};
    double drift_ppm_ = 0.0;
};

/// The present time of a simulation: one instance, advanced by the simulation's loop and read by the models.
struct Present {
    SimTime time{};
};

}  // namespace octoskin::sim
