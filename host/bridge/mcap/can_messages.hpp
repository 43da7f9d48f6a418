// CAN frames as messages of ROS 2 and back: can_msgs/Frame, and CAN FD as ros2_socketcan_msgs/FdFrame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

/// The topics of ros2_socketcan.
inline constexpr const char* kCanTopic = "/from_can_bus";
inline constexpr const char* kCanFdTopic = "/from_can_bus_fd";

/// `frame` is a classical one (asserted). `interface`: becomes the frame id, as in ros2_socketcan.
[[nodiscard]] ros::can_msgs::Frame can_message(const wire::CanFrame& frame, WallTime stamp,
                                               const std::string& interface);
/// `frame` is of CAN FD (asserted). Its bit rate switch has no place in the message.
[[nodiscard]] ros::ros2_socketcan_msgs::FdFrame can_fd_message(const wire::CanFrame& frame, WallTime stamp,
                                                               const std::string& interface);

/// Empty: an error frame, or an identifier or a length that no frame has. A CAN FD frame is taken as one with
/// a bit rate switch.
[[nodiscard]] std::optional<wire::CanFrame> can_frame(const ros::can_msgs::Frame& message);
[[nodiscard]] std::optional<wire::CanFrame> can_frame(const ros::ros2_socketcan_msgs::FdFrame& message);

}  // namespace octoskin::bridge
