// An <origin> of the URDF as a transform.
#pragma once

#include <urdf_model/pose.h>

#include <Eigen/Geometry>

namespace octoskin::rig {

/// T_parent_child of a pose of the child in its parent.
[[nodiscard]] inline Eigen::Isometry3d urdf_isometry(const urdf::Pose& pose) {
    Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
    T_parent_child.linear() =
        Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z)
            .toRotationMatrix();
    T_parent_child.translation() << pose.position.x, pose.position.y, pose.position.z;
    return T_parent_child;
}

}  // namespace octoskin::rig
