#include "host/core/query/weakest_free.hpp"

#include <limits>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/query/touched_voxels.hpp"

namespace octoskin {
namespace {

/// Each weaker voxel lowers the limit for the next.
class WeakestVisitor {
  public:
    WeakestVisitor(const FusedMap& map, const MissUnits& units,
                   const std::optional<WeakestFree>& than) noexcept
        : map_(map), units_(units), weakest_(than) {
        if (than) limit_ = than->evidence.sum();
    }

    bool begin(MortonCode first, const BrickView& log_odds) {
        brick_ = voxel_brick(map_.layers(), first, log_odds);
        // All voxels of such a brick are alike.
        const bool is_even = log_odds.values == nullptr && !brick_.has_counts;
        return limit_ > 0.0 && !(is_even && !is_wanted(0));
    }

    [[nodiscard]] std::uint64_t candidates(std::size_t word) const {
        if (brick_.log_odds.values == nullptr) return ~std::uint64_t{0};
        const WordSets sets = sets_of(*brick_.log_odds.values, word, map_.config().log_odds_occupied);
        return sets.known & ~sets.at_least;
    }

    [[nodiscard]] bool is_wanted(std::size_t cell) const {
        const VoxelState voxel = brick_.at(cell);
        return map_.occupancy_of(voxel.log_odds) == Occupancy::free &&
               free_evidence(voxel, units_).sum() < limit_;
    }
    void take(std::size_t cell, VoxelKey key) {
        weakest_ = WeakestFree{key, free_evidence(brick_.at(cell), units_)};
        limit_ = weakest_->evidence.sum();
    }

    [[nodiscard]] const std::optional<WeakestFree>& weakest() const noexcept { return weakest_; }

  private:
    const FusedMap& map_;
    const MissUnits& units_;
    VoxelBrick brick_;
    std::optional<WeakestFree> weakest_;
    double limit_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::optional<WeakestFree> weakest_free_in(const FusedMap& map, const MissUnits& units,
                                           const PosedCapsule& capsule,
                                           const std::optional<WeakestFree>& than) noexcept {
    WeakestVisitor visitor(map, units, than);
    TouchedVoxels(map, capsule, visitor).visit();
    return visitor.weakest();
}

}  // namespace octoskin
