#include "host/bridge/mcap/can_messages.hpp"

#include <algorithm>
#include <cassert>

#include "host/bridge/published/ros_values.hpp"

namespace octoskin::bridge {
namespace {

bool is_id(std::uint32_t id, bool is_extended) {
    constexpr unsigned kBits = 11;
    constexpr unsigned kExtendedBits = 29;
    return id >> (is_extended ? kExtendedBits : kBits) == 0;
}

}  // namespace

ros::can_msgs::Frame can_message(const wire::CanFrame& frame, WallTime stamp, const std::string& interface) {
    assert(!frame.is_fd);
    ros::can_msgs::Frame message{.header = ros_header(stamp, interface),
                                 .id = frame.can_id,
                                 .is_rtr = frame.is_remote,
                                 .is_extended = frame.is_extended,
                                 .is_error = frame.is_error,
                                 .dlc = frame.payload_len,
                                 .data = {}};
    std::ranges::copy(frame.payload(), message.data.begin());
    return message;
}

ros::ros2_socketcan_msgs::FdFrame can_fd_message(const wire::CanFrame& frame, WallTime stamp,
                                                 const std::string& interface) {
    assert(frame.is_fd);
    const auto payload = frame.payload();
    return {.header = ros_header(stamp, interface),
            .id = frame.can_id,
            .is_extended = frame.is_extended,
            .is_error = frame.is_error,
            .len = frame.payload_len,
            .data = {payload.begin(), payload.end()}};
}

std::optional<wire::CanFrame> can_frame(const ros::can_msgs::Frame& message) {
    const bool is_frame = message.dlc <= wire::kClassicalPayloadMax && is_id(message.id, message.is_extended);
    if (!is_frame || message.is_error) return std::nullopt;
    wire::CanFrame frame{.can_id = message.id,
                         .is_extended = message.is_extended,
                         .is_remote = message.is_rtr,
                         .payload_len = message.dlc};
    if (!message.is_rtr) std::copy_n(message.data.begin(), message.dlc, frame.data.begin());
    return frame;
}

std::optional<wire::CanFrame> can_frame(const ros::ros2_socketcan_msgs::FdFrame& message) {
    const bool is_frame = wire::is_fd_length(message.len) && message.len == message.data.size() &&
                          is_id(message.id, message.is_extended);
    if (!is_frame || message.is_error) return std::nullopt;
    wire::CanFrame frame{.can_id = message.id,
                         .is_extended = message.is_extended,
                         .is_fd = true,
                         .has_bit_rate_switch = true,
                         .payload_len = message.len};
    std::ranges::copy(message.data, frame.data.begin());
    return frame;
}

}  // namespace octoskin::bridge
