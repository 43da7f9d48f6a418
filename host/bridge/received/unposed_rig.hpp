// A rig whose file leaves poses of cameras to the static frames of ROS 2 (`pose: tf`).
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "host/bridge/received/frame_tree.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/errors/error.hpp"
#include "host/io/urdf/urdf_robot.hpp"
#include "hw/rigfile/camera_pose_edit.hpp"

namespace octoskin::bridge {

/// A camera with `pose: tf`.
struct UnposedCamera {
    std::size_t index = 0;  ///< in the rig
    std::string text;       ///< "camera", "camera 'left'"
    std::string topic;      ///< of its images
    std::string link;       ///< of the URDF, as the rig has it or the base link
    bool has_link = false;  ///< the rig has it
};

class UnposedRig {
  public:
    /// Reads the file and checks all but the poses. Errors: those of read_rig; no camera with `pose: tf` in
    /// this file; such a camera whose device is no topic.
    [[nodiscard]] static Result<UnposedRig, Error> read(const std::filesystem::path& file);

    [[nodiscard]] const std::vector<UnposedCamera>& cameras() const noexcept { return cameras_; }
    /// On which a camera may hang: the base link, those below it, and the root link.
    [[nodiscard]] const std::vector<std::string>& links() const noexcept { return links_; }

    /// The camera's pose on the link that the rig gives it, if that one and the frame's are rigidly
    /// connected. Else on the frame's link, which is written beside the pose; error: conflict, if the rig
    /// gives it another link.
    [[nodiscard]] Result<rig::CameraPose, Error> pose_of(const UnposedCamera& camera,
                                                         const FrameOnLink& frame) const;
    /// The file's text with these poses, in the order of cameras(). Error: the rig is refused with them, as a
    /// pose that is out of reach.
    [[nodiscard]] Result<std::string, Error> text_with(std::span<const rig::CameraPose> poses) const;

  private:
    UnposedRig(std::filesystem::path file, std::string text)
        : file_(std::move(file)), text_(std::move(text)) {}
    void take_robot(RobotFrames frames);
    /// The highest link that no joint moves against this one, and this one's pose on it.
    [[nodiscard]] FrameOnLink carrier_of(const std::string& link) const;

    std::filesystem::path file_;
    std::string text_;
    std::vector<UnposedCamera> cameras_;
    std::vector<std::string> links_;
    std::vector<JointDescription> joints_;  ///< from the root link on
};

}  // namespace octoskin::bridge
