#include "host/bridge/mcap/recording_export.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "host/bridge/mcap/camera_topics.hpp"
#include "host/bridge/mcap/can_messages.hpp"
#include "host/bridge/mcap/link_frames.hpp"
#include "host/bridge/published/ros_values.hpp"
#include "host/bridge/published/sensor_messages.hpp"
#include "host/bridge/received/depth_image.hpp"

namespace octoskin::bridge {
namespace {

constexpr const char* kDiagnostics = "/diagnostics";
constexpr ros::Qos kStream{ros::Reliability::reliable, ros::Durability::volatile_, 10};
constexpr ros::Qos kImages{ros::Reliability::reliable, ros::Durability::volatile_, 5};
/// Transforms of links; joint states come at up to 1000 Hz.
constexpr Nanoseconds kLinkPeriod{20'000'000};

ros::sensor_msgs::Image image_message(const DepthFrame& frame, const ros::std_msgs::Header& header) {
    ros::sensor_msgs::Image image{.header = header,
                                  .height = frame.height,
                                  .width = frame.width,
                                  .encoding = "16UC1",
                                  .is_bigendian = 0,
                                  .step = frame.width * 2,
                                  .data = std::vector<std::uint8_t>(frame.depth_mm.size() * 2)};
    std::memcpy(image.data.data(), frame.depth_mm.data(), image.data.size());
    return image;
}

/// ROS counts from the centre of the first pixel, a rig from its corner.
ros::sensor_msgs::CameraInfo info_message(const CameraFacts& camera, const ros::std_msgs::Header& header) {
    constexpr double kPixelCentre = 0.5;
    const CameraIntrinsics& lens = camera.intrinsics;
    const double cx = lens.cx - kPixelCentre;
    const double cy = lens.cy - kPixelCentre;
    return {.header = header,
            .height = lens.height,
            .width = lens.width,
            .distortion_model = "plumb_bob",
            .d = {0, 0, 0, 0, 0},
            .k = {lens.fx, 0, cx, 0, lens.fy, cy, 0, 0, 1},
            .r = {1, 0, 0, 0, 1, 0, 0, 0, 1},
            .p = {lens.fx, 0, cx, 0, 0, lens.fy, cy, 0, 0, 0, 1, 0},
            .binning_x = 0,
            .binning_y = 0,
            .roi = {}};
}

}  // namespace

std::vector<std::string> optional_topics(const MapTopics& topics) {
    return {kCanTopic,
            kCanFdTopic,
            topics.scene,
            topics.prefix + "/octomap_full",
            topics.prefix + "/occupied_cells_vis_array",
            topics.prefix + "/projected_map"};
}

Result<RecordingExport::Parts, Error> RecordingExport::open_parts(McapTopics& sink,
                                                                  const RecordedEvents& recorded,
                                                                  const RecordingPaths& paths,
                                                                  const ExportOptions& options) {
    auto map = MapOutlets::open(sink, options.topics);
    if (!map) return unexpected(map.error());
    auto sensors = SensorOutlets::open(sink, options.topics.prefix, options.topics.map_frame);
    if (!sensors) return unexpected(sensors.error());
    auto log = candump::LogReader::open(paths.can_log());
    if (!log) return unexpected(log.error());
    auto joints = Outlet::open<ros::sensor_msgs::JointState>(sink, "/joint_states", kStream);
    auto links = Outlet::open<ros::tf2_msgs::TFMessage>(sink, "/tf", kStream);
    auto description = Outlet::open<ros::std_msgs::String>(sink, "/robot_description", kLastMessage);
    auto can = Outlet::open<ros::can_msgs::Frame>(sink, kCanTopic, kStream);
    auto can_fd = Outlet::open<ros::ros2_socketcan_msgs::FdFrame>(sink, kCanFdTopic, kStream);
    for (const auto* one : {&joints, &links, &description, &can, &can_fd})
        if (!*one) return unexpected(one->error());
    std::vector<Camera> cameras;
    for (const CameraFacts& camera : recorded.robot().cameras) {
        const std::string topic = image_topic_of(camera);
        auto image = Outlet::open<ros::sensor_msgs::Image>(sink, topic, kImages);
        auto info = Outlet::open<ros::sensor_msgs::CameraInfo>(sink, info_topic(topic), kImages);
        for (const auto* one : {&image, &info})
            if (!*one) return unexpected(one->error());
        cameras.push_back({std::move(image).value(), std::move(info).value()});
    }
    return Parts{std::move(map).value(),         std::move(sensors).value(),
                 std::move(joints).value(),      std::move(links).value(),
                 std::move(description).value(), std::move(can).value(),
                 std::move(can_fd).value(),      std::move(cameras),
                 std::move(log).value()};
}

Result<std::unique_ptr<RecordingExport>, Error> RecordingExport::open(McapTopics& sink,
                                                                      const RecordedEvents& recorded,
                                                                      const RecordingPaths& paths,
                                                                      ExportOptions options) {
    auto parts = open_parts(sink, recorded, paths, options);
    if (!parts) return unexpected(parts.error());
    std::unique_ptr<RecordingExport> made(
        new RecordingExport(sink, recorded, std::move(options), std::move(parts).value()));
    const RobotFacts& robot = recorded.robot();
    if (auto now = RobotNow::of(robot)) made->robot_now_.emplace(std::move(now).value());
    made->parts_.map.on_robot(robot);
    // The topics of the sensors, so that all topics are known; the frames follow with their time.
    sink.pause("/tf_static");
    if (const auto opened = made->parts_.sensors.on_robot(robot, WallTime{0}); !opened)
        return unexpected(opened.error());
    sink.resume("/tf_static");
    // The status of a recording is known at its end.
    sink.pause(kDiagnostics);
    return made;
}

void RecordingExport::on_robot(RobotFacts) {}

void RecordingExport::on_status(const nlohmann::ordered_json& status) {
    parts_.sensors.on_status(status);
}

void RecordingExport::on_map(const watch::WatchedMap& map) {
    parts_.map.on_map(map);
}

void RecordingExport::begin(WallTime wall) {
    const RobotFacts& robot = recorded_.robot();
    auto frames = fixed_links(robot, wall);
    const auto cameras = camera_frames(robot, parts_.sensors.frame_prefix(), wall);
    frames.insert(frames.end(), cameras.begin(), cameras.end());
    parts_.sensors.change_other_frames(std::move(frames));
    (void)parts_.sensors.on_robot(robot, wall);  // its topics are open
    parts_.description.send(ros::std_msgs::String{recorded_.robot_description()}, wall);
}

void RecordingExport::on_time(HostTime bus, WallTime wall) {
    if (!begun_) begin(wall);
    begun_ = begun_.value_or(bus);
    now_ = bus;
    send_log(wall);
    parts_.sensors.attend(bus, wall);
    if (map_attended_ && bus - *map_attended_ < options_.map_period) return;
    if (!parts_.map.is_due(bus)) return;
    map_attended_ = bus;
    parts_.map.attend(bus, wall);
}

void RecordingExport::on_range(const watch::WatchedRange& range, HostTime captured) {
    parts_.sensors.on_range(range, now_, recorded_.clock().wall_of(captured));
}

void RecordingExport::on_joints(const watch::WatchedJoints& joints, HostTime sampled) {
    const WallTime wall = recorded_.clock().wall_of(sampled);
    const JointSourceFacts& source = recorded_.robot().joint_sources.at(joints.source);
    if (parts_.joints.readers() > 0)
        parts_.joints.send(ros::sensor_msgs::JointState{.header = ros_header(wall, ""),
                                                        .name = source.joints,
                                                        .position = joints.position,
                                                        .velocity = {},
                                                        .effort = {}},
                           wall);
    if (robot_now_) robot_now_->take(joints.source, joints.position);
    send_links(sampled);
}

void RecordingExport::send_links(HostTime sampled) {
    if (links_sent_ && sampled - *links_sent_ < kLinkPeriod) return;
    if (!robot_now_ || parts_.links.readers() == 0) return;
    const WallTime wall = recorded_.clock().wall_of(sampled);
    const auto message = moved_links(recorded_.robot(), *robot_now_, wall);
    if (message.transforms.empty()) return;
    links_sent_ = sampled;
    parts_.links.send(message, wall);
}

void RecordingExport::on_depth(const DepthFrame& frame) {
    if (frame.camera >= parts_.cameras.size()) return;
    const CameraFacts& camera = recorded_.robot().cameras[frame.camera];
    Camera& outlets = parts_.cameras[frame.camera];
    const WallTime wall = recorded_.clock().wall_of(frame.captured);
    const auto header = ros_header(wall, camera_frame(parts_.sensors.frame_prefix(), camera));
    if (outlets.info.readers() > 0) outlets.info.send(info_message(camera, header), wall);
    if (outlets.image.readers() > 0) outlets.image.send(image_message(frame, header), wall);
}

/// Frames of the bus up to this time; empty: all that are left.
void RecordingExport::send_log(std::optional<WallTime> until) {
    const bool is_wanted = parts_.can.readers() + parts_.can_fd.readers() > 0;
    while (is_wanted && !is_log_over_) {
        if (!next_entry_) {
            auto entry = parts_.log.next();
            is_log_over_ = !entry || !*entry;  // a fault of reading is reported by the playback
            if (is_log_over_) return;
            next_entry_ = std::move(**entry);
        }
        if (until && next_entry_->stamp > *until) return;
        send_frame(*next_entry_);
        next_entry_.reset();
    }
}

void RecordingExport::send_frame(const candump::LogEntry& entry) {
    Outlet& outlet = entry.frame.is_fd ? parts_.can_fd : parts_.can;
    if (outlet.readers() == 0) return;
    if (entry.frame.is_fd)
        outlet.send(can_fd_message(entry.frame, entry.stamp, entry.interface), entry.stamp);
    else
        outlet.send(can_message(entry.frame, entry.stamp, entry.interface), entry.stamp);
}

void RecordingExport::finish() {
    send_log(std::nullopt);
    const WallTime wall = recorded_.clock().wall_of(now_);
    sink_.resume(kDiagnostics);
    // Later than any pace: what waits is due.
    const HostTime later = now_ + Nanoseconds{10'000'000'000};
    parts_.sensors.attend(later, wall);
    if (parts_.map.is_due(later)) parts_.map.attend(later, wall);
}

}  // namespace octoskin::bridge
