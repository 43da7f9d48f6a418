#include "host/bridge/outlets/sensor_outlets.hpp"

#include <algorithm>
#include <utility>

#include "host/bridge/published/ros_values.hpp"
#include "host/bridge/published/sensor_messages.hpp"

namespace octoskin::bridge {
namespace {

constexpr ros::Qos kStream{ros::Reliability::reliable, ros::Durability::volatile_, 5};
constexpr ros::Qos kDiagnostics{ros::Reliability::reliable, ros::Durability::volatile_, 10};

}  // namespace

Result<SensorOutlets, Error> SensorOutlets::open(TopicSink& sink, std::string prefix, std::string map_frame) {
    SensorOutlets made(sink, std::move(prefix), std::move(map_frame));
    auto frames = Outlet::open<ros::tf2_msgs::TFMessage>(sink, "/tf_static", kLastMessage);
    auto points = Outlet::open<ros::sensor_msgs::PointCloud2>(sink, made.prefix_ + "/points", kStream);
    auto problems = Outlet::open<ros::diagnostic_msgs::DiagnosticArray>(sink, "/diagnostics", kDiagnostics);
    for (const auto* one : {&frames, &points, &problems})
        if (!*one) return unexpected(one->error());
    made.frames_ = std::move(frames).value();
    made.points_ = std::move(points).value();
    made.diagnostics_ = std::move(problems).value();
    return made;
}

std::string SensorOutlets::frame_prefix() const {
    std::string name = prefix_.substr(1);
    std::ranges::replace(name, '/', '_');
    return name;
}

Status<Error> SensorOutlets::on_robot(const RobotFacts& robot, WallTime wall) {
    std::map<SensorId, Outlet> ranges;
    for (const SensorFacts& sensor : robot.sensors) {
        const SensorId id{sensor.node, sensor.sensor};
        if (auto before = ranges_.extract(id)) {
            ranges.insert(std::move(before));
            continue;
        }
        auto outlet =
            Outlet::open<ros::sensor_msgs::Range>(*sink_, prefix_ + "/range/" + sensor.label(), kStream);
        if (!outlet) return unexpected(outlet.error());
        ranges.emplace(id, std::move(outlet).value());
    }
    ranges_ = std::move(ranges);
    robot_ = robot;
    const bool has_parent = robot.has_link(map_frame_);  // named as a problem
    if (has_parent) return Done{};
    auto frames = static_frames(robot, frame_prefix(), map_frame_, wall);
    frames.transforms.insert(frames.transforms.end(), other_frames_.begin(), other_frames_.end());
    frames_->send(frames, wall);
    return Done{};
}

void SensorOutlets::on_range(const watch::WatchedRange& range, HostTime now, WallTime captured) {
    const SensorFacts* const sensor = robot_.find_sensor(range.source.node_id, range.source.sensor);
    const auto outlet = ranges_.find(range.source.sensor_id());
    if (sensor == nullptr || outlet == ranges_.end()) return;
    // One cone a message: a sensor with zones has a message for each.
    if (outlet->second.readers() > 0)
        outlet->second.send(
            range_message(range, *sensor, ros_header(captured, range_frame(frame_prefix(), *sensor))),
            captured);
    const auto is_again = [&range](const watch::WatchedRange& one) { return one.source == range.source; };
    if (std::ranges::any_of(round_, is_again)) end_round();
    if (round_.empty()) {
        round_begun_ = now;
        round_time_ = captured;
    }
    round_.push_back(range);
}

void SensorOutlets::end_round() {
    if (points_->readers() > 0)
        points_->send(points_message(round_, ros_header(round_time_, map_frame_)), round_time_);
    round_.clear();
}

void SensorOutlets::on_lost(const std::string& why) {
    status_.reset();
    lost_ = why;
}

void SensorOutlets::attend(HostTime now, WallTime wall) {
    constexpr Nanoseconds kSecond{1'000'000'000};
    if (!round_.empty() && now - round_begun_ >= kRound) end_round();
    if (diagnosed_ && now - *diagnosed_ < kSecond) return;
    diagnosed_ = now;
    if (diagnostics_->readers() == 0) return;
    auto array = status_ ? diagnostics(*status_, wall) : diagnostics_without_daemon(lost_, wall);
    array.status.insert(array.status.end(), notes_.begin(), notes_.end());
    diagnostics_->send(array, wall);
}

std::vector<const Outlet*> SensorOutlets::outlets() const {
    std::vector<const Outlet*> all = {&*frames_, &*points_, &*diagnostics_};
    for (const auto& [id, outlet] : ranges_) all.push_back(&outlet);
    return all;
}

}  // namespace octoskin::bridge
