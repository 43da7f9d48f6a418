// What the bridge says of itself: its status and its problems.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "host/apps/daemon/clocks.hpp"
#include "host/bridge/bridge/bridge.hpp"
#include "host/bridge/bridge/stamp_text.hpp"

namespace octoskin::bridge {
namespace {

using Json = nlohmann::ordered_json;

constexpr Nanoseconds kQuietMax{10'000'000'000};
/// An image of 640 x 480 and some fragments more.
constexpr std::uint64_t kReceiveBuffer = 2'000'000;

std::uint64_t receive_buffer_max() {
    std::uint64_t bytes = 0;
    std::ifstream("/proc/sys/net/core/rmem_max") >> bytes;
    return bytes;
}

Json outlet_json(const Outlet& outlet) {
    return {{"topic", outlet.topic()},
            {"readers", outlet.readers()},
            {"sent", outlet.sent()},
            {"refused", outlet.refused()}};
}

Json joints_json(const JointStateCounts& counts) {
    return {{"received", counts.received},
            {"forwarded", counts.forwarded},
            {"unsent", counts.unsent},
            {"other_joints", counts.other_joints},
            {"malformed", counts.malformed},
            {"wrong_size", counts.wrong_size},
            {"not_finite", counts.not_finite},
            {"repeated_name", counts.repeated_name},
            {"partial", counts.partial},
            {"ahead", counts.ahead},
            {"behind", counts.behind},
            {"still", counts.still},
            {"too_frequent", counts.too_frequent},
            {"second_sender", counts.second_sender}};
}

Json camera_json(const ImageInlet& camera) {
    const ImageCounts counts = camera.counts();
    const FrameSenderRecord sender = camera.sender();
    return {{"name", camera.camera().name},
            {"topic", camera.topic()},
            {"publishers", camera.publishers()},
            {"received", counts.received},
            {"forwarded", counts.forwarded},
            {"sent", sender.sent},
            {"displaced", sender.displaced},
            {"lost", counts.lost},
            {"malformed", counts.malformed},
            {"encoding", counts.encoding},
            {"wrong_size", counts.wrong_size},
            {"short_data", counts.short_data},
            {"no_camera_info", counts.no_camera_info},
            {"ahead", counts.ahead},
            {"behind", counts.behind},
            {"still", counts.still},
            {"second_sender", counts.second_sender},
            {"connected", sender.is_connected},
            {"why", sender.why}};
}

}  // namespace

std::uint32_t Bridge::matched_topics() const {
    std::uint32_t matched = 0;
    for (const auto& outlets : {map_.outlets(), sensors_.outlets()})
        for (const Outlet* const outlet : outlets) matched += outlet->readers() > 0 ? 1U : 0U;
    return matched;
}

std::vector<std::string> Bridge::problems() const {
    std::vector<std::string> problems;
    const bool is_late = monotonic_now() - begun_ > kQuietMax;
    if (!lost_.empty()) problems.push_back("no daemon: " + lost_);
    if (is_late && others_ == 0)
        problems.push_back(fmt::format(
            "no other ROS 2 program is found ({}): ROS_DOMAIN_ID and ROS_AUTOMATIC_DISCOVERY_RANGE have to "
            "be the "
            "same on both sides, and the network must let multicast pass (or set ROS_STATIC_PEERS)",
            network_.description));
    for (const std::string& name : interfaces_)
        if (!interfaces_now_.contains(name))
            problems.push_back("the network interface " + name +
                               " is down or has no carrier: other machines are not reached");
    if (has_clock_topic_)
        problems.push_back(
            "/clock is published: simulated time is not supported, stamps are of the wall clock");
    for (std::string& problem : joint_problems()) problems.push_back(std::move(problem));
    if (robot_ && robot_->has_link(options_.topics.map_frame))
        problems.push_back(
            fmt::format("--map-frame {} is a link of the robot: name another frame; /tf_static is not "
                        "published",
                        options_.topics.map_frame));
    if (!description_problem_.empty()) problems.push_back(description_problem_);
    if (!unplaced_.empty())
        problems.push_back(fmt::format(
            "an object of the planner is in the frame '{}', which the robot does not have: it is not left "
            "out of the map; if this is the planner's name of {}, give --planning-frame {}",
            unplaced_.front().substr(0, 64), robot_ ? robot_->root_link : "",
            unplaced_.front().substr(0, 64)));
    if (map_.objects_left_in() > 0)
        problems.push_back("an object of the planner is too large to be left out of the map");
    if (!cameras_.empty() && receive_buffer_max() < kReceiveBuffer)
        problems.push_back(
            fmt::format("net.core.rmem_max is {}: images may be lost; set it to 4194304 with sysctl",
                        receive_buffer_max()));
    for (const auto& camera : cameras_)
        for (std::string& problem : camera->problems(monotonic_now())) problems.push_back(std::move(problem));
    return problems;
}

std::vector<std::string> Bridge::joint_problems() const {
    using C = JointStateCounts;
    const auto lately = [this](std::uint64_t C::*counter) { return joints_lately_.gained(counter); };
    const std::string& topic = joint_topic_.topic();
    std::vector<std::string> problems;
    const auto add = [&problems](std::string text) { problems.push_back(std::move(text)); };
    if (!joint_topic_.other_type().empty())
        add(fmt::format("{} has messages of type {}, not sensor_msgs/JointState", topic,
                        joint_topic_.other_type()));
    const std::uint64_t received = lately(&C::received);
    if (!joint_states_.has_local_source()) {
        if (received > 0)
            add(fmt::format(
                "joint states of {} are not used: the daemon takes none from this machine: start it with "
                "--joints {}",
                topic, options_.joints.string()));
        return problems;
    }
    if (joint_topic_.publishers() == 0 && joints_lately_.is_full() && lost_.empty())
        add(fmt::format(
            "nothing publishes {}: start the robot's driver (joint_state_broadcaster), or name the topic "
            "with --joint-states",
            topic));
    const std::uint64_t forwarded = lately(&C::forwarded);
    if (forwarded == 0 && lately(&C::partial) > 0)
        add(fmt::format(
            "{} lacks the joints {}: publish them in the same message, or give each publisher a source of "
            "its own in the rig's 'joints'",
            topic, joint_states_.missing()));
    if (forwarded == 0 && lately(&C::other_joints) > 0)
        add(fmt::format("{} has none of the rig's joints: it has {}; the rig has {}", topic,
                        joint_states_.other_names(), joint_states_.local_joints()));
    if (forwarded == 0 && lately(&C::wrong_size) + lately(&C::not_finite) + lately(&C::malformed) > 0)
        add(topic +
            " has no finite position for each name: see joint_states of 'octoskin bridge status --json'");
    if (forwarded == 0 && lately(&C::still) > 0)
        add("the stamps of " + topic + " do not advance: its messages are not used");
    if (lately(&C::second_sender) > 0)
        add(fmt::format("two programs publish the same joints on {}: end one of them", topic));
    if (std::string text = stamp_problem(topic + ": its messages", lately(&C::ahead) + lately(&C::behind),
                                         received, joint_states_.stamp_age());
        !text.empty())
        add(std::move(text));
    const std::uint64_t unsent = lately(&C::unsent);
    if (unsent > 0 && unsent >= forwarded)
        add(fmt::format(
            "the daemon takes no joint states at {}: start it with --joints and this place, or name its "
            "place with --joints",
            options_.joints.string()));
    else if (unsent > 0)
        add(fmt::format("the daemon is too slow for joint states: {} of {} lost", unsent, forwarded));
    return problems;
}

Json Bridge::topics() const {
    Json topics = Json::array();
    for (const auto& outlets : {map_.outlets(), sensors_.outlets()})
        for (const Outlet* const outlet : outlets) topics.push_back(outlet_json(*outlet));
    return topics;
}

Json Bridge::cameras() const {
    Json cameras = Json::array();
    for (const auto& camera : cameras_) cameras.push_back(camera_json(*camera));
    return cameras;
}

Json Bridge::status() const {
    return {{"ok", true},
            {"daemon",
             {{"connected", daemon_ && daemon_->is_connected()},
              {"why", lost_},
              {"lost", daemon_ ? daemon_->lost() : 0},
              {"outdated", daemon_ ? daemon_->outdated() : 0}}},
            {"network",
             {{"domain", network_.domain},
              {"description", network_.description},
              {"participants", others_},
              {"matched_topics", matched_topics()}}},
            {"topics", topics()},
            {"joint_states", joints_json(joint_states_.counts())},
            {"cameras", cameras()},
            {"objects",
             {{"world", objects_.in_world()},
              {"held", objects_.held()},
              {"scenes", objects_.counts().scenes},
              {"malformed", objects_.counts().malformed},
              {"invalid", objects_.counts().invalid},
              {"unsupported", objects_.counts().unsupported},
              {"too_many", objects_.counts().too_many},
              {"unplaced", unplaced_.size()}}},
            {"problems", problems()}};
}

std::string Bridge::answer(const std::string& request) const {
    if (request == "hello") return R"({"ok":true})";
    if (request == "status") return status().dump(-1, ' ', false, Json::error_handler_t::replace);
    return R"({"ok":false,"exit":64,"error":{"code":"bad_argument","message":"unknown request"}})";
}

}  // namespace octoskin::bridge
