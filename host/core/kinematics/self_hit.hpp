// Predicts where a sensor's beam meets the robot's own body.
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
    /// Fails with the link's name if the link of a capsule is not in the model.
    [[nodiscard]] static Result<RobotBody, RobotModelFault> build(std::span<const LinkCapsule> capsules,
                                                                  const RobotModel& model);

    /// The capsules in the base frame, in the order given to build(). `T_base_link`: the result of
    /// RobotModel::forward(). `posed` is reused. About 10 ns per capsule.
    void pose(std::span<const Eigen::Isometry3d> T_base_link, std::vector<PosedCapsule>& posed) const;
    /// The same without the positions of the joints in `unknown`: a capsule below one becomes the ball that
    /// holds it in every position of the joints. `model`: that of build().
    void pose(const RobotModel& model, std::span<const Eigen::Isometry3d> T_base_link, JointSet unknown,
              std::vector<PosedCapsule>& posed) const;

  private:
    std::vector<PosedCapsule> capsules_;  ///< each in its link's frame
};

/// The range in metres at which a beam from `origin` along the unit vector `direction` meets the robot,
/// without the links in `ignored` (those that carry the sensor). 0 if it starts inside a capsule, empty if it
/// meets none. All vectors are in the frame of the capsules. O(capsules), below 50 ns each.
[[nodiscard]] std::optional<double> predict_self_hit(std::span<const PosedCapsule> capsules,
                                                     const Eigen::Vector3d& origin,
                                                     const Eigen::Vector3d& direction,
                                                     std::span<const LinkId> ignored) noexcept;

/// The least range over a bundle of rays (unit vectors) that lie within `half_angle_rad`, below a right
/// angle, of the first one. Capsules outside the bundle's cone cost 10 ns each.
[[nodiscard]] std::optional<double> predict_self_hit(std::span<const PosedCapsule> capsules,
                                                     const Eigen::Vector3d& origin,
                                                     std::span<const Eigen::Vector3d> directions,
                                                     double half_angle_rad,
                                                     std::span<const LinkId> ignored) noexcept;

}  // namespace octoskin
