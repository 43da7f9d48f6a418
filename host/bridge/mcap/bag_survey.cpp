#include "host/bridge/mcap/bag_survey.hpp"

#include <algorithm>

#include "common/wire/frame_type.hpp"
#include "host/bridge/mcap/bag_messages.hpp"
#include "host/bridge/mcap/bag_time.hpp"
#include "host/bridge/mcap/can_messages.hpp"
#include "host/bridge/received/depth_image.hpp"

namespace octoskin::bridge {
namespace {

template <cdr::Message M>
Result<wire::CanFrame, const char*> frame_as(const mcap::Message& message) {
    const auto read = read_as<M>(message);
    if (!read) return unexpected(read.error());
    const auto frame = can_frame(*read);
    if (!frame) return unexpected("bad_frame");
    return *frame;
}

void take_frame(const mcap::Message& message, BusClockSearch& search, BagSurvey& survey) {
    const auto frame = frame_of(message);
    if (!frame) return;
    survey.has_can = true;
    search.take(*frame, message.head.logged);
    if (!frame->is_extended && wire::type_of(frame->can_id) == wire::FrameType::joint_state)
        survey.joint_nodes.insert(wire::node_of(frame->can_id));
}

void take_info(const mcap::Message& message, const BagTopics& topics, BagSurvey& survey) {
    for (const std::string& images : topics.images) {
        if (message.channel->topic != info_topic(images) || survey.infos.contains(images)) continue;
        if (auto info = read_as<ros::sensor_msgs::CameraInfo>(message))
            survey.infos.emplace(images, std::move(info).value());
    }
}

}  // namespace

bool BagTopics::is_can(const std::string& topic) const {
    return std::ranges::find(can, topic) != can.end();
}

Result<wire::CanFrame, const char*> frame_of(const mcap::Message& message) {
    return is_of(message, ros::can_msgs::Frame::kType) ? frame_as<ros::can_msgs::Frame>(message)
                                                       : frame_as<ros::ros2_socketcan_msgs::FdFrame>(message);
}

Result<BagSurvey, Error> survey_bag(mcap::McapReader& reader, const BagTopics& topics, const HostRig& rig) {
    BagSurvey survey;
    BusClockSearch search(rig);
    FirstOfMost first;
    for (;;) {
        const auto message = reader.next();
        if (!message) return unexpected(message.error());
        if (!*message) break;
        if (!is_log_time((*message)->head.logged)) continue;  // counted by the import
        first.take((*message)->head.logged);
        if (topics.is_can((*message)->channel->topic)) take_frame(**message, search, survey);
        take_info(**message, topics, survey);
    }
    for (const auto& [id, channel] : reader.channels()) survey.topics.insert(channel.topic);
    survey.needs_can = std::ranges::any_of(rig.nodes, [](const auto& node) { return !node.sensors.empty(); });
    survey.clock = search.clock();
    survey.first = first.first();
    return survey;
}

}  // namespace octoskin::bridge
