// How much of what can be seen of a rigid group of links lies beside its body: lengths along straight lines.
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

/// A line that something turns about.
struct Axis {
    Eigen::Vector3d p_group = Eigen::Vector3d::Zero();  ///< a point on it
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
};

/// Of a mesh nothing: a recording has the URDF, and not the files that it points to, and an answer must not
/// depend on whether they are there. Of a size that is no finite number neither.
[[nodiscard]] std::optional<VisualBox> visual_box(const urdf::Visual& visual,
                                                  const Eigen::Isometry3d& T_group_link);

/// The shortest line from one axis to the other. Of axes within a degree of parallel it begins at the first
/// one's point.
[[nodiscard]] Stretch between(const Axis& from, const Axis& to);

/// Metres of the box's longest side, of which `length_m()` are all, that have a capsule beside them which
/// reaches into the box. `body`: in the group's frame. O(capsules log capsules).
[[nodiscard]] double covered_m(const VisualBox& box, std::span<const Capsule> body);
/// Metres of the line that have a capsule beside them, however far from it.
[[nodiscard]] double covered_m(const Stretch& stretch, std::span<const Capsule> body);

}  // namespace octoskin::rig
