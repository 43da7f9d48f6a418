#include "host/core/query/evidence.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/bricks/brick_stamps.hpp"
#include "host/core/bricks/cube_parts.hpp"
#include "host/core/query/cube_geometry.hpp"
#include "host/core/query/nearest_search.hpp"
#include "host/core/query/segment_cube.hpp"

namespace octoskin {
namespace {

/// Visits the map's known space that the capsule touches, in Morton order.
class EvidenceSearch {
  public:
    EvidenceSearch(const FusedMap& map, const PosedCapsule& capsule, std::uint32_t limit) noexcept
        : map_(map),
          resolution_m_(map.resolution_m()),
          reach_m_(capsule.radius_m + kDistanceStep_m),
          segment_(capsule.p_a, capsule.p_b),
          box_{key_near(capsule.p_a.cwiseMin(capsule.p_b).array() - reach_m_, resolution_m_),
               key_near(capsule.p_a.cwiseMax(capsule.p_b).array() + reach_m_, resolution_m_)},
          limit_(limit) {}

    void run() noexcept { look(map_.space()); }

    [[nodiscard]] std::optional<VoxelKey> voxel() const noexcept { return voxel_; }
    [[nodiscard]] std::uint16_t stamp() const noexcept { return static_cast<std::uint16_t>(limit_); }

  private:
    [[nodiscard]] bool is_touched(const VoxelCube& cube) const {
        const Eigen::Vector3d centre = centre_of(cube, resolution_m_);
        const double half_m = half_edge_of(cube, resolution_m_);
        return !segment_.is_surely_beyond(centre, half_m, reach_m_ + 4.0 * kDistanceStep_m) &&
               segment_.distance(centre, half_m) <= reach_m_;
    }

    /// Recursion depth: the levels of the tree.
    void look(const BrickTree::Space& space) {
        if (!space.has_parts()) return look_into(space.cube(), space.bricks());
        for (auto parts = parts_in(space.cube(), box_); parts != 0 && limit_ > 0; parts &= parts - 1) {
            const auto part = space.part(static_cast<std::size_t>(std::countr_zero(parts)));
            if (is_touched(part.cube())) look(part);
        }
    }

    void look_into(const VoxelCube& brick, const BrickView& log_odds) {
        if (log_odds.is_unknown()) return;
        const MortonCode first = morton_of(brick.lowest);
        const StampView stamps = map_.layers().ages.find(first);
        if (stamps.values == nullptr && stamps.value >= limit_) return;
        for (std::size_t word = 0; word < kBrickVoxels / 64; ++word) {
            std::uint64_t voxels = stamps.values == nullptr
                                       ? ~std::uint64_t{0}
                                       : stamps_below(*stamps.values, word, stamp_limit());
            if (log_odds.values != nullptr && voxels != 0)
                voxels &= sets_of(*log_odds.values, word, 0.0F).known;
            take_weakest({key_of_morton(first + 64 * word), 2}, voxels, stamps, 64 * word);
        }
    }

    /// Tests 64 voxels. Each weaker voxel lowers the limit for the next.
    void take_weakest(const VoxelCube& cube, std::uint64_t voxels, const StampView& stamps,
                      std::size_t cell) {
        if (voxels == 0 || !is_touched(cube)) return;
        for (voxels &= parts_in(cube, box_); voxels != 0; voxels &= voxels - 1) {
            const auto part = static_cast<std::size_t>(std::countr_zero(voxels));
            const std::uint16_t stamp = stamps.at(cell + part);
            if (stamp >= limit_ || !is_touched(part_of(cube, part))) continue;
            voxel_ = part_of(cube, part).lowest;
            limit_ = stamp;
        }
    }

    [[nodiscard]] std::uint16_t stamp_limit() const {
        return static_cast<std::uint16_t>(
            std::min<std::uint32_t>(limit_, std::numeric_limits<std::uint16_t>::max()));
    }

    const FusedMap& map_;
    double resolution_m_;
    double reach_m_;
    SegmentToCubes segment_;
    KeyBox box_;
    std::uint32_t limit_;  ///< time stamps below it are weaker than all found so far
    std::optional<VoxelKey> voxel_;
};

}  // namespace

std::string_view name(SensorKind kind) noexcept {
    switch (kind) {
        case SensorKind::none:
            return "none";
        case SensorKind::range:
            return "range";
        case SensorKind::camera:
            return "camera";
    }
    return "none";
}

std::optional<WeakestEvidence> weakest_in(const FusedMap& map, const PosedCapsule& capsule,
                                          const std::optional<WeakestEvidence>& than) noexcept {
    // No time stamp reaches this value: the clock's largest value would need a kind of 3, which does not
    // exist.
    constexpr std::uint32_t kAnything = std::numeric_limits<std::uint16_t>::max();
    if (!map.layers().ages.has_begun()) return std::nullopt;
    EvidenceSearch search(map, capsule, than ? than->stamp : kAnything);
    search.run();
    if (!search.voxel()) return than;
    return WeakestEvidence{*search.voxel(), map.layers().ages.confirmation_of(search.stamp()),
                           search.stamp() < map.stale_stamp(), search.stamp()};
}

}  // namespace octoskin
