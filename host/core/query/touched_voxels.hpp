// Visits the known voxels that a capsule touches.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "host/core/bricks/brick_tree.hpp"
#include "host/core/bricks/cube_parts.hpp"
#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/query/cube_geometry.hpp"
#include "host/core/query/nearest_search.hpp"
#include "host/core/query/segment_cube.hpp"

namespace octoskin {

/// In Morton order; touched in the sense of `worst_in`. The visitor chooses which voxels are worth the test:
///
///     bool begin(MortonCode first, const BrickView& log_odds);  // a brick with known voxels; false: leave
///     out std::uint64_t candidates(std::size_t word);               // of that brick, 64 voxels at a time
///     bool is_wanted(std::size_t cell);                         // one of them, by what was taken before
///     void take(std::size_t cell, VoxelKey key);                // it is touched
///
/// No allocation. Recursion depth: the levels of the tree.
template <class Visitor>
class TouchedVoxels {
  public:
    /// `capsule`: finite, in the map frame.
    TouchedVoxels(const FusedMap& map, const PosedCapsule& capsule, Visitor& visitor) noexcept
        : map_(map),
          visitor_(visitor),
          resolution_m_(map.resolution_m()),
          reach_m_(capsule.radius_m + kDistanceStep_m),
          segment_(capsule.p_a, capsule.p_b),
          box_{key_near(capsule.p_a.cwiseMin(capsule.p_b).array() - reach_m_, resolution_m_),
               key_near(capsule.p_a.cwiseMax(capsule.p_b).array() + reach_m_, resolution_m_)} {}

    void visit() noexcept { look(map_.space()); }

  private:
    [[nodiscard]] bool is_touched(const VoxelCube& cube) const {
        const Eigen::Vector3d centre = centre_of(cube, resolution_m_);
        const double half_m = half_edge_of(cube, resolution_m_);
        return !segment_.is_surely_beyond(centre, half_m, reach_m_ + 4.0 * kDistanceStep_m) &&
               segment_.distance(centre, half_m) <= reach_m_;
    }

    void look(const BrickTree::Space& space) {
        if (!space.has_parts()) return look_into(space.cube(), space.bricks());
        for (auto parts = parts_in(space.cube(), box_); parts != 0; parts &= parts - 1) {
            const auto part = space.part(static_cast<std::size_t>(std::countr_zero(parts)));
            if (is_touched(part.cube())) look(part);
        }
    }

    void look_into(const VoxelCube& brick, const BrickView& log_odds) {
        if (log_odds.is_unknown()) return;
        const MortonCode first = morton_of(brick.lowest);
        if (!visitor_.begin(first, log_odds)) return;
        for (std::size_t word = 0; word < kBrickVoxels / 64; ++word) {
            const std::uint64_t voxels = visitor_.candidates(word);
            if (voxels != 0) test({key_of_morton(first + 64 * word), 2}, voxels, 64 * word);
        }
    }

    void test(const VoxelCube& cube, std::uint64_t voxels, std::size_t cell) {
        if (!is_touched(cube)) return;
        for (voxels &= parts_in(cube, box_); voxels != 0; voxels &= voxels - 1) {
            const auto part = static_cast<std::size_t>(std::countr_zero(voxels));
            if (visitor_.is_wanted(cell + part) && is_touched(part_of(cube, part)))
                visitor_.take(cell + part, part_of(cube, part).lowest);
        }
    }

    const FusedMap& map_;
    Visitor& visitor_;
    double resolution_m_;
    double reach_m_;
    SegmentToCubes segment_;
    KeyBox box_;
};

}  // namespace octoskin
