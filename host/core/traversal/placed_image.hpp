// The rays of one depth image, placed in the map: where each pixel's ray ends.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/crew/crew.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/pixel_rays.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// What became of each pixel: width * height = the sum of these.
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

/// Row-major, one entry a pixel, and some more: as many as a vector of any instruction set holds may be read
/// from each. In a pixel that has no ray the end is the camera and the reach is negative.
struct PlacedImage {
    static constexpr std::uint32_t kNoKey = ~std::uint32_t{0};
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    Eigen::Vector3f origin = Eigen::Vector3f::Zero();  ///< of every ray, map frame, metres
    /// Map frame, metres, in OctoMap's single precision; empty of place_voxels().
    std::vector<float> end_x;
    std::vector<float> end_y;
    std::vector<float> end_z;
    std::vector<float> reach_m;  ///< depth of the end along the optical axis
    std::vector<float>
        passed_m;  ///< a ray passes the voxels that it is in before this depth, or ends in them
    /// Measured, along the ray; negative: the ray ends in nothing, as beyond the maximum, or there is none.
    std::vector<double> range_m;        ///< of place_image(), empty otherwise
    std::vector<std::uint32_t> key_xy;  ///< of the end's voxel: x, and y in the upper half
    std::vector<std::uint32_t> key_z;   ///< kNoKey where the ray ends in nothing
    DepthPixelCounts counts;
    [[nodiscard]] std::size_t pixels() const noexcept { return std::size_t{width} * height; }
    Eigen::Vector3f lowest = Eigen::Vector3f::Zero();  ///< of all ends and the origin
    Eigen::Vector3f highest = Eigen::Vector3f::Zero();
};

/// Nearer to a voxel's face, in voxels and as a share of the coordinate, rounding may decide on which side an
/// end lies: as OctoMap walks, its ray may neither pass nor end in the voxel before the face.
inline constexpr double kAtFace = 1e-3;
inline constexpr double kAtFaceShare = 4e-6;

/// Every pixel's ray is independent of every other's, and of how many are worked on at once: the result is
/// bit for bit that of Eigen's `T_map_camera * (depth * ray)`. Places every pixel of `image` (of the camera's
/// size, asserted) as seen from `T_map_camera`. A range beyond `range_max_m` (0: none) ends at it, as in
/// OctoMap's `computeUpdate`. Some 2 ms for 512 x 424, which `crew` shares, if there is one.
void place_image(const DepthImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
                 const Eigen::Isometry3d& T_map_camera, double range_max_m, PlacedImage& placed,
                 Crew* crew = nullptr);

}  // namespace octoskin
