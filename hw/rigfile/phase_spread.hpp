// Whether a node's sensors take turns: on their I2C bus, so that no reading waits for another, and in the
// light, so that no two that look at the same place or at each other range at once. `phase_us` is what
// spreads them; nodes have clocks of their own, so between nodes nothing can be promised.
#pragma once

#include <cstddef>
#include <vector>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// Of one bus, over the time in which its sensors' turns repeat.
struct PhaseSpread {
    double mean = 0.0;     ///< share of the time that readings occupy the bus
    double peak = 0.0;     ///< the same in its busiest 5 ms; above 1 if readings wait for each other
    double reading = 0.0;  ///< the share that one reading alone takes of 5 ms: the least that `peak` can be
    /// No 5 ms are loaded above one and a half times the mean, or above a single reading.
    [[nodiscard]] bool is_even() const;
};
/// At the slowest clock of `i2c_load`. Sensors of several periods are looked at for their least common
/// multiple, at most 10 s. O(readings in that time squared).
[[nodiscard]] PhaseSpread phase_spread(const NodeConfig& node, std::uint8_t bus);

struct SensorPair {
    std::size_t first = 0;
    std::size_t second = 0;
};
/// Pairs on one link that see the same place (their axes are less than the field of view of 27 degrees apart:
/// datasheet DS12385) or each other, have one period, and range at the same time for over a millisecond more
/// than their budgets make necessary.
[[nodiscard]] std::vector<SensorPair> pairs_ranging_together(const Node& node);
/// The same pairs as groups: who hangs together by a chain of them. Indices rise within a group, as do the
/// groups' first ones.
[[nodiscard]] std::vector<std::vector<std::size_t>> groups_ranging_together(const Node& node);

}  // namespace octoskin::rig
