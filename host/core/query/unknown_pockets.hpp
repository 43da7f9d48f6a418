// Finds pockets of unmeasured space near the robot: connected unknown voxels next to free space.
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

/// True if the point is in the region. `p_map`: map frame, metres.
[[nodiscard]] inline bool is_within(const PocketRegion& region, const Eigen::Vector3d& p_map) noexcept {
    return (p_map - region.centre).norm() <= region.radius_m && p_map.z() >= region.z_min_m;
}

struct UnknownPocket {
    std::size_t voxels = 0;
    std::size_t border_voxels = 0;  ///< with a free voxel beside a face
    double volume_m3 = 0.0;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of its voxels, map frame
    VoxelKey nearest_border;                           ///< to the centre
};

/// The pockets of a region, by size, and the pocket of each border voxel.
class UnknownPockets {
  public:
    static constexpr std::size_t kVoxelsMax = std::size_t{1} << 24U;

    /// Voxels are connected through faces, and belong to the region if their centres do. Pockets of fewer
    /// than `voxels_min` voxels, and those without a free neighbour, are left out. Empty: the region is not
    /// finite, reaches out of the octree, or its box has more than kVoxelsMax voxels; or `is_ending`, which
    /// is called every few thousand voxels, returned true. About 30 ns per voxel of the box. Working memory:
    /// one byte per voxel, and up to 16 more per unknown voxel. Throws std::bad_alloc.
    [[nodiscard]] static std::optional<UnknownPockets> find(
        const FusedMap& map, const PocketRegion& region, std::size_t voxels_min,
        const std::function<bool()>& is_ending = [] { return false; });

    /// The largest first; of equals the first one along z, y and x.
    [[nodiscard]] const std::vector<UnknownPocket>& pockets() const noexcept { return pockets_; }
    /// Index of the pocket whose border contains this voxel.
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
