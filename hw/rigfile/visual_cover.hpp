// The part of a rigid group's visible links that its body covers, as lengths along straight lines.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "hw/rigfile/robot_description.hpp"

namespace urdf {
class Visual;
}

namespace octoskin::rig {

/// The box about a <visual> of known size.
struct VisualBox {
    Eigen::Isometry3d T_group_box = Eigen::Isometry3d::Identity();
    Eigen::Vector3d half_m = Eigen::Vector3d::Zero();  ///< half of its sides

    [[nodiscard]] double length_m() const noexcept { return 2.0 * half_m.maxCoeff(); }
};

/// The line from one axis or joint to the next one.
struct Stretch {
    Eigen::Vector3d p_group_from = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_group_to = Eigen::Vector3d::Zero();

    [[nodiscard]] double length_m() const noexcept { return (p_group_to - p_group_from).norm(); }
};

/// An axis of rotation.
struct Axis {
    Eigen::Vector3d p_group = Eigen::Vector3d::Zero();  ///< a point on it
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
};

/// None for a mesh: a recording contains the URDF but not the files that it names, and an answer must not
/// depend on them. None for a size that is not finite.
[[nodiscard]] std::optional<VisualBox> visual_box(const urdf::Visual& visual,
                                                  const Eigen::Isometry3d& T_group_link);

/// The shortest line from one axis to the other. For axes that are parallel within a degree, it begins at the
/// point of the first.
[[nodiscard]] Stretch between(const Axis& from, const Axis& to);

/// Length of the box's longest side (`length_m()` in total) that is beside a capsule which reaches into the
/// box, metres. `body`: in the group's frame. O(capsules log capsules).
[[nodiscard]] double covered_m(const VisualBox& box, std::span<const Capsule> body);
/// Length of the line that is beside a capsule, at any distance from it, metres.
[[nodiscard]] double covered_m(const Stretch& stretch, std::span<const Capsule> body);

}  // namespace octoskin::rig
