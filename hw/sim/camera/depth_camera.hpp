// The simulated depth camera: depth images of the world with the robot, and noise.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/rigfile/rig.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/camera/depth_noise.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

/// A stationary camera in a static world: the world is cast once, the robot per frame. The lens distortion is
/// that of the rig.
class DepthCamera {
  public:
    /// `camera`: depth_max_m below 65.5 m (asserted). One ray a pixel: about 5 ms for 512 x 424.
    DepthCamera(const World& world, const rig::Camera& camera, const DepthNoise& noise, std::uint64_t seed);

    /// Depth along the optical axis in millimetres, height x width row-major; 0 where no depth between
    /// depth_min_m and depth_max_m is measured. A ray goes through a pixel's centre. `body`: the robot at the
    /// instant of the frame. Noise as in measured_mm(). About 5 ms more than it for 512 x 424.
    [[nodiscard]] std::vector<std::uint16_t> render(const PosedBody& body, std::uint32_t frame_index) const;

  private:
    /// Pixels [u_begin, u_end) x [v_begin, v_end).
    struct Rectangle {
        std::uint32_t u_begin = 0;
        std::uint32_t u_end = 0;
        std::uint32_t v_begin = 0;
        std::uint32_t v_end = 0;
    };

    /// In camera coordinates, z = 1: a ray's length in its own direction is then the depth.
    [[nodiscard]] Eigen::Vector3d direction_camera(std::uint32_t u, std::uint32_t v) const;
    [[nodiscard]] Rectangle bounds_of(const BodyCapsule& capsule_camera) const;
    void draw(const BodyCapsule& capsule_camera, std::vector<double>& depth_m) const;
    void draw(const PosedMesh& mesh_camera, std::vector<double>& depth_m) const;

    rig::Camera camera_;
    std::vector<RaySlope> rays_;  ///< row-major; empty for a pinhole
    DepthNoise noise_;
    std::uint64_t seed_;
    std::vector<double> background_m_;  ///< the world's depth; infinity where there is none
};

}  // namespace octoskin::sim
