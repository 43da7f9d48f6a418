// A depth image that can be queried for points and rays of the map.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/cross_check/certain_pixels.hpp"
#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

/// Images of one instant, all of the same size.
struct CrossCheckImages {
    const DepthImage& everything;             ///< filtered, with the robot
    const DepthImage& world;                  ///< without the robot
    const std::vector<Certainty>& certainty;  ///< by pixel
};

/// The surface seen in the direction of a point.
struct Look {
    double behind_m = 0.0;  ///< distance behind the point, along the optical axis
    bool is_robot = false;  ///< the surface is the robot
    Certainty certainty = Certainty::none;

    [[nodiscard]] bool is_certain() const noexcept { return certainty != Certainty::none; }
    [[nodiscard]] bool is_clear() const noexcept { return certainty == Certainty::clear; }
};

/// Plane through the surface around a pixel: normal.p + distance_m = 0, in camera coordinates.
struct SeenPlane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< towards the camera
    double distance_m = 0.0;                            ///< from the camera
};

/// What the camera shows along a ray.
struct RayReach {
    /// The ray is certainly in view from here on; nearer, anything may be present.
    double hidden_until_m = 0.0;
    double clear_m = 0.0;  ///< free space from there to here
    /// The ray cannot pass this point: the camera certainly sees a surface there.
    std::optional<double> surface_m;
    /// change of depth along the optical axis per metre of the ray, at the surface
    double depth_per_m = 1.0;
    /// The ray arrives from behind the surface. It ends before the camera's side by a thickness that the
    /// camera does not show.
    bool is_from_behind = false;
};

class CameraView {
  public:
    /// Keeps references. `ray_slope_max`: the lens's polynomial is invalid beyond it.
    CameraView(const CrossCheckImages& images, const CameraIntrinsics& camera,
               const Eigen::Isometry3d& T_map_camera, double ray_slope_max);

    /// The surface in the point's direction; empty outside the image or without a value.
    [[nodiscard]] std::optional<Look> look_at(const Eigen::Vector3d& p_map) const;
    /// The same for a point in camera coordinates.
    [[nodiscard]] std::optional<Look> look_at_camera(const Eigen::Vector3d& p_camera) const;
    /// The plane through the surface within 0.7 degrees of the direction of a point in camera coordinates.
    /// Empty if the pixels are doubtful, show the robot, or are not a plane. Reads 25 pixels.
    [[nodiscard]] std::optional<SeenPlane> plane_at(const Eigen::Vector3d& p_camera) const;
    [[nodiscard]] const Eigen::Isometry3d& T_camera_map() const noexcept { return T_camera_map_; }

    /// True if the ray crosses a surface that the camera sees and continues behind it by more than `bound_m`.
    /// The pixels must be certain on both sides of the surface: the outline of an object does not stop a ray
    /// that passes behind it. At most 134 pixels.
    [[nodiscard]] bool is_stopped(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double range_m, double bound_m) const;

    /// Follows a ray (unit direction) up to `range_max_m`; the steps are longer the further the seen surface
    /// lies behind the ray. About 0.2 us; at most 120 pixels.
    [[nodiscard]] RayReach reach(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                 double range_max_m) const;

  private:
    struct Crossing {
        double along_m;
        double depth_per_m;
    };
    [[nodiscard]] std::optional<Crossing> crossing_at(const Eigen::Vector3d& p_camera,
                                                      const Eigen::Vector3d& direction_camera,
                                                      double crossed_m) const;
    [[nodiscard]] std::optional<std::size_t> pixel_at(const Eigen::Vector3d& p_camera) const;

    const DepthImage& everything_;
    const DepthImage& world_;
    const std::vector<Certainty>& certainty_;
    const CameraIntrinsics& camera_;
    Eigen::Isometry3d T_camera_map_;
    double ray_slope_max_;
};

}  // namespace octoskin
