// Finds the voxels that a ray passes through: exactly the keys of OctoMap 1.9's computeRayKeys, for any
// origin and end.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "common/result.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

enum class RayFault : std::uint8_t {
    not_finite,   ///< origin or end has a NaN or an infinity
    outside_map,  ///< origin or end lies outside the octree
};

/// A ray prepared for walking. Along each axis i the ray crosses voxel faces at distances t_next[i],
/// t_next[i] + t_step[i], ... from the origin. The axis with the nearest crossing is stepped next (Amanatides
/// and Woo 1987).
struct Ray {
    VoxelKey first;                      ///< contains the origin
    VoxelKey last;                       ///< contains the end; never visited
    std::array<std::int32_t, 3> sign{};  ///< of the direction along each axis: -1, 0, 1
    std::array<double, 3> t_next{};  ///< distance to the next face, metres; huge for an axis never stepped
    std::array<double, 3> t_step{};  ///< distance between two faces, metres
    float length_m = 0.0F;
    /// Upper bound on the steps of a walk. Exact arithmetic crosses |last - first| faces along each axis
    /// within the length. Coordinates are at most 2^15 voxels and single precision has 24 bits, so rounding
    /// moves a crossing by far less than one voxel: each axis can take one step too many, never two.
    std::int32_t steps_max = 0;
};

/// Prepares the ray from `origin` to `end`, both in the map frame in metres, in OctoMap's single precision.
[[nodiscard]] Result<Ray, RayFault> plan_ray(const VoxelLattice& lattice, const Eigen::Vector3f& origin,
                                             const Eigen::Vector3f& end);

/// The caller's numbering of voxels: a linear index, and the increment for one step along each axis.
struct VoxelIndexing {
    std::ptrdiff_t first = 0;
    std::ptrdiff_t last = 0;
    std::array<std::ptrdiff_t, 3> stride{};
};

/// Calls visit(index) for each voxel from the origin to the end: the origin's own is included, the end's is
/// not. If both lie in one voxel there is no call. Along each axis the walk may leave the range between the
/// two by one voxel (see `Ray::steps_max`); the numbering must give such voxels distinct indices. O(voxels),
/// about 4 ns each.
template <class Visit>
void walk_ray(const Ray& ray, const VoxelIndexing& indexing, Visit&& visit) {
    if (indexing.first == indexing.last) return;
    const std::ptrdiff_t x_stride = ray.sign[0] * indexing.stride[0];
    const std::ptrdiff_t y_stride = ray.sign[1] * indexing.stride[1];
    const std::ptrdiff_t z_stride = ray.sign[2] * indexing.stride[2];
    auto [x_next, y_next, z_next] = ray.t_next;
    std::ptrdiff_t index = indexing.first;
    visit(index);
    for (std::int32_t step = 0; step < ray.steps_max; ++step) {
        // On a tie z precedes y and y precedes x. Selects instead of branches: the next axis is nearly
        // random, and a misprediction costs more than the whole step.
        const bool is_x = x_next < y_next && x_next < z_next;
        const bool is_y = !(x_next < y_next) && y_next < z_next;
        const bool is_z = !is_x && !is_y;
        index += is_x ? x_stride : is_y ? y_stride : z_stride;
        x_next += is_x ? ray.t_step[0] : 0.0;
        y_next += is_y ? ray.t_step[1] : 0.0;
        z_next += is_z ? ray.t_step[2] : 0.0;
        if (index == indexing.last) return;
        // Rounding led past the last voxel. OctoMap also ends the ray here and omits the voxel just entered,
        // even if the ray passes it.
        if (std::min({x_next, y_next, z_next}) > static_cast<double>(ray.length_m)) return;
        visit(index);
    }
}

/// The same, with keys. Omits a voxel beyond the octree's bounds, which rounding can reach within one voxel.
template <class Visit>
void walk_ray_keys(const Ray& ray, Visit&& visit) {
    // One field of 20 bits an axis, offset by one so that a key of -1 borrows nothing from its neighbour.
    constexpr std::array<std::ptrdiff_t, 3> kStride = {1, std::ptrdiff_t{1} << 20U, std::ptrdiff_t{1} << 40U};
    const auto pack = [&](VoxelKey key) {
        return (key.x + 1) * kStride[0] + (key.y + 1) * kStride[1] + (key.z + 1) * kStride[2];
    };
    walk_ray(ray, {.first = pack(ray.first), .last = pack(ray.last), .stride = kStride},
             [&](std::ptrdiff_t index) {
                 const std::ptrdiff_t x = (index & 0xFFFFF) - 1;
                 const std::ptrdiff_t y = ((index >> 20U) & 0xFFFFF) - 1;
                 const std::ptrdiff_t z = (index >> 40U) - 1;
                 const auto is_key = [](std::ptrdiff_t value) {
                     return value >= 0 && value < kVoxelsPerAxis;
                 };
                 if (!is_key(x) || !is_key(y) || !is_key(z)) return;
                 visit(VoxelKey{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                                static_cast<std::uint16_t>(z)});
             });
}

}  // namespace octoskin
