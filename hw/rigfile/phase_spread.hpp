// Checks how a node's sensors are spread in time (`phase_us`): on their I2C bus, so that no reading waits for
// another, and optically, so that no two sensors range at once that see the same place or each other. Nodes
// have separate clocks, so there is no spread between nodes.
#pragma once

#include <cstddef>
#include <vector>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// The load of one bus over the period in which its sensors' readings repeat.
struct PhaseSpread {
    double mean = 0.0;     ///< share of the time that readings occupy the bus
    double peak = 0.0;     ///< the same in its busiest 5 ms; above 1 if readings wait for each other
    double reading = 0.0;  ///< the share of 5 ms that a single reading takes: the minimum of `peak`
    /// No window of 5 ms is loaded above 1.5 times the mean, or above a single reading.
    [[nodiscard]] bool is_even() const;
};
/// At the slowest clock of `i2c_load`. Sensors of several periods are evaluated over their least common
/// multiple, at most 10 s. O(readings in that time squared).
[[nodiscard]] PhaseSpread phase_spread(const NodeConfig& node, std::uint8_t bus);

struct SensorPair {
    std::size_t first = 0;
    std::size_t second = 0;
};
/// Pairs on one link that see the same place (their axes are less than the field of view of 27 degrees apart:
/// datasheet DS12385) or each other, have one period, and range at the same time for over 1 ms more than
/// their budgets require.
[[nodiscard]] std::vector<SensorPair> pairs_ranging_together(const Node& node);
/// The connected groups of these pairs. Indices ascend within a group; groups are sorted by their first
/// index.
[[nodiscard]] std::vector<std::vector<std::size_t>> groups_ranging_together(const Node& node);

}  // namespace octoskin::rig
