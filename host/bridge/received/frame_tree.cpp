#include "host/bridge/received/frame_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hw/rigfile/camera_pose_edit.hpp"
#include "hw/rigfile/key_hint.hpp"

namespace octoskin::bridge {

void FrameTree::take(const ros::tf2_msgs::TFMessage& message) {
    for (const ros::geometry_msgs::TransformStamped& one : message.transforms) {
        const auto& [p, q] = one.transform;
        const Eigen::Vector3d translation(p.x, p.y, p.z);
        const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
        constexpr double kUnit = 1e-3;
        if (!translation.allFinite() || !(std::abs(rotation.norm() - 1.0) < kUnit)) continue;
        if (edges_.size() >= kFramesMax && !edges_.contains(one.child_frame_id)) continue;
        Edge edge{.parent = one.header.frame_id};
        edge.T_parent_frame.linear() = rotation.normalized().toRotationMatrix();
        edge.T_parent_frame.translation() = translation;
        edges_[one.child_frame_id] = std::move(edge);
    }
}

std::optional<FrameOnLink> FrameTree::from_link(const std::string& frame,
                                                std::span<const std::string> links) const {
    FrameOnLink found{.link = frame};
    for (std::size_t step = 0; step <= edges_.size(); ++step) {
        if (std::ranges::find(links, found.link) != links.end()) return found;
        const auto edge = edges_.find(found.link);
        if (edge == edges_.end()) return std::nullopt;
        found.T_link_frame = edge->second.T_parent_frame * found.T_link_frame;
        found.link = edge->second.parent;
    }
    return std::nullopt;
}

std::string FrameTree::why(const std::string& frame) const {
    if (edges_.empty()) return "nothing publishes /tf_static";
    std::string top = frame;
    for (std::size_t step = 0; step <= edges_.size(); ++step) {
        const auto edge = edges_.find(top);
        if (edge == edges_.end()) break;
        top = edge->second.parent;
    }
    if (top == frame) return fmt::format("/tf_static has no frame '{}'", frame);
    return fmt::format("the frame '{}' hangs from '{}', which is no link of the rig's robot", frame, top);
}

std::optional<std::string> FrameTree::nearest(const std::string& frame) const {
    std::vector<std::string> frames;
    for (const auto& [child, edge] : edges_) frames.push_back(child);
    return rig::nearest_word(frame, frames);
}

std::string rig_text(const FrameOnLink& pose) {
    return fmt::format("link: \"{}\"\npose: {}\n", pose.link, rig::pose_text(pose.T_link_frame));
}

}  // namespace octoskin::bridge
