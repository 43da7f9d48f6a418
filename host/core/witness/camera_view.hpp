// An image of the depth camera, asked about points and rays of the map.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/witness/certain_pixels.hpp"

namespace octoskin {

/// What the camera sees at one instant. All of its size.
struct WitnessImages {
    const DepthImage& everything;  ///< as it came, filtered: in front of the robot, too, it sees through
    const DepthImage& world;       ///< without the robot
    const std::vector<Certainty>& certainty;  ///< by pixel
};

/// What is in the direction of a point.
struct Look {
    double behind_m = 0.0;  ///< by how much it lies behind the point, along the optical axis
    bool is_robot = false;  ///< it is the robot
    Certainty certainty = Certainty::none;

    [[nodiscard]] bool is_certain() const noexcept { return certainty != Certainty::none; }
    [[nodiscard]] bool is_clear() const noexcept { return certainty == Certainty::clear; }
};

/// What an image shows about a pixel, as a plane: normal.p + distance_m = 0, in camera coordinates.
struct SeenPlane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< towards the camera
    double distance_m = 0.0;                            ///< from the camera
};

/// What the camera knows of a ray.
struct RayReach {
    /// Where the ray comes into view without doubt; nearer there may be anything.
    double hidden_until_m = 0.0;
    double clear_m = 0.0;  ///< from there to here the camera sees through
    /// It cannot go on beyond this: the camera sees a surface there, without doubt.
    std::optional<double> surface_m;
    double depth_per_m = 1.0;  ///< there: how fast it goes through it, along the optical axis
    /// It comes from behind the surface: it ends before the camera's side of it, by a thickness that the
    /// camera does not know.
    bool is_from_behind = false;
};

class CameraView {
  public:
    /// Keeps references. `ray_slope_max`: beyond, the lens's polynomial means nothing.
    CameraView(const WitnessImages& images, const CameraIntrinsics& camera,
               const Eigen::Isometry3d& T_map_camera, double ray_slope_max);

    /// What the camera sees in the point's direction; empty if it does not look there or has no value.
    [[nodiscard]] std::optional<Look> look_at(const Eigen::Vector3d& p_map) const;
    /// The same of a point in camera coordinates.
    [[nodiscard]] std::optional<Look> look_at_camera(const Eigen::Vector3d& p_camera) const;
    /// The plane through what is seen in the direction of a point in camera coordinates and 0.7 degrees about
    /// it; empty where the image leaves doubt, shows the robot, or no plane. Reads 25 pixels.
    [[nodiscard]] std::optional<SeenPlane> plane_at(const Eigen::Vector3d& p_camera) const;
    [[nodiscard]] const Eigen::Isometry3d& T_camera_map() const noexcept { return T_camera_map_; }

    /// Whether the ray goes through a surface that the camera sees, and on behind it by over `bound_m`. It
    /// must be seen without doubt on both sides of the surface: a ray that passes behind an object's outline
    /// is not stopped by it. At most 134 pixels.
    [[nodiscard]] bool is_stopped(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double range_m, double bound_m) const;

    /// Follows a ray (unit direction) for up to `range_max_m`, in longer steps the further what is seen lies
    /// behind it. About 0.2 us; at most 120 pixels.
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
