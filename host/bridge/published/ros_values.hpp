// Times and poses as messages have them.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <string>

#include "common/time.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

/// Whether a message can hold it: seconds of 31 bits, from 1970 to 2038.
[[nodiscard]] constexpr bool is_ros_time(WallTime time) noexcept {
    constexpr std::int64_t kSecond = 1'000'000'000;
    return time.ns >= 0 && time.ns / kSecond <= std::numeric_limits<std::int32_t>::max();
}
/// A time that no message can hold is the nearest that one can.
[[nodiscard]] inline ros::builtin_interfaces::Time ros_time(WallTime time) noexcept {
    constexpr std::int64_t kSecond = 1'000'000'000;
    if (time.ns < 0) return {0, 0};
    if (!is_ros_time(time)) return {std::numeric_limits<std::int32_t>::max(), 999'999'999};
    return {static_cast<std::int32_t>(time.ns / kSecond), static_cast<std::uint32_t>(time.ns % kSecond)};
}
[[nodiscard]] inline WallTime wall_time_of(const ros::builtin_interfaces::Time& time) noexcept {
    constexpr std::int64_t kSecond = 1'000'000'000;
    return {std::int64_t{time.sec} * kSecond + time.nanosec};
}
[[nodiscard]] inline ros::std_msgs::Header ros_header(WallTime time, const std::string& frame) {
    return {ros_time(time), frame};
}
[[nodiscard]] inline ros::geometry_msgs::Point ros_point(const Eigen::Vector3d& p) noexcept {
    return {p.x(), p.y(), p.z()};
}
[[nodiscard]] inline ros::geometry_msgs::Quaternion ros_quaternion(const Eigen::Isometry3d& T) {
    const Eigen::Quaterniond q(T.linear());
    return {q.x(), q.y(), q.z(), q.w()};
}
[[nodiscard]] inline ros::geometry_msgs::Pose ros_pose(const Eigen::Isometry3d& T) {
    return {ros_point(T.translation()), ros_quaternion(T)};
}
[[nodiscard]] inline ros::geometry_msgs::Transform ros_transform(const Eigen::Isometry3d& T) {
    return {{T.translation().x(), T.translation().y(), T.translation().z()}, ros_quaternion(T)};
}

}  // namespace octoskin::bridge
