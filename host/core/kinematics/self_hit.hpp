// Where a sensor's beam meets the robot's own body.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// The robot's body: capsules on links of a model.
class RobotBody {
  public:
    /// Refuses, by name, a capsule whose link is not in the model.
    [[nodiscard]] static Result<RobotBody, RobotModelFault> build(std::span<const LinkCapsule> capsules,
                                                                  const RobotModel& model);

    /// The capsules in the base frame, in the order given to build(). `T_base_link`: what
    /// RobotModel::forward() gave. `posed` is reused. About 10 ns a capsule.
    void pose(std::span<const Eigen::Isometry3d> T_base_link, std::vector<PosedCapsule>& posed) const;

  private:
    std::vector<PosedCapsule> capsules_;  ///< each in its link's frame
};

/// The range in metres at which a beam from `origin` along the unit vector `direction` would meet the robot,
/// links in `ignored` left out (they hold the sensor itself); 0 if it starts inside, empty if it meets none.
/// All in the frame of the capsules. O(capsules), below 50 ns each.
[[nodiscard]] std::optional<double> predict_self_hit(std::span<const PosedCapsule> capsules,
                                                     const Eigen::Vector3d& origin,
                                                     const Eigen::Vector3d& direction,
                                                     std::span<const LinkId> ignored) noexcept;

/// The least of that over a bundle of rays (unit vectors) within `half_angle_rad`, less than a right angle,
/// of the first of them. Capsules that the bundle's cone does not meet cost 10 ns each.
[[nodiscard]] std::optional<double> predict_self_hit(std::span<const PosedCapsule> capsules,
                                                     const Eigen::Vector3d& origin,
                                                     std::span<const Eigen::Vector3d> directions,
                                                     double half_angle_rad,
                                                     std::span<const LinkId> ignored) noexcept;

}  // namespace octoskin
