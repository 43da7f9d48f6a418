// What a camera sees of the world from one place, without noise: a point for each pixel, and whether a ball
// is wholly in front of what the pixels see.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/lens/lens_distortion.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::evaluation {

/// A point that a pixel's centre sees, world frame.
struct ViewPoint {
    Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal_base = Eigen::Vector3d::UnitZ();  ///< of the surface, towards the camera; unit
    std::uint32_t solid = 0;                                 ///< index into the world's solids
    double depth_m = 0.0;                                    ///< along the optical axis
};

class CleanView {
  public:
    /// The camera is at `camera.T_link_camera`. One ray a pixel.
    CleanView(const sim::World& world, const rig::Camera& camera);

    /// The points within the camera's depth limits, row by row.
    [[nodiscard]] const std::vector<ViewPoint>& points() const noexcept { return points_; }

    /// True if the ball is wholly in the image and each pixel whose ray passes through it sees a point behind
    /// it. Then the camera sees its whole space, and nothing is in it. O(pixels on the ball).
    [[nodiscard]] bool is_clear(const Eigen::Vector3d& p_base, double radius_m) const;

  private:
    /// [u_begin, u_end) x [v_begin, v_end), in pixels.
    struct Rectangle {
        double u_begin = 0.0, u_end = 0.0, v_begin = 0.0, v_end = 0.0;
    };
    struct Ball {
        Eigen::Vector3d p_camera;
        double radius_m;
    };

    [[nodiscard]] std::vector<Eigen::Vector3d> rays_base() const;
    void find_nearest_of_blocks();
    /// The pixels that may see a ball in front of the camera, some beyond the image.
    [[nodiscard]] Rectangle rectangle_round(const Ball& ball) const;
    /// One pixel tells of most balls that they are not clear.
    [[nodiscard]] bool sees_behind_centre(const Ball& ball) const;
    [[nodiscard]] bool sees_behind(std::size_t pixel, const Ball& ball) const;
    /// Of all pixels in the rectangle that are in the block.
    [[nodiscard]] bool block_sees_behind(std::size_t column, std::size_t row, const Rectangle& rectangle,
                                         const Ball& ball) const;

    rig::Camera camera_;
    std::vector<RaySlope> slopes_;  ///< of each pixel, row by row
    std::vector<double> depth_m_;   ///< of each pixel; 0 outside the depth limits
    /// The least depth in each block of 16 x 16 pixels: most are far behind a ball.
    std::vector<double> block_depth_m_;
    std::vector<ViewPoint> points_;
};

}  // namespace octoskin::evaluation
