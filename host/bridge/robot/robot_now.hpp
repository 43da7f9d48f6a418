// Where the robot's links and its body are now, by the newest joint samples that the daemon sends.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "host/core/kinematics/capsule.hpp"
#include "host/core/kinematics/robot_model.hpp"

namespace octoskin::bridge {

class RobotNow {
  public:
    /// The error is a sentence.
    [[nodiscard]] static Result<RobotNow, std::string> of(const RobotFacts& robot);

    /// Positions of a source of the rig, in its order of joints. Another number of them is ignored.
    void take(std::size_t source, const std::vector<double>& position);
    /// True once each source has sent a sample: before, only links that no joint moves have a pose.
    [[nodiscard]] bool is_known() const noexcept;

    /// Pose of a link, of the URDF's root link or of the map's frame, in the map; empty: the link is not
    /// known, or its joints are not yet.
    [[nodiscard]] std::optional<Eigen::Isometry3d> T_map_frame(const std::string& frame) const;
    /// The capsules of the robot's body in the map frame; empty until `is_known()`.
    [[nodiscard]] std::vector<PosedCapsule> body_map() const;

  private:
    RobotNow(const RobotFacts& robot, RobotModel model);
    void update();

    std::string root_link_;
    std::vector<LinkCapsule> body_;
    Eigen::Isometry3d T_map_root_;
    Eigen::Isometry3d T_map_base_;
    RobotModel model_;
    std::vector<std::size_t> first_of_source_;  ///< in position_; one more entry than sources
    std::vector<bool> has_source_;
    std::vector<double> position_;
    std::vector<Eigen::Isometry3d> T_base_link_;
};

}  // namespace octoskin::bridge
