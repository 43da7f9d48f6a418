// Ranges, frames and problems as messages of ROS 2.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/bridge/robot/robot_facts.hpp"
#include "host/io/watch/watch_frame.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

/// The frame of a sensor's ranges: +x along the sensor's axis, as sensor_msgs/Range requires. `prefix`: of
/// our frames, as "octoskin".
[[nodiscard]] std::string range_frame(const std::string& prefix, const SensorFacts& sensor);

/// A range without a target is +infinity (REP 117).
[[nodiscard]] ros::sensor_msgs::Range range_message(const watch::WatchedRange& range,
                                                    const SensorFacts& sensor,
                                                    const ros::std_msgs::Header& header);

/// The ends of ranges with a target, x, y, z (floats, metres), frame of the map.
[[nodiscard]] ros::sensor_msgs::PointCloud2 points_message(std::span<const watch::WatchedRange> ranges,
                                                           const ros::std_msgs::Header& header);

/// From the URDF's root link to the map, and from each sensor's link to the frame of its ranges. No frame of
/// the robot gets a parent.
[[nodiscard]] ros::tf2_msgs::TFMessage static_frames(const RobotFacts& robot, const std::string& prefix,
                                                     const std::string& map_frame, WallTime stamp);

/// "octoskin_camera", "octoskin_camera_left": the optical frame of a camera.
[[nodiscard]] std::string camera_frame(const std::string& prefix, const CameraFacts& camera);
/// From each camera's link to its optical frame.
[[nodiscard]] std::vector<ros::geometry_msgs::TransformStamped> camera_frames(const RobotFacts& robot,
                                                                              const std::string& prefix,
                                                                              WallTime stamp);

/// The problems of the daemon's status one to one, with their codes; one OK if there is none.
[[nodiscard]] ros::diagnostic_msgs::DiagnosticArray diagnostics(const nlohmann::ordered_json& status,
                                                                WallTime stamp);
/// The same without a status: the daemon does not answer, and why.
[[nodiscard]] ros::diagnostic_msgs::DiagnosticArray diagnostics_without_daemon(const std::string& why,
                                                                               WallTime stamp);

}  // namespace octoskin::bridge
