#include "host/core/kinematics/robot_model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <kdl/frames.hpp>
#include <kdl/joint.hpp>
#include <kdl/segment.hpp>
#include <limits>
#include <set>
#include <utility>

#include "host/core/kinematics/turned_z.hpp"

namespace octoskin {
namespace {

constexpr std::size_t kLinksMax = 1000;
constexpr double kUnitTolerance = 1e-6;
constexpr std::size_t kNoJoint = std::numeric_limits<std::size_t>::max();

KDL::Frame to_kdl(const Eigen::Isometry3d& T) {
    KDL::Frame frame;
    for (int row = 0; row < 3; ++row) {
        frame.p(row) = T(row, 3);
        for (int column = 0; column < 3; ++column) frame.M(row, column) = T(row, column);
    }
    return frame;
}

void to_eigen(const KDL::Frame& frame, Eigen::Isometry3d& T) {
    for (int row = 0; row < 3; ++row) {
        T(row, 3) = frame.p(row);
        for (int column = 0; column < 3; ++column) T(row, column) = frame.M(row, column);
    }
}

/// The fault in a joint's numbers, if there is one.
std::optional<RobotModelError> fault_of(const JointDescription& joint) {
    const Eigen::Matrix3d rotation = joint.T_parent_joint.linear();
    const double skew = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    const bool is_rigid = joint.T_parent_joint.matrix().allFinite() && skew < kUnitTolerance;
    if (!is_rigid || rotation.determinant() < 0.0) return RobotModelError::invalid_number;
    if (joint.kind == JointKind::fixed) return std::nullopt;
    if (!(std::abs(joint.axis.norm() - 1.0) <= kUnitTolerance)) return RobotModelError::non_unit_axis;
    const bool has_limits = joint.kind != JointKind::continuous;
    const bool are_sound = std::isfinite(joint.limits.min) && std::isfinite(joint.limits.max) &&
                           joint.limits.min <= joint.limits.max;
    if (has_limits && !are_sound) return RobotModelError::invalid_number;
    if (joint.mimic && !(std::isfinite(joint.mimic->multiplier) && std::isfinite(joint.mimic->offset)))
        return RobotModelError::invalid_number;
    return std::nullopt;
}

/// The rotation from z to the joint's axis; the exact identity if the axis is z.
Eigen::Isometry3d align_z(const Eigen::Vector3d& axis) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    if (axis != Eigen::Vector3d::UnitZ()) T.linear() = turned_z(axis.normalized());
    return T;
}

/// A link and its connection to its parent. KDL's joint about an arbitrary axis stores the last angle in a
/// mutable member, which two threads must not share; a joint about z does not. Therefore each joint's axis is
/// rotated to z and back.
struct Link {
    KDL::Frame T_parent_axis;
    KDL::Segment axis_to_link;
    std::size_t parent = 0;
    std::size_t joint = kNoJoint;
    double multiplier = 1.0;  ///< of that joint's position
    double offset = 0.0;      ///< added to it
};

Link make_link(const JointDescription& description, std::size_t parent, std::size_t joint) {
    if (description.kind == JointKind::fixed) {
        return {to_kdl(description.T_parent_joint), KDL::Segment(KDL::Joint(KDL::Joint::Fixed)), parent,
                kNoJoint};
    }
    const Eigen::Isometry3d T_joint_axis = align_z(description.axis.normalized());
    const auto type = description.kind == JointKind::prismatic ? KDL::Joint::TransZ : KDL::Joint::RotZ;
    return {to_kdl(description.T_parent_joint * T_joint_axis),
            KDL::Segment(KDL::Joint(type), to_kdl(T_joint_axis.inverse())),
            parent,
            joint,
            description.mimic ? description.mimic->multiplier : 1.0,
            description.mimic ? description.mimic->offset : 0.0};
}

using Fault = std::optional<RobotModelFault>;

/// Faults of single joints and their names.
Fault find_joint_fault(const std::string& base_link, std::span<const JointDescription> joints) {
    std::set<std::string_view> names;
    std::set<std::string_view> children = {base_link};
    for (const JointDescription& joint : joints) {
        if (!names.insert(joint.name).second)
            return RobotModelFault{RobotModelError::repeated_joint, joint.name};
        if (!children.insert(joint.child_link).second) {
            return RobotModelFault{RobotModelError::two_parents, joint.child_link};
        }
        if (const auto error = fault_of(joint)) return RobotModelFault{*error, joint.name};
    }
    if (children.size() > kLinksMax) return RobotModelFault{RobotModelError::too_large, base_link};
    return std::nullopt;
}

/// A continuous joint's position is known up to full turns: its sender may wrap it. So must be the position
/// of what moves with it.
Fault find_mimic_of_turns(std::span<const JointDescription> joints) {
    std::set<std::string_view> turning;
    for (const JointDescription& joint : joints)
        if (joint.kind == JointKind::continuous) turning.insert(joint.name);
    for (const JointDescription& joint : joints) {
        if (!joint.mimic || !turning.contains(joint.mimic->joint)) continue;
        const bool is_same_after_turn = joint.kind != JointKind::prismatic &&
                                        std::trunc(joint.mimic->multiplier) == joint.mimic->multiplier;
        if (!is_same_after_turn) return RobotModelFault{RobotModelError::mimic_of_turns, joint.name};
    }
    return std::nullopt;
}

/// Faults in the list of moved joints compared with the joints of the description.
Fault find_moved_fault(std::span<const JointDescription> joints, std::span<const std::string> moved) {
    std::set<std::string_view> movable;
    for (const JointDescription& joint : joints) {
        if (joint.kind != JointKind::fixed && !joint.mimic) movable.insert(joint.name);
    }
    for (const JointDescription& joint : joints) {
        if (joint.mimic && !movable.contains(joint.mimic->joint))
            return RobotModelFault{RobotModelError::bad_mimic, joint.name};
    }
    if (auto fault = find_mimic_of_turns(joints)) return fault;
    std::set<std::string_view> seen;
    for (const std::string& name : moved) {
        if (!movable.contains(name)) return RobotModelFault{RobotModelError::unknown_joint, name};
        if (!seen.insert(name).second) return RobotModelFault{RobotModelError::repeated_joint, name};
    }
    for (const auto name : movable) {
        if (!seen.contains(name)) return RobotModelFault{RobotModelError::unmoved_joint, std::string(name)};
    }
    return std::nullopt;
}

}  // namespace

struct RobotModel::Impl {
    std::vector<std::string> names;
    std::vector<Link> links;  ///< link 0, the base, has no joint above it and is not evaluated
    std::vector<JointLimits> limits;
    std::vector<double> movements;  ///< of all joints, for one unit of each moved one

    void add(const JointDescription& description, std::size_t parent, std::span<const std::string> moved) {
        const std::string& name = description.mimic ? description.mimic->joint : description.name;
        const auto at = std::find(moved.begin(), moved.end(), name);
        const auto joint = static_cast<std::size_t>(at - moved.begin());
        names.push_back(description.child_link);
        links.push_back(make_link(description, parent, joint));
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        if (description.kind == JointKind::fixed) return;
        movements[joint] += std::abs(links.back().multiplier);
        if (description.mimic) return;
        limits[joint] = description.limits;
        if (description.kind == JointKind::continuous) {
            limits[joint].min = -kInfinity;
            limits[joint].max = kInfinity;
        }
        const double given = description.limits.velocity_max;
        const bool is_given = std::isfinite(given) && given > 0.0;
        const double usual =
            description.kind == JointKind::prismatic ? kPrismaticVelocity : kRevoluteVelocity;
        limits[joint].velocity_max = is_given ? given : usual;
    }
};

Result<RobotModel, RobotModelFault> RobotModel::build(const std::string& base_link,
                                                      std::span<const JointDescription> joints,
                                                      std::span<const std::string> moved) {
    if (auto fault = find_joint_fault(base_link, joints)) return unexpected(std::move(*fault));
    if (auto fault = find_moved_fault(joints, moved)) return unexpected(std::move(*fault));
    auto impl = std::make_unique<Impl>();
    impl->names.push_back(base_link);
    impl->links.emplace_back();
    impl->limits.resize(moved.size());
    impl->movements.resize(moved.size(), 0.0);
    // Breadth first from the base: each link has one parent and is visited once, so the loop ends.
    for (std::size_t parent = 0; parent < impl->names.size(); ++parent) {
        for (const JointDescription& joint : joints) {
            if (joint.parent_link == impl->names[parent]) impl->add(joint, parent, moved);
        }
    }
    for (const JointDescription& joint : joints) {
        if (std::find(impl->names.begin(), impl->names.end(), joint.child_link) == impl->names.end()) {
            return unexpected(RobotModelFault{RobotModelError::unreachable, joint.child_link});
        }
    }
    return RobotModel(std::move(impl));
}

RobotModel::RobotModel(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
RobotModel::RobotModel(const RobotModel& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
RobotModel::RobotModel(RobotModel&&) noexcept = default;
RobotModel& RobotModel::operator=(const RobotModel& other) {
    impl_ = std::make_unique<Impl>(*other.impl_);
    return *this;
}
RobotModel& RobotModel::operator=(RobotModel&&) noexcept = default;
RobotModel::~RobotModel() = default;

std::size_t RobotModel::link_count() const noexcept {
    return impl_->links.size();
}
std::size_t RobotModel::joint_count() const noexcept {
    return impl_->limits.size();
}
std::span<const std::string> RobotModel::link_names() const noexcept {
    return impl_->names;
}
std::span<const JointLimits> RobotModel::limits() const noexcept {
    return impl_->limits;
}
std::span<const double> RobotModel::movements() const noexcept {
    return impl_->movements;
}

std::optional<LinkId> RobotModel::find_link(std::string_view name) const noexcept {
    const auto found = std::find(impl_->names.begin(), impl_->names.end(), name);
    if (found == impl_->names.end()) return std::nullopt;
    return static_cast<LinkId>(found - impl_->names.begin());
}

void RobotModel::forward(std::span<const double> position,
                         std::span<Eigen::Isometry3d> T_base_link) const noexcept {
    const auto& links = impl_->links;
    assert(position.size() == joint_count() && T_base_link.size() == links.size());
    T_base_link[0].setIdentity();
    for (std::size_t i = 1; i < links.size(); ++i) {
        const Link& link = links[i];
        const double q = link.joint == kNoJoint ? 0.0 : link.multiplier * position[link.joint] + link.offset;
        T_base_link[i].makeAffine();
        to_eigen(to_kdl(T_base_link[link.parent]) * link.T_parent_axis * link.axis_to_link.pose(q),
                 T_base_link[i]);
    }
}

void RobotModel::twists(LinkId link, std::span<const Eigen::Isometry3d> T_base_link,
                        std::span<JointTwist> twists) const noexcept {
    const auto& links = impl_->links;
    assert(T_base_link.size() == links.size() && twists.size() >= joint_count());
    std::ranges::fill(twists, JointTwist{});
    for (std::size_t at = link; at != 0; at = links[at].parent) {
        const Link& moved = links[at];
        if (moved.joint == kNoJoint) continue;
        Eigen::Isometry3d T_base_axis = Eigen::Isometry3d::Identity();
        to_eigen(to_kdl(T_base_link[moved.parent]) * moved.T_parent_axis, T_base_axis);
        const Eigen::Vector3d axis = T_base_axis.linear().col(2);
        const bool shifts = moved.axis_to_link.getJoint().getType() == KDL::Joint::TransZ;
        // A joint and those that mimic it may all be above the link.
        JointTwist& twist = twists[moved.joint];
        if (!shifts) twist.turn += moved.multiplier * axis;
        twist.shift += moved.multiplier * (shifts ? axis : T_base_axis.translation().cross(axis).eval());
    }
}

JointSet RobotModel::joints_above(LinkId link) const noexcept {
    JointSet above = 0;
    for (std::size_t at = link; at != 0; at = impl_->links[at].parent)
        if (impl_->links[at].joint != kNoJoint) above |= JointSet{1} << impl_->links[at].joint;
    return above;
}

RobotModel::Whereabouts RobotModel::whereabouts(LinkId link, std::span<const Eigen::Isometry3d> T_base_link,
                                                JointSet unknown) const noexcept {
    const auto& links = impl_->links;
    Whereabouts found;
    double below_m = 0.0;
    for (std::size_t at = link; at != 0; at = links[at].parent) {
        const Link& moved = links[at];
        if (moved.axis_to_link.getJoint().getType() == KDL::Joint::TransZ) {
            const JointLimits& limits = impl_->limits[moved.joint];
            const double farthest = std::max(std::abs(limits.min), std::abs(limits.max));
            below_m += std::abs(moved.multiplier) * farthest + std::abs(moved.offset);
        }
        if (moved.joint != kNoJoint &&
            (unknown >> moved.joint & 1U) != 0) {  // the last one found is the topmost
            Eigen::Isometry3d T_base_axis = Eigen::Isometry3d::Identity();
            to_eigen(to_kdl(T_base_link[moved.parent]) * moved.T_parent_axis, T_base_axis);
            found = {T_base_axis.translation(), below_m};
        }
        below_m += moved.T_parent_axis.p.Norm();
    }
    return found;
}

std::vector<double> RobotModel::levers_m(std::span<const double> farthest) const {
    const auto& links = impl_->links;
    assert(farthest.size() == joint_count());
    std::vector<double> levers_m(links.size(), 0.0);
    std::vector<bool> are_moved(links.size(), false);
    for (std::size_t i = 1; i < links.size(); ++i) {
        const Link& link = links[i];
        // The part below the first joint is not part of any lever.
        if (are_moved[link.parent]) levers_m[i] = levers_m[link.parent] + link.T_parent_axis.p.Norm();
        are_moved[i] = are_moved[link.parent] || link.joint != kNoJoint;
        if (link.axis_to_link.getJoint().getType() == KDL::Joint::TransZ)
            levers_m[i] += std::abs(link.multiplier) * farthest[link.joint] + std::abs(link.offset);
    }
    return levers_m;
}

const char* describe(RobotModelError error) noexcept {
    switch (error) {
        case RobotModelError::unknown_joint:
            return "expected a moving joint of the robot, found no joint of this name that moves";
        case RobotModelError::repeated_joint:
            return "expected each joint once, found it twice";
        case RobotModelError::unmoved_joint:
            return "a joint that moves but gets no position: add it to the joint names";
        case RobotModelError::two_parents:
            return "has two parent joints: loops are not supported, remove one";
        case RobotModelError::unreachable:
            return "is not connected to the base link";
        case RobotModelError::non_unit_axis:
            return "expected an axis of length 1";
        case RobotModelError::invalid_number:
            return "has a number that is not finite, an invalid rotation, or limits the wrong way round";
        case RobotModelError::bad_mimic:
            return "expected a <mimic> of a joint that moves by itself, below the base link";
        case RobotModelError::mimic_of_turns:
            return "expected a <mimic> of a continuous joint that turns, by a whole multiple: else its "
                   "position depends on how often that joint has turned";
        case RobotModelError::too_large:
            return "expected at most 1000 links";
    }
    return "unknown error";
}

}  // namespace octoskin
