#include "host/core/query/evidence.hpp"

#include <algorithm>
#include <limits>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/bricks/brick_stamps.hpp"
#include "host/core/query/touched_voxels.hpp"

namespace octoskin {
namespace {

/// Finds the lowest time stamp. Each weaker voxel lowers the limit for the next.
class OldestVisitor {
  public:
    OldestVisitor(const FusedMap& map, std::uint32_t limit) noexcept : map_(map), limit_(limit) {}

    bool begin(MortonCode first, const BrickView& log_odds) {
        log_odds_ = log_odds;
        stamps_ = map_.layers().ages.find(first);
        return limit_ > 0 && (stamps_.values != nullptr || stamps_.value < limit_);
    }

    [[nodiscard]] std::uint64_t candidates(std::size_t word) const {
        const std::uint64_t voxels = stamps_.values == nullptr
                                         ? ~std::uint64_t{0}
                                         : stamps_below(*stamps_.values, word, stamp_limit());
        return log_odds_.values != nullptr && voxels != 0
                   ? voxels & sets_of(*log_odds_.values, word, 0.0F).known
                   : voxels;
    }

    [[nodiscard]] bool is_wanted(std::size_t cell) const { return stamps_.at(cell) < limit_; }
    void take(std::size_t cell, VoxelKey key) {
        voxel_ = key;
        limit_ = stamps_.at(cell);
    }

    [[nodiscard]] std::optional<VoxelKey> voxel() const noexcept { return voxel_; }
    [[nodiscard]] std::uint16_t stamp() const noexcept { return static_cast<std::uint16_t>(limit_); }

  private:
    [[nodiscard]] std::uint16_t stamp_limit() const {
        return static_cast<std::uint16_t>(
            std::min<std::uint32_t>(limit_, std::numeric_limits<std::uint16_t>::max()));
    }

    const FusedMap& map_;
    BrickView log_odds_;
    StampView stamps_;
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
    OldestVisitor oldest(map, than ? than->stamp : kAnything);
    TouchedVoxels(map, capsule, oldest).visit();
    if (!oldest.voxel()) return than;
    return WeakestEvidence{*oldest.voxel(), map.layers().ages.confirmation_of(oldest.stamp()),
                           oldest.stamp() < map.stale_stamp(), oldest.stamp()};
}

}  // namespace octoskin
