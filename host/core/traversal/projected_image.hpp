// The projected image: the rays of one depth image in the map, and where each ends.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/pixel_rays.hpp"
#include "host/core/parallel/thread_pool.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Counts the results of all pixels; their sum is width * height.
struct DepthPixelCounts {
    std::uint64_t used = 0;
    std::uint64_t no_value = 0;     ///< NaN: no return, filtered, or the robot
    std::uint64_t bad_value = 0;    ///< infinite, zero or negative
    std::uint64_t outside_map = 0;  ///< the endpoint lies outside the octree
    DepthPixelCounts& operator+=(const DepthPixelCounts& others) noexcept {
        used += others.used;
        no_value += others.no_value;
        bad_value += others.bad_value;
        outside_map += others.outside_map;
        return *this;
    }
};

/// Row-major, one entry per pixel, plus padding: one vector of any instruction set may be read from each
/// entry. For a pixel without a ray the end is the camera and the reach is negative.
struct ProjectedImage {
    static constexpr std::uint32_t kNoKey = ~std::uint32_t{0};
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    Eigen::Vector3f origin = Eigen::Vector3f::Zero();  ///< of every ray, map frame, metres
    /// Map frame, metres, in OctoMap's single precision; empty after place_voxels().
    std::vector<float> end_x;
    std::vector<float> end_y;
    std::vector<float> end_z;
    std::vector<float> reach_m;  ///< depth of the end along the optical axis
    /// A ray passes the voxels that it is in before this depth, or ends in them.
    std::vector<float> passed_m;
    /// Measured range along the ray; negative if the ray has no end at a surface (for example beyond the
    /// maximum) or there is no ray.
    std::vector<double> range_m;        ///< set by place_image(), empty otherwise
    std::vector<std::uint32_t> key_xy;  ///< key of the end's voxel: x, and y in the upper half
    std::vector<std::uint32_t> key_z;   ///< kNoKey if the ray has no end at a surface
    DepthPixelCounts counts;
    [[nodiscard]] std::size_t pixels() const noexcept { return std::size_t{width} * height; }
    Eigen::Vector3f lowest = Eigen::Vector3f::Zero();  ///< of all ends and the origin
    Eigen::Vector3f highest = Eigen::Vector3f::Zero();
};

/// If an end is nearer to a voxel's face than this (in voxels, and as a share of the coordinate), rounding
/// may decide on which side it lies: in OctoMap's walk its ray may neither pass nor end in the voxel before
/// the face.
inline constexpr double kAtFace = 1e-3;
inline constexpr double kAtFaceShare = 4e-6;

/// Projects all pixels of `image` (of the camera's size, asserted) as seen from `T_map_camera`. A range
/// beyond `range_max_m` (0: no limit) ends at it, as in OctoMap's `computeUpdate`. The pixels are
/// independent: the result equals Eigen's `T_map_camera * (depth * ray)`, bit for bit, for any vector length.
/// About 2 ms for 512 x 424, shared by the thread pool `pool` if there is one.
void place_image(const DepthImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
                 const Eigen::Isometry3d& T_map_camera, double range_max_m, ProjectedImage& placed,
                 ThreadPool* pool = nullptr);

}  // namespace octoskin
