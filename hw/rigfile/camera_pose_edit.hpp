// Writes poses of cameras into a hand-written rig file, in place of `pose: tf`: comments, order and layout
// are kept.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octoskin::rig {

/// A camera's `pose` that is still to be taken from the static frames of ROS 2.
inline constexpr std::string_view kPoseOfFrames = "tf";

struct CameraPose {
    std::string link = {};  ///< written beside the pose; empty: the file has it, or it is the base link
    Eigen::Isometry3d T_link_camera = Eigen::Isometry3d::Identity();
};

/// The value of `pose` with six digits of a metre and nine of a quaternion, on one line.
[[nodiscard]] std::string pose_text(const Eigen::Isometry3d& T_link_camera);

/// The cameras of this file with `pose: tf`, by their index in the rig. Empty also if the text is not YAML.
[[nodiscard]] std::vector<std::size_t> cameras_with_pose_of_frames(const std::string& text);

/// The text with these poses, by the camera's index, in place of `tf`. Empty if one of the cameras has no
/// `pose: tf` in it.
[[nodiscard]] std::optional<std::string> with_camera_poses(const std::string& text,
                                                           const std::map<std::size_t, CameraPose>& poses);

}  // namespace octoskin::rig
