#include "host/io/urdf/urdf_robot.hpp"

#include <fmt/format.h>
#include <urdf_model/joint.h>
#include <urdf_model/link.h>
#include <urdf_model/model.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin {
namespace {

std::optional<JointKind> kind_of(const urdf::Joint& joint) {
    switch (joint.type) {
        case urdf::Joint::FIXED:
            return JointKind::fixed;
        case urdf::Joint::REVOLUTE:
            return JointKind::revolute;
        case urdf::Joint::CONTINUOUS:
            return JointKind::continuous;
        case urdf::Joint::PRISMATIC:
            return JointKind::prismatic;
        case urdf::Joint::FLOATING:
        case urdf::Joint::PLANAR:
        case urdf::Joint::UNKNOWN:
            break;
    }
    return std::nullopt;
}

/// The kinematics refuse such an axis, too; but here the text of the file is known.
std::optional<Error> axis_fault_of(const urdf::Vector3& axis) {
    constexpr double kUnitTolerance = 1e-6;
    const double length = std::hypot(axis.x, axis.y, axis.z);
    if (std::abs(length - 1.0) <= kUnitTolerance) return std::nullopt;
    Error error{ErrorCode::bad_value, "expected an axis of length 1",
                fmt::format("<axis xyz=\"{} {} {}\">", axis.x, axis.y, axis.z)};
    // Also true for a NaN.
    if (!(length > 0.0) || !std::isfinite(length)) return error;
    error.value += fmt::format(" of length {:.4g}", length);
    error.remedy = fmt::format("scale it to \"{:.6g} {:.6g} {:.6g}\"", axis.x / length, axis.y / length,
                               axis.z / length);
    return error;
}

const char* name_of_other(const urdf::Joint& joint) {
    if (joint.type == urdf::Joint::FLOATING) return "floating";
    return joint.type == urdf::Joint::PLANAR ? "planar" : "of an unknown type";
}

/// Why a joint cannot be used, also in short; empty if it can.
struct Refusal {
    Error error;
    std::string kind;
};

std::optional<Refusal> refusal_of(const rig::UrdfDocument& document, const urdf::Joint& joint) {
    const auto kind = kind_of(joint);
    if (!kind) {
        return Refusal{{ErrorCode::unsupported, "expected a fixed, revolute, continuous or prismatic joint",
                        "another kind", "make it type=\"fixed\""},
                       name_of_other(joint)};
    }
    if (*kind == JointKind::fixed) return std::nullopt;  // a <mimic> on a fixed joint has no effect
    const bool needs_limits = *kind == JointKind::revolute || *kind == JointKind::prismatic;
    if (needs_limits && !joint.limits)
        return Refusal{{ErrorCode::missing_key, "expected <limit>, found none"}, "no limit"};
    if (needs_limits && document.is_upper_missing(joint.name)) {
        return Refusal{{ErrorCode::missing_key, "expected <limit> with lower and upper",
                        "no upper, which URDF treats as 0", "write it"},
                       "no upper limit"};
    }
    auto error = axis_fault_of(joint.axis);
    return error ? std::optional(Refusal{*std::move(error), "its axis"}) : std::nullopt;
}

Eigen::Isometry3d origin_of(const urdf::Joint& joint) {
    const urdf::Pose& origin = joint.parent_to_joint_origin_transform;
    const Eigen::Quaterniond rotation(origin.rotation.w, origin.rotation.x, origin.rotation.y,
                                      origin.rotation.z);
    Eigen::Isometry3d T_parent_joint = Eigen::Isometry3d::Identity();
    T_parent_joint.linear() = rotation.toRotationMatrix();
    T_parent_joint.translation() << origin.position.x, origin.position.y, origin.position.z;
    return T_parent_joint;
}

JointDescription to_description(const urdf::Joint& joint) {
    JointDescription description;
    description.name = joint.name;
    description.parent_link = joint.parent_link_name;
    description.child_link = joint.child_link_name;
    description.kind = *kind_of(joint);
    description.T_parent_joint = origin_of(joint);
    description.axis << joint.axis.x, joint.axis.y, joint.axis.z;
    if (joint.limits) description.limits = {joint.limits->lower, joint.limits->upper, joint.limits->velocity};
    const bool is_fixed = description.kind == JointKind::fixed;  // then a <mimic> has no effect
    if (joint.mimic && !is_fixed)
        description.mimic = {joint.mimic->joint_name, joint.mimic->multiplier, joint.mimic->offset};
    return description;
}

/// The joints below `base`, breadth first. urdfdom has checked that they form a tree, so each appears once.
Result<std::vector<JointDescription>, Error> joints_below(const rig::UrdfDocument& document,
                                                          const urdf::Link& base) {
    std::vector<JointDescription> descriptions;
    std::vector<rig::ElementFault> faults;
    std::vector<const urdf::Link*> links = {&base};
    for (std::size_t i = 0; i < links.size(); ++i) {
        const urdf::Link& link = *links[i];
        for (const auto& joint : link.child_joints) {
            if (auto refusal = refusal_of(document, *joint)) {
                faults.push_back({document.error("joint", joint->name, std::move(refusal->error)),
                                  std::move(refusal->kind)});
            } else {
                descriptions.push_back(to_description(*joint));
            }
        }
        for (const auto& child : link.child_links) links.push_back(child.get());
    }
    if (!faults.empty()) return unexpected(rig::one_error_of(std::move(faults)));
    return descriptions;
}

Unexpected<Error> no_base_link(const rig::UrdfDocument& document, const std::string& base_link) {
    return unexpected(
        document.error("link", base_link,
                       {ErrorCode::unknown_name, "expected this base link, found no link with its name"}));
}

}  // namespace

Result<RobotModel, Error> read_robot_model(const FilePlace& urdf, const std::string& base_link,
                                           std::span<const std::string> moved) {
    const auto document = rig::UrdfDocument::read(urdf);
    if (!document) return unexpected(document.error());
    const auto base = document->model().getLink(base_link);
    if (!base) return no_base_link(*document, base_link);
    const auto joints = joints_below(*document, *base);
    if (!joints) return unexpected(joints.error());
    auto model = RobotModel::build(base_link, *joints, moved);
    if (!model) {
        const RobotModelFault& fault = model.error();
        const bool is_link =
            fault.error == RobotModelError::two_parents || fault.error == RobotModelError::unreachable;
        return unexpected(document->error(is_link ? "link" : "joint", fault.element,
                                          {ErrorCode::bad_value, describe(fault.error)}));
    }
    return std::move(model).value();
}

Result<RobotFrames, Error> read_robot_frames(const FilePlace& urdf, const std::string& base_link) {
    const auto document = rig::UrdfDocument::read(urdf);
    if (!document) return unexpected(document.error());
    urdf::LinkConstSharedPtr at = document->model().getLink(base_link);
    if (!at) return no_base_link(*document, base_link);
    auto joints = joints_below(*document, *at);
    if (!joints) return unexpected(joints.error());
    RobotFrames frames;
    frames.base_link = base_link;
    frames.joints = std::move(joints).value();
    frames.links = document->link_names();
    while (at->parent_joint && at->parent_joint->type == urdf::Joint::FIXED) {
        frames.T_root_base = origin_of(*at->parent_joint) * frames.T_root_base;
        at = at->getParent();
    }
    frames.root_link = at->name;
    return frames;
}

}  // namespace octoskin
