// Positions of voxels: OctoMap's discrete keys and their arithmetic. Independent of what a voxel contains.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <optional>

namespace octoskin {

/// OctoMap's discrete address of a voxel: 32768 is the voxel whose lower corner is the origin.
struct VoxelKey {
    std::uint16_t x = 0;
    std::uint16_t y = 0;
    std::uint16_t z = 0;
    friend constexpr auto operator<=>(const VoxelKey&, const VoxelKey&) = default;
};

/// An octree of 16 levels spans this many voxels along each axis, half of them on either side of the origin.
inline constexpr int kVoxelsPerAxis = 65536;
inline constexpr int kOriginKey = kVoxelsPerAxis / 2;

/// The grid of cubes of one edge length within the octree's bounds.
class VoxelLattice {
  public:
    /// `resolution_m` is finite and positive (asserted).
    explicit VoxelLattice(double resolution_m);

    [[nodiscard]] double resolution_m() const noexcept { return resolution_m_; }

    /// The key along one axis; empty for a coordinate that is not finite or outside the octree. A coordinate
    /// exactly on a face belongs to the upper voxel. Same as OctoMap's `coordToKeyChecked(double)`, but only
    /// a number that fits is converted to an integer: the conversion of a NaN or 1e30 depends on the
    /// processor.
    [[nodiscard]] std::optional<std::uint16_t> key_of(double coordinate_m) const noexcept {
        const double scaled = voxels_per_m_ * coordinate_m;
        if (!(scaled >= -kOriginKey && scaled < kOriginKey)) return std::nullopt;
        const int towards_zero = static_cast<int>(scaled);
        const int floored = towards_zero - (scaled < static_cast<double>(towards_zero) ? 1 : 0);
        return static_cast<std::uint16_t>(floored + kOriginKey);
    }

    /// The voxel that contains a point in the map frame, metres; empty if a coordinate has no key.
    [[nodiscard]] std::optional<VoxelKey> key_of(const Eigen::Vector3d& p_map) const noexcept {
        const auto x = key_of(p_map.x());
        const auto y = key_of(p_map.y());
        const auto z = key_of(p_map.z());
        if (!x || !y || !z) return std::nullopt;
        return VoxelKey{*x, *y, *z};
    }

    /// The voxel's centre along one axis, metres. OctoMap's `keyToCoord`.
    [[nodiscard]] double centre_of(std::uint16_t key) const noexcept {
        return (static_cast<double>(key - kOriginKey) + 0.5) * resolution_m_;
    }
    [[nodiscard]] Eigen::Vector3d centre_of(VoxelKey key) const noexcept {
        return {centre_of(key.x), centre_of(key.y), centre_of(key.z)};
    }

  private:
    double resolution_m_;
    double voxels_per_m_;
};

}  // namespace octoskin
