// The robot's kinematics: joint positions in, the pose of each link out. KDL does the arithmetic and is used
// only in the .cpp.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/core/kinematics/capsule.hpp"
#include "host/core/kinematics/joint_twist.hpp"

namespace octoskin {

enum class JointKind : std::uint8_t { fixed, revolute, continuous, prismatic };

/// Radians, metres for a prismatic joint.
struct JointLimits {
    double min = 0.0;
    double max = 0.0;
    double velocity_max = 0.0;  ///< per second; 0 in a description: not given
    /// True if the position is within the limits or beyond them by at most `tolerance`; false for a NaN.
    [[nodiscard]] bool hold(double position, double tolerance) const noexcept {
        return position >= min - tolerance && position <= max + tolerance;
    }
    /// The movement from one position to another. A continuous joint, without limits, takes the shorter way
    /// round: its sender may wrap it to +-pi.
    [[nodiscard]] double way(double from, double to) const noexcept {
        const double straight = to - from;
        return std::isinf(min) ? std::remainder(straight, 2.0 * std::numbers::pi) : straight;
    }
};

/// A joint that moves with another: position = multiplier * (position of `joint`) + offset, radians or
/// metres.
struct JointMimic {
    std::string joint;  ///< a moved joint
    double multiplier = 1.0;
    double offset = 0.0;
};

/// A joint of a robot description.
struct JointDescription {
    std::string name;
    std::string parent_link;
    std::string child_link;
    JointKind kind = JointKind::fixed;
    Eigen::Isometry3d T_parent_joint = Eigen::Isometry3d::Identity();  ///< of the joint at position 0
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< joint frame, unit length; not for fixed
    JointLimits limits;                               ///< not for fixed and continuous
    std::optional<JointMimic> mimic = {};             ///< it gets no position of its own; not for fixed
};

enum class RobotModelError : std::uint8_t {
    unknown_joint,   ///< a moved joint is not in the description, or is fixed
    repeated_joint,  ///< a joint is listed twice, or two joints have one name
    unmoved_joint,   ///< a joint that moves gets no position
    two_parents,     ///< a link has two parent joints: the description has a loop
    unreachable,     ///< the link is not connected to the base link
    non_unit_axis,
    invalid_number,  ///< NaN, infinity, an invalid rotation, or reversed limits
    bad_mimic,       ///< a joint moves with one that is not in the list of moved joints
    mimic_of_turns,  ///< a joint moves with a continuous one, and a full turn of that one moves it elsewhere
    too_large,       ///< more than 1000 links
};
struct RobotModelFault {
    RobotModelError error;
    std::string element;  ///< name of the joint or link
};

class RobotModel {
  public:
    static constexpr double kRevoluteVelocity = 4.0;   ///< rad/s
    static constexpr double kPrismaticVelocity = 1.0;  ///< m/s

    /// `joints`: in any order. `moved`: the joints that get positions, in the order of all joint vectors. All
    /// links must be below `base_link`. Links are numbered with parents first; the base is link 0.
    [[nodiscard]] static Result<RobotModel, RobotModelFault> build(const std::string& base_link,
                                                                   std::span<const JointDescription> joints,
                                                                   std::span<const std::string> moved);
    RobotModel(const RobotModel&);
    RobotModel(RobotModel&&) noexcept;
    RobotModel& operator=(const RobotModel&);
    RobotModel& operator=(RobotModel&&) noexcept;
    ~RobotModel();

    [[nodiscard]] std::size_t link_count() const noexcept;
    [[nodiscard]] std::size_t joint_count() const noexcept;
    /// By LinkId.
    [[nodiscard]] std::span<const std::string> link_names() const noexcept;
    [[nodiscard]] std::optional<LinkId> find_link(std::string_view name) const noexcept;
    /// Limits of the moved joints, in their order; min and max are infinite for a continuous joint.
    /// `velocity_max` is never 0: it is kRevoluteVelocity or kPrismaticVelocity if the description gives
    /// none.
    [[nodiscard]] std::span<const JointLimits> limits() const noexcept;

    /// T_base_link of every link, by LinkId. `position`: joint_count() radians or metres, finite;
    /// `T_base_link`: link_count() long. Limits are not checked here (JointHistory does). Any thread; no
    /// allocation; about 1 us for a 7-joint arm.
    void forward(std::span<const double> position, std::span<Eigen::Isometry3d> T_base_link) const noexcept;

    /// Twists of `link` for each joint above it, base frame; zero for the other joints. `T_base_link`: the
    /// result of forward(); `twists`: at least joint_count() long. About 20 ns per joint.
    void twists(LinkId link, std::span<const Eigen::Isometry3d> T_base_link,
                std::span<JointTwist> twists) const noexcept;

    /// How much all joints move if one moved joint does: for each moved joint, 1 and the absolute multipliers
    /// of those that mimic it.
    [[nodiscard]] std::span<const double> movements() const noexcept;

    /// The moved joints on the way from the base to a link, of those that mimic one the one.
    [[nodiscard]] JointSet joints_above(LinkId link) const noexcept;

    /// All places that a link can have, if nothing is known of some joints: its origin is within `radius_m`
    /// of `centre`.
    struct Whereabouts {
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< base frame
        double radius_m = 0.0;
    };
    /// `unknown` has a joint above the link (asserted). `T_base_link`: the result of forward() with any
    /// position of the unknown joints. The bound is that of `levers_m`. O(links above), no allocation.
    [[nodiscard]] Whereabouts whereabouts(LinkId link, std::span<const Eigen::Isometry3d> T_base_link,
                                          JointSet unknown) const noexcept;

    /// By LinkId, metres: for all joint positions, the upper bound of the distance from a link's origin to
    /// the axis of any joint that turns it. For a prismatic joint the bound holds up to `farthest`
    /// (joint_count() long) from its zero. The bound is the sum of the lengths between the joints, not the
    /// least possible bound.
    [[nodiscard]] std::vector<double> levers_m(std::span<const double> farthest) const;

  private:
    struct Impl;
    explicit RobotModel(std::unique_ptr<Impl> impl) noexcept;
    std::unique_ptr<Impl> impl_;
};

[[nodiscard]] const char* describe(RobotModelError error) noexcept;

}  // namespace octoskin
