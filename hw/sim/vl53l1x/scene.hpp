// The interface between the register model of a sensor and the world.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/time.hpp"

namespace octoskin::sim {

/// Simulated time: microseconds since the start of the simulation, the common clock of all models. A node's
/// own clock is derived from it by an offset and a drift.
struct SimTime {
    std::int64_t us = 0;
    friend constexpr auto operator<=>(SimTime, SimTime) = default;
};

/// The optics' return for one ranging window, with noise.
struct RangingReturn {
    std::optional<double> range_m;  ///< empty: too little signal (device code 4)
    double sigma_m = 0.0;
    double peak_signal_mcps =
        0.0;  ///< below the limit in 0x66 (1.0 at the defaults) there is no target either
    double ambient_mcps = 0.0;
};

/// Called once per ranging, for the middle of its window. `ranging_index` counts this sensor's rangings since
/// power-up, so that noise is a function of (seed, sensor, ranging_index) and not of the order of draws.
using RangingScene =
    std::function<RangingReturn(std::uint32_t ranging_index, SimTime window_middle, const Roi& roi)>;

}  // namespace octoskin::sim
