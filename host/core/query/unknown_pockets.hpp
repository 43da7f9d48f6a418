// Where, about the robot, nobody has looked: connected unknown voxels with free space beside them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// A ball, cut off below a plane. Metres, map frame.
struct PocketRegion {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius_m = 1.0;
    double z_min_m = 0.0;
};

/// Of a point, map frame.
[[nodiscard]] inline bool is_within(const PocketRegion& region, const Eigen::Vector3d& p_map) noexcept {
    return (p_map - region.centre).norm() <= region.radius_m && p_map.z() >= region.z_min_m;
}

struct UnknownPocket {
    std::size_t voxels = 0;
    std::size_t border_voxels = 0;  ///< that have a free one beside a face
    double volume_m3 = 0.0;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of its voxels, map frame
    VoxelKey nearest_border;                           ///< to the centre
};

/// The pockets of a region, by size, and which voxel is the border of which.
class UnknownPockets {
  public:
    static constexpr std::size_t kVoxelsMax = std::size_t{1} << 24U;

    /// Voxels are connected by their faces, and belong to the region if their centres do. Pockets of fewer
    /// than `voxels_min` voxels, and those that no free voxel borders, are left out. Empty: the region is not
    /// finite, reaches out of the octree, or its box has more than kVoxelsMax voxels. About 30 ns a voxel of
    /// the box, and for as long as it works a byte and up to 16 more if it is unknown; throws std::bad_alloc.
    /// `is_ending` is asked each few thousand voxels, and true ends it: empty, too.
    [[nodiscard]] static std::optional<UnknownPockets> find(
        const FusedMap& map, const PocketRegion& region, std::size_t voxels_min,
        const std::function<bool()>& is_ending = [] { return false; });

    /// The largest first; of equals the one that comes first along z, y and x.
    [[nodiscard]] const std::vector<UnknownPocket>& pockets() const noexcept { return pockets_; }
    /// The pocket whose border this voxel is.
    [[nodiscard]] std::optional<std::size_t> border_of(VoxelKey key) const noexcept;
    [[nodiscard]] std::size_t unknown_voxels() const noexcept { return unknown_voxels_; }
    [[nodiscard]] std::size_t region_voxels() const noexcept { return region_voxels_; }

  private:
    struct Border {
        std::uint64_t voxel = 0;
        std::uint32_t pocket = 0;
    };
    std::vector<UnknownPocket> pockets_;
    std::vector<Border> borders_;  ///< by voxel
    std::size_t unknown_voxels_ = 0;
    std::size_t region_voxels_ = 0;
};

}  // namespace octoskin
