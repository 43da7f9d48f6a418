// The simulated camera of a depth study: frames with time stamps, from one place.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "host/core/depth/depth_frame.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/camera/depth_camera.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::depth_study {

class NoisyCamera {
  public:
    /// The world is cast here, once. The robot is not in it.
    NoisyCamera(const sim::World& world, const rig::Camera& camera, const sim::DepthNoise& noise,
                std::uint64_t seed)
        : camera_(camera), images_(world, camera, noise, seed) {}

    /// The frame's time is that of its index at the camera's rate. It has no camera pose.
    [[nodiscard]] DepthFrame frame(std::uint32_t index) const;

  private:
    rig::Camera camera_;
    sim::DepthCamera images_;
};

/// The first frame at or after a time from the first frame on.
[[nodiscard]] std::uint32_t frame_at(double t_s, double rate_hz) noexcept;

/// T_base_camera on a circle round its place, across the optical axis: 10 cm of radius, one turn in 5 s. The
/// camera looks at one point on that axis, 2 m away.
[[nodiscard]] Eigen::Isometry3d circling(const Eigen::Isometry3d& T_base_camera, double t_s);

}  // namespace octoskin::depth_study
