// The one-joint robot turns at 1 rad/s while its sensor ranges at 30 Hz, and every range differs from its
// neighbours', between 1.5 and 3.7 m: a range placed 50 ms away from its time ends 8 cm or more from every
// true endpoint, but for a rare coincidence.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {

struct Shot {
    double captured_s = 0.0;
    double range_m = 0.0;
    /// Where it ends in the map.
    [[nodiscard]] Eigen::Vector3d p_map() const;
};

/// From 3.0 to 7.9 s, 149 of them.
[[nodiscard]] std::vector<Shot> shots();

/// Their bus, and nothing else on it. `node`'s clock reads `offset_us` at host time 0.
[[nodiscard]] Scene turning_scene(wire::NodeId node = kLeft, std::uint32_t offset_us = 3'000'000'000U);

/// Replays and expects balanced accounts.
[[nodiscard]] Pipeline play(const Scene& scene, const std::vector<StampedFrame>& frames);

/// Expects the voxel of every hit to be one where a shot truly ended, or its neighbour, and `hits_min` of
/// them.
void expect_hits_where_shots_ended(const Pipeline& pipeline, std::size_t hits_min);

}  // namespace octoskin::test
