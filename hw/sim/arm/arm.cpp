#include "hw/sim/arm/arm.hpp"

#include <urdf_model/joint.h>
#include <urdf_model/link.h>
#include <urdf_model/model.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <limits>
#include <set>

#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::sim {
namespace {

constexpr int kInverseStepsMax = 200;
/// Limit of a joint's change in one step of the inverse kinematics: far from the goal the linearisation is
/// inaccurate.
constexpr double kInverseStepMax_rad = 0.2;

Eigen::Isometry3d isometry_of(const urdf::Pose& pose) {
    // urdfdom's quaternion is normalised to its own precision only.
    const Eigen::Quaterniond q(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
    return Eigen::Translation3d(pose.position.x, pose.position.y, pose.position.z) * q.normalized();
}

/// The rotation vector that turns the second orientation into the first, in the frame both are given in.
Eigen::Vector3d rotation_between(const Eigen::Matrix3d& to, const Eigen::Matrix3d& from) {
    const Eigen::AngleAxisd turn(to * from.transpose());
    return turn.angle() * turn.axis();
}

}  // namespace

/// Builds the arm from the URDF, from the base outwards.
struct Arm::Builder {
    const rig::UrdfDocument& urdf;
    const std::vector<std::string>& joints;
    Arm arm = {};
    std::vector<rig::ElementFault> faults = {};

    void build(const std::string& base_link) {
        const auto base = urdf.model().getLink(base_link);
        if (!base) {
            return fail("robot", urdf.model().getName(),
                        {ErrorCode::unknown_name, "has no link '" + base_link + "' to be its base"}, "");
        }
        arm.joints_.assign(joints.size(), Limits{"", 0.0, 0.0});
        arm.links_.push_back({.name = base_link});
        // A link's children follow it in the list, and urdfdom guarantees that there is no loop.
        for (std::size_t i = 0; i < arm.links_.size(); ++i) {
            for (const auto& joint : urdf.model().getLink(arm.links_[i].name)->child_joints) {
                add(*joint, i);
            }
        }
        if (!faults.empty()) {
            return;
        }
        for (std::size_t i = 0; i < joints.size(); ++i) {
            if (arm.joints_[i].joint.empty()) {
                return fail("joint", joints[i],
                            {ErrorCode::unknown_name, "expected a moving joint beyond link '" + base_link +
                                                          "', each named once; there is none of this name"},
                            "");
            }
        }
    }

    /// Adds the link also if the joint is refused, so that errors beyond it are found, too.
    void add(const urdf::Joint& joint, std::size_t parent) {
        Link link{.name = joint.child_link_name, .parent = parent};
        link.T_parent_joint = isometry_of(joint.parent_to_joint_origin_transform);
        link.axis = Eigen::Vector3d(joint.axis.x, joint.axis.y, joint.axis.z);
        const auto motion = motion_of(joint);
        if (!link.T_parent_joint.matrix().allFinite()) {
            fail("joint", joint.name, {ErrorCode::bad_value, "expected an origin of finite numbers"},
                 "its origin");
        } else if (!motion) {
            fail("joint", joint.name,
                 {ErrorCode::unsupported, "expected a fixed, revolute, continuous or prismatic joint"},
                 "of another kind");
        } else {
            link.motion = *motion;
            if (link.motion != Motion::fixed) {
                add_moving(joint, link);
            }
        }
        arm.links_.push_back(std::move(link));
    }

    void add_moving(const urdf::Joint& joint, Link& link) {
        const std::string& name = joint.mimic ? joint.mimic->joint_name : joint.name;
        const auto named = std::find(joints.begin(), joints.end(), name);
        if (named == joints.end()) {
            return fail(
                "joint", joint.name,
                {ErrorCode::missing_key, "moves, but the rig's joint states do not contain its position"},
                "not named");
        }
        const double length = link.axis.norm();
        if (!(std::abs(length - 1.0) <= 1e-6)) {
            return fail("joint", joint.name,
                        {ErrorCode::bad_value, "expected an axis of length 1",
                         "one of length " + std::to_string(length)},
                        "its axis");
        }
        link.axis /= length;
        link.joint = static_cast<std::size_t>(named - joints.begin());
        if (joint.mimic) {
            link.multiplier = joint.mimic->multiplier;
            link.offset = joint.mimic->offset;
            return;
        }
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        const bool is_bounded = joint.limits && joint.type != urdf::Joint::CONTINUOUS;
        arm.joints_[link.joint] = {joint.name, is_bounded ? joint.limits->lower : -kInfinity,
                                   is_bounded ? joint.limits->upper : kInfinity};
    }

    static std::optional<Motion> motion_of(const urdf::Joint& joint) {
        switch (joint.type) {
            case urdf::Joint::FIXED:
                return Motion::fixed;
            case urdf::Joint::REVOLUTE:
            case urdf::Joint::CONTINUOUS:
                return Motion::turning;
            case urdf::Joint::PRISMATIC:
                return Motion::sliding;
            case urdf::Joint::UNKNOWN:
            case urdf::Joint::FLOATING:
            case urdf::Joint::PLANAR:
                break;
        }
        return std::nullopt;
    }

    void fail(const std::string& tag, const std::string& name, Error error, const std::string& kind) {
        faults.push_back({urdf.error(tag, name, std::move(error)), kind});
    }
};

Result<Arm, Error> Arm::read(const FilePlace& urdf, const std::string& base_link,
                             const std::vector<std::string>& joints) {
    const auto document = rig::UrdfDocument::read(urdf);
    if (!document) {
        return unexpected(document.error());
    }
    Builder builder{*document, joints};
    builder.build(base_link);
    if (!builder.faults.empty()) {
        return unexpected(rig::one_error_of(std::move(builder.faults)));
    }
    return std::move(builder.arm);
}

std::optional<std::size_t> Arm::index_of(const std::string& link) const {
    const auto found =
        std::find_if(links_.begin(), links_.end(), [&](const Link& l) { return l.name == link; });
    return found == links_.end() ? std::nullopt
                                 : std::optional(static_cast<std::size_t>(found - links_.begin()));
}

bool Arm::has_link(const std::string& link) const {
    return index_of(link).has_value();
}

Eigen::Isometry3d Arm::T_parent_link(const Link& link, const Eigen::VectorXd& position) {
    if (link.motion == Motion::fixed) return link.T_parent_joint;
    const double q = link.multiplier * position[static_cast<Eigen::Index>(link.joint)] + link.offset;
    if (link.motion == Motion::turning) return link.T_parent_joint * Eigen::AngleAxisd(q, link.axis);
    return link.T_parent_joint * Eigen::Translation3d(q * link.axis);
}

Arm::LinkPoses Arm::forward(const Eigen::VectorXd& position) const {
    assert(static_cast<std::size_t>(position.size()) == joint_count());
    std::vector<Eigen::Isometry3d> T_base_link;
    LinkPoses poses;
    for (const Link& link : links_) {
        T_base_link.push_back(T_base_link.empty() ? Eigen::Isometry3d::Identity()
                                                  : T_base_link[link.parent] * T_parent_link(link, position));
        poses.emplace(link.name, T_base_link.back());
    }
    return poses;
}

Eigen::Isometry3d Arm::forward(const Eigen::VectorXd& position, const std::string& link) const {
    assert(static_cast<std::size_t>(position.size()) == joint_count());
    assert(has_link(link));
    Eigen::Isometry3d T_ancestor_link = Eigen::Isometry3d::Identity();
    for (std::size_t i = *index_of(link); i != 0; i = links_[i].parent) {
        T_ancestor_link = T_parent_link(links_[i], position) * T_ancestor_link;
    }
    return T_ancestor_link;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> Arm::jacobian(std::size_t tip, const Eigen::VectorXd& position,
                                                       Eigen::Isometry3d& T_base_tip) const {
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, position.size());
    jacobian.setZero();
    T_base_tip = forward(position, links_[tip].name);
    // From the tip inwards: T_link_tip grows, T_base_link shrinks.
    Eigen::Isometry3d T_link_tip = Eigen::Isometry3d::Identity();
    for (std::size_t i = tip; i != 0; i = links_[i].parent) {
        const Eigen::Isometry3d T_base_link = T_base_tip * T_link_tip.inverse();
        const Eigen::Vector3d axis = T_base_link.linear() * links_[i].axis;
        const auto column = static_cast<Eigen::Index>(links_[i].joint);
        if (links_[i].motion == Motion::turning) {
            jacobian.block<3, 1>(0, column) +=
                links_[i].multiplier * axis.cross(T_base_tip.translation() - T_base_link.translation());
            jacobian.block<3, 1>(3, column) += links_[i].multiplier * axis;
        } else if (links_[i].motion == Motion::sliding) {
            jacobian.block<3, 1>(0, column) += links_[i].multiplier * axis;
        }
        T_link_tip = T_parent_link(links_[i], position) * T_link_tip;
    }
    return jacobian;
}

std::optional<Eigen::VectorXd> Arm::inverse(const std::string& link, const Eigen::Isometry3d& T_base_link,
                                            const Eigen::VectorXd& start, double tolerance) const {
    assert(static_cast<std::size_t>(start.size()) == joint_count());
    const auto tip = index_of(link);
    Eigen::VectorXd position = start;
    for (int step = 0; tip && step <= kInverseStepsMax; ++step) {
        Eigen::Isometry3d T_base_tip;
        const auto J = jacobian(*tip, position, T_base_tip);
        Eigen::Matrix<double, 6, 1> error;
        error << T_base_link.translation() - T_base_tip.translation(),
            rotation_between(T_base_link.linear(), T_base_tip.linear());
        if (error.head<3>().norm() <= tolerance && error.tail<3>().norm() <= tolerance) {
            return position;
        }
        // The damping decreases with the error, so that the last steps converge as Newton's method.
        const double damping = 0.01 * error.squaredNorm() + 1e-12;
        const Eigen::Matrix<double, 6, 6> JJt =
            J * J.transpose() + damping * Eigen::Matrix<double, 6, 6>::Identity();
        const Eigen::VectorXd turn = J.transpose() * JJt.ldlt().solve(error);
        const double largest = turn.cwiseAbs().maxCoeff();
        position += turn * (largest > kInverseStepMax_rad ? kInverseStepMax_rad / largest : 1.0);
    }
    return std::nullopt;
}

std::vector<std::string> Arm::links() const {
    std::vector<std::string> names;
    for (const Link& link : links_) names.push_back(link.name);
    return names;
}

std::optional<Arm::JointOutside> Arm::joint_outside_limits(const Eigen::VectorXd& position) const {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        const double value = position[static_cast<Eigen::Index>(i)];
        if (!(value >= joints_[i].lower && value <= joints_[i].upper)) {
            return JointOutside{joints_[i].joint, value, joints_[i].lower, joints_[i].upper};
        }
    }
    return std::nullopt;
}

}  // namespace octoskin::sim
