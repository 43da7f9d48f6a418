// A robot whose true body are meshes, seen by the simulated camera, while the host has the capsules fitted to
// them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/core/depth/pixel_rays.hpp"
#include "host/core/kinematics/self_hit.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "host/io/robot/surface_reader.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin {

class MeshRobot {
  public:
    /// Fits the robot. The camera is that of the experiment. Fails the test if the robot cannot be read.
    MeshRobot(const RobotText& robot, const MeshSearch& search, const sim::World& world);

    /// Where the robot is at a time: each joint swings, and the fastest point of the meshes moves at 1 m/s on
    /// average over its fastest frame.
    [[nodiscard]] Eigen::VectorXd joints_at(double time_s) const;

    struct Pixels {
        std::size_t of_robot = 0;         ///< pixels of a noise-free image that see the robot
        std::size_t robot_left = 0;       ///< of those, not removed
        std::size_t of_scene = 0;         ///< all others with a depth
        std::size_t scene_removed = 0;    ///< of those, removed
        std::size_t beyond_margin = 0;    ///< of those, further from the mesh than the margin
        double farthest_removed_m = 0.0;  ///< distance from the mesh of a scene pixel that was removed
    };
    /// Removes the robot from noise-free images. The host takes the joints of `late_s` earlier.
    [[nodiscard]] Pixels filter(int frames, double late_s) const;

    /// Of voxels that only the robot's pixels can have made occupied: how many frames one of them stayed so,
    /// at most, with noise. 0: there is none.
    [[nodiscard]] std::size_t frames_occupied(int frames, double late_s, const MappingConfig& mapping) const;

    [[nodiscard]] const rig::Rig& rig() const noexcept { return rig_; }
    [[nodiscard]] std::size_t capsule_count() const noexcept { return setup_.rig.body.size(); }

  private:
    [[nodiscard]] std::vector<PosedCapsule> capsules_at(const Eigen::VectorXd& joints) const;
    [[nodiscard]] double fastest_mps(double time_s) const;
    [[nodiscard]] double distance_to_mesh(const sim::PosedBody& body, const Eigen::Vector3d& p_base,
                                          double most_m) const;

    rig::Rig rig_;
    std::vector<LinkSurface> surfaces_;
    sim::Arm arm_;
    sim::Body truth_;
    HostSetup setup_;
    RobotBody capsules_;
    const sim::World& world_;
    Eigen::VectorXd middle_;
    Eigen::VectorXd swing_;
    double rate_ = 1.0;  ///< of the swing, radians a second
};

}  // namespace octoskin
