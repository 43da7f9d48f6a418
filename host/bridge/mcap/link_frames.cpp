#include "host/bridge/mcap/link_frames.hpp"

#include "host/bridge/published/ros_values.hpp"

namespace octoskin::bridge {

std::vector<ros::geometry_msgs::TransformStamped> fixed_links(const RobotFacts& robot, WallTime stamp) {
    std::vector<ros::geometry_msgs::TransformStamped> frames;
    if (robot.root_link != robot.base_link)
        frames.push_back(
            {ros_header(stamp, robot.root_link), robot.base_link, ros_transform(robot.T_root_base)});
    for (const JointDescription& joint : robot.joints)
        if (joint.kind == JointKind::fixed)
            frames.push_back({ros_header(stamp, joint.parent_link), joint.child_link,
                              ros_transform(joint.T_parent_joint)});
    return frames;
}

ros::tf2_msgs::TFMessage moved_links(const RobotFacts& robot, const RobotNow& now, WallTime stamp) {
    ros::tf2_msgs::TFMessage message;
    for (const JointDescription& joint : robot.joints) {
        if (joint.kind == JointKind::fixed) continue;
        const auto T_map_parent = now.T_map_frame(joint.parent_link);
        const auto T_map_child = now.T_map_frame(joint.child_link);
        if (!T_map_parent || !T_map_child) continue;
        message.transforms.push_back({ros_header(stamp, joint.parent_link), joint.child_link,
                                      ros_transform(T_map_parent->inverse() * *T_map_child)});
    }
    return message;
}

}  // namespace octoskin::bridge
