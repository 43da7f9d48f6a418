// The simulated arm: its own forward kinematics, tested against the host's KDL chain and the reverse, and
// inverse kinematics for the scripted motion.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::sim {

class Arm {
  public:
    /// The part of the robot that `base_link` carries. `joints`: its moving joints in the order of every
    /// joint vector. Errors name file and element: the URDF cannot be read; no such base link; a named joint
    /// is missing, named twice, fixed, or neither revolute nor prismatic; a moving joint is not named.
    [[nodiscard]] static Result<Arm, Error> read(const FilePlace& urdf, const std::string& base_link,
                                                 const std::vector<std::string>& joints);

    [[nodiscard]] std::size_t joint_count() const noexcept { return joints_.size(); }
    [[nodiscard]] bool has_link(const std::string& link) const;

    using LinkPoses = std::map<std::string, Eigen::Isometry3d>;
    /// T_base_link of every link. `position`: joint_count() values, radians (metres for a sliding joint).
    /// About 2 us for seven joints.
    [[nodiscard]] LinkPoses forward(const Eigen::VectorXd& position) const;
    /// As forward(), for one link only, which must exist (asserted). < 1 us.
    [[nodiscard]] Eigen::Isometry3d forward(const Eigen::VectorXd& position, const std::string& link) const;

    /// Joint positions that bring `link` to `T_base_link`, from `start`; damped least squares. Empty if it
    /// does not get within `tolerance` (m and rad) in 200 steps, or if there is no such link. Ignores joint
    /// limits: see joint_outside_limits().
    [[nodiscard]] std::optional<Eigen::VectorXd> inverse(const std::string& link,
                                                         const Eigen::Isometry3d& T_base_link,
                                                         const Eigen::VectorXd& start,
                                                         double tolerance = 2e-7) const;

    /// Every link, parents before children.
    [[nodiscard]] std::vector<std::string> links() const;

    /// A joint beyond its limits in the URDF, radians (metres for a sliding joint).
    struct JointOutside {
        std::string joint;
        double position;
        double lower;
        double upper;
    };
    /// The first joint outside its limits; empty if all are within.
    [[nodiscard]] std::optional<JointOutside> joint_outside_limits(const Eigen::VectorXd& position) const;

  private:
    enum class Motion { fixed, turning, sliding };
    /// A link and the joint that carries it. Parents come before children.
    struct Link {
        std::string name;
        std::size_t parent = 0;  ///< index into links_; the base is its own
        Motion motion = Motion::fixed;
        Eigen::Isometry3d T_parent_joint = Eigen::Isometry3d::Identity();
        Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
        std::size_t joint = 0;    ///< index into the joint vector, if it moves
        double multiplier = 1.0;  ///< a <mimic>'s: of that joint's position
        double offset = 0.0;      ///< likewise: added to it
    };
    struct Limits {
        std::string joint;
        double lower;
        double upper;
    };
    struct Builder;

    [[nodiscard]] std::optional<std::size_t> index_of(const std::string& link) const;
    [[nodiscard]] static Eigen::Isometry3d T_parent_link(const Link& link, const Eigen::VectorXd& position);
    /// d(position, rotation of `tip`) / d(joint), base frame, 6 x joint_count(), and where the tip is.
    [[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(std::size_t tip,
                                                                    const Eigen::VectorXd& position,
                                                                    Eigen::Isometry3d& T_base_tip) const;

    std::vector<Link> links_;
    std::vector<Limits> joints_;
};

}  // namespace octoskin::sim
