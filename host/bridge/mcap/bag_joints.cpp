#include "host/bridge/mcap/bag_joints.hpp"

#include <utility>

#include "host/bridge/mcap/bag_messages.hpp"
#include "host/bridge/mcap/bag_time.hpp"

namespace octoskin::bridge {
namespace {

std::vector<JointSourceFacts> sources_of(const HostRig& rig) {
    std::vector<JointSourceFacts> sources;
    for (const HostJointSource& source : rig.joint_sources)
        sources.push_back({source.is_local, source.joints});
    return sources;
}

}  // namespace

BagJoints::BagJoints(const HostRig& rig, std::span<const JointLimits> limits)
    : line_(LineJoints::local(rig, limits)), states_(sources_of(rig)) {}

void BagJoints::take(const mcap::Message& message, const BusClock& clock, bool uses_log_time, BagLog& log,
                     TopicAccount& account) {
    if (!states_.has_local_source()) return account.note_rejected(kNotNeeded);  // the bus has them
    auto state = read_as<ros::sensor_msgs::JointState>(message);
    if (!state) return account.note_rejected(state.error());
    const auto stamp = time_of(wall_time_of(state->header.stamp), message.head.logged, uses_log_time);
    if (!stamp || !has_bus_time(clock, *stamp) || !is_ros_time(*stamp))
        return account.note_rejected("stamp_off");
    state->header.stamp = ros_time(*stamp);
    const Arrival arrival{clock.bus_of(*stamp), *stamp};
    const auto text = states_.take(*state, message.head.channel_id, arrival);
    if (!text) return;  // counted there
    const auto line = parse_joints(*text, line_, arrival.monotonic, arrival.monotonic);
    if (!line)
        return account.note_rejected(names_of(line.error()).at(static_cast<std::size_t>(line.error())));
    ++account.used;
    for (const JointSample& sample : line->samples)
        (void)log.add(*stamp, line_.sources.at(sample.source).index, sample.position);
}

void BagJoints::finish(TopicAccount& account) const {
    const JointStateCounts& counts = states_.counts();
    account.note_rejected("other_joints", counts.other_joints);
    account.note_rejected("wrong_size", counts.wrong_size);
    account.note_rejected("not_finite", counts.not_finite);
    account.note_rejected("repeated_name", counts.repeated_name);
    account.note_rejected("partial", counts.partial);
    account.note_rejected("still", counts.still);
    account.note_rejected("too_frequent", counts.too_frequent);
    account.note_rejected("second_sender", counts.second_sender);
}

}  // namespace octoskin::bridge
