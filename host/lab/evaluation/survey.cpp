#include "host/lab/evaluation/survey.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace octoskin::evaluation {
namespace {

void add_orbits(const SurveyPattern& pattern, std::vector<Viewpoint>& viewpoints) {
    const auto& centre = pattern.orbit_centre;
    for (const double height : pattern.orbit_heights_m) {
        for (std::uint32_t i = 0; i < pattern.orbit_azimuths; ++i) {
            const double azimuth = 2.0 * std::numbers::pi * i / pattern.orbit_azimuths;
            viewpoints.push_back({{centre.x() + pattern.orbit_radius_m * std::cos(azimuth),
                                   centre.y() + pattern.orbit_radius_m * std::sin(azimuth), height},
                                  {centre.x(), centre.y(), pattern.orbit_look_at_height_m}});
        }
    }
}

void add_front_row(const SurveyPattern& pattern, std::vector<Viewpoint>& viewpoints) {
    for (const double x : pattern.front_x_m) {
        for (const double y : pattern.front_y_m) {
            for (const double z : pattern.front_z_m) {
                viewpoints.push_back({{x, y, z}, {pattern.front_look_at_x_m, y, z}});
            }
        }
    }
}

void add_top_row(const SurveyPattern& pattern, std::vector<Viewpoint>& viewpoints) {
    for (const double x : pattern.above_x_m) {
        for (const double y : pattern.above_y_m) {
            viewpoints.push_back({{x, y, pattern.above_z_m}, {x, y, pattern.above_look_at_z_m}});
        }
    }
}

/// For each share (0..1), the value at that share of the way from `low` to `high`.
std::vector<double> between(double low, double high, const std::vector<double>& shares) {
    std::vector<double> values;
    values.reserve(shares.size());
    for (const double share : shares) {
        values.push_back(low + share * (high - low));
    }
    return values;
}

}  // namespace

Eigen::Isometry3d T_base_camera_of(const Viewpoint& viewpoint) {
    const Eigen::Vector3d forward = (viewpoint.p_base_look_at - viewpoint.p_base_camera).normalized();
    constexpr double kVertical = 1.0 - 1e-9;
    const Eigen::Vector3d up =
        std::abs(forward.z()) > kVertical ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d right = forward.cross(up).normalized();
    Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
    T_base_camera.linear() << right, forward.cross(right), forward;
    T_base_camera.translation() = viewpoint.p_base_camera;
    return T_base_camera;
}

SurveyPattern SurveyPattern::around(const Eigen::Vector3d& p_base_min, const Eigen::Vector3d& p_base_max) {
    // The shares are those of the experiment's tour in the experiment's region.
    const auto along = [&](int axis, const std::vector<double>& shares) {
        return between(p_base_min[axis], p_base_max[axis], shares);
    };
    const double half_diagonal_m = (p_base_max - p_base_min).head<2>().norm() / 2.0;
    SurveyPattern pattern;
    pattern.orbit_centre = {along(0, {0.6}).front(), along(1, {0.5}).front()};
    pattern.orbit_radius_m = half_diagonal_m + 0.338;
    pattern.orbit_heights_m = along(2, {0.1901, 0.6479, 1.2113});
    pattern.orbit_look_at_height_m = along(2, {0.331}).front();
    pattern.front_x_m = along(0, {0.1, 0.325});
    pattern.front_y_m = along(1, {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875});
    pattern.front_z_m = along(2, {0.1901, 0.5423});
    pattern.front_look_at_x_m = along(0, {0.9}).front();
    pattern.above_x_m = along(0, {0.3, 0.6, 0.9});
    pattern.above_y_m = along(1, {0.5 - 0.5 / 2.4, 0.5 + 0.5 / 2.4});
    pattern.above_z_m = p_base_max.z() + 1.0;
    pattern.above_look_at_z_m = p_base_min.z();
    return pattern;
}

std::vector<Viewpoint> viewpoints_of(const SurveyPattern& pattern) {
    std::vector<Viewpoint> viewpoints;
    add_orbits(pattern, viewpoints);
    add_front_row(pattern, viewpoints);
    add_top_row(pattern, viewpoints);
    return viewpoints;
}

DepthView render_view(const sim::World& world, const rig::Camera& camera,
                      const Eigen::Isometry3d& T_base_camera, std::uint32_t pixel_stride) {
    assert(pixel_stride > 0);
    const LensInverse inverse(camera.lens);
    // With z = 1 in the camera's frame, the length along a ray is the depth along the optical axis.
    std::vector<Eigen::Vector3d> directions_base;
    for (std::uint32_t v = 0; v < camera.height; v += pixel_stride) {
        for (std::uint32_t u = 0; u < camera.width; u += pixel_stride) {
            const auto ray = inverse.ray_of(picture_of(camera, u, v));
            assert(ray.has_value());  // checked where the rig was read
            directions_base.emplace_back(T_base_camera.linear() * Eigen::Vector3d(ray->x, ray->y, 1.0));
        }
    }
    std::vector<double> depth_m(directions_base.size());
    world.cast_fan(T_base_camera.translation(), directions_base, camera.depth_max_m, depth_m);

    DepthView view{T_base_camera.translation(), {}};
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
        if (depth_m[i] >= camera.depth_min_m && depth_m[i] <= camera.depth_max_m) {
            const Eigen::Vector3d p_base = view.p_base_camera + depth_m[i] * directions_base[i];
            view.p_base_points.push_back(p_base.cast<float>());
        }
    }
    return view;
}

Survey render_survey(const sim::World& world, const SurveyConfig& config) {
    Survey survey;
    for (const auto& viewpoint : config.viewpoints) {
        if (world.is_inside(viewpoint.p_base_camera)) {
            continue;
        }
        survey.views.push_back(
            render_view(world, config.camera, T_base_camera_of(viewpoint), config.pixel_stride));
    }
    return survey;
}

}  // namespace octoskin::evaluation
