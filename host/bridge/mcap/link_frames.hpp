// The robot's links as transforms: what robot_state_publisher would publish.
#pragma once

#include <optional>
#include <vector>

#include "host/bridge/robot/robot_facts.hpp"
#include "host/bridge/robot/robot_now.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

/// From the URDF's root link to the base link, if these are two, and across each fixed joint below it.
[[nodiscard]] std::vector<ros::geometry_msgs::TransformStamped> fixed_links(const RobotFacts& robot,
                                                                            WallTime stamp);
/// Across each joint that moves, below the base link; of those whose links have a pose.
[[nodiscard]] ros::tf2_msgs::TFMessage moved_links(const RobotFacts& robot, const RobotNow& now,
                                                   WallTime stamp);

}  // namespace octoskin::bridge
