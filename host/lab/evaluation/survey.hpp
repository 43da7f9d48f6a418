// The ground-truth camera's tour: a noise-free depth camera moved round the scene without the robot, after
// Strong et al. 2021, section III.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "hw/rigfile/rig.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::evaluation {

/// One camera position of the tour, world frame, metres.
struct Viewpoint {
    Eigen::Vector3d p_base_camera = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_base_look_at = Eigen::Vector3d::UnitX();
};

/// T_base_camera of a viewpoint: optical frame, the image's top towards +z of the world (towards +x when
/// looking straight up or down).
[[nodiscard]] Eigen::Isometry3d T_base_camera_of(const Viewpoint& viewpoint);

/// Parameters of the experiment's tour: 72 positions on three circles, 28 in front of the shelves, 6 above.
struct SurveyPattern {
    Eigen::Vector2d orbit_centre{0.6, 0.0};
    double orbit_radius_m = 1.9;
    std::uint32_t orbit_azimuths = 24;
    std::vector<double> orbit_heights_m{0.25, 0.9, 1.7};
    double orbit_look_at_height_m = 0.45;

    std::vector<double> front_x_m{-0.4, 0.05};
    std::vector<double> front_y_m{-0.9, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9};
    std::vector<double> front_z_m{0.25, 0.75};
    double front_look_at_x_m = 1.2;  ///< straight ahead: y and z as the camera's

    std::vector<double> above_x_m{0.0, 0.6, 1.2};
    std::vector<double> above_y_m{-0.5, 0.5};
    double above_z_m = 2.4;
    double above_look_at_z_m = 0.0;

    /// The same tour fitted to any region (its low z at the floor's top): circles outside of it, the front
    /// row inside it on its low-x side, the top row above it. The experiment's region gives the experiment's
    /// tour.
    [[nodiscard]] static SurveyPattern around(const Eigen::Vector3d& p_base_min,
                                              const Eigen::Vector3d& p_base_max);
};

/// Orbit, front, above, in this order.
[[nodiscard]] std::vector<Viewpoint> viewpoints_of(const SurveyPattern& pattern);

/// The camera of the tour: 512 x 424 pixels, f = 365, depth 0.5..4.5 m; every second pixel of every second
/// row is cast.
struct SurveyConfig {
    std::vector<Viewpoint> viewpoints = viewpoints_of(SurveyPattern{});
    rig::Camera camera{.width = 512,
                       .height = 424,
                       .fx = 365.0,
                       .fy = 365.0,
                       .cx = 256.0,
                       .cy = 212.0,
                       .rate_hz = 10.0,
                       .depth_min_m = 0.5,
                       .depth_max_m = 4.5,
                       .T_link_camera = Eigen::Isometry3d::Identity()};
    std::uint32_t pixel_stride = 2;
};

/// What a camera sees from one place, noise-free: surface points in the world frame, stored as float to halve
/// the memory (rounding 0.1 um at 2 m). A pixel outside the camera's depth limits has no point.
struct DepthView {
    Eigen::Vector3d p_base_camera = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3f> p_base_points;
};

/// Renders a world with `camera` at `T_base_camera`. O(pixels) ray casts.
[[nodiscard]] DepthView render_view(const sim::World& world, const rig::Camera& camera,
                                    const Eigen::Isometry3d& T_base_camera, std::uint32_t pixel_stride);

/// The whole tour, without positions inside a solid. It does not depend on the seed: a seed moves the map's
/// grid, not world or camera. Render it once and pass it to every `build_truth`. About 0.2 s and 50 MB for
/// the experiment.
struct Survey {
    std::vector<DepthView> views;
};
[[nodiscard]] Survey render_survey(const sim::World& world, const SurveyConfig& config);

}  // namespace octoskin::evaluation
