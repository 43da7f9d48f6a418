// Static transforms of ROS 2, and the pose of a frame on the robot's links.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "ros_messages.hpp"

namespace octoskin::bridge {

struct FrameOnLink {
    std::string link;
    Eigen::Isometry3d T_link_frame = Eigen::Isometry3d::Identity();
};

class FrameTree {
  public:
    static constexpr std::size_t kFramesMax = 10'000;

    /// A frame that comes again has its newest parent. Transforms that are not finite are left out.
    void take(const ros::tf2_msgs::TFMessage& message);
    /// The pose on the nearest link above the frame; empty if none is known. A loop ends the search.
    [[nodiscard]] std::optional<FrameOnLink> from_link(const std::string& frame,
                                                       std::span<const std::string> links) const;
    /// Why `from_link` is empty, in words.
    [[nodiscard]] std::string why(const std::string& frame) const;
    /// A known frame that differs from this name by a typing error. O(frames).
    [[nodiscard]] std::optional<std::string> nearest(const std::string& frame) const;

  private:
    struct Edge {
        std::string parent;
        Eigen::Isometry3d T_parent_frame = Eigen::Isometry3d::Identity();
    };
    std::map<std::string, Edge> edges_;
};

/// "link: ...", "pose: ..." of a camera in a rig file, two lines.
[[nodiscard]] std::string rig_text(const FrameOnLink& pose);

}  // namespace octoskin::bridge
