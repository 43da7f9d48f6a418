#include "host/bridge/view/view_server.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/bridge/published/ros_values.hpp"
#include "host/bridge/received/stamp.hpp"
#include "host/bridge/view/json_text.hpp"
#include "host/io/snapshot/bytes.hpp"

namespace octoskin::view {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;
using bridge::Outlet;

constexpr const char* kPrefix = "/octoskin/view/";
constexpr Nanoseconds kJointsPeriod = 33ms;
constexpr Nanoseconds kRangesPeriod = 50ms;
/// Readings of one period; beyond this the oldest are left out.
constexpr std::size_t kRangeBytesMax = std::size_t{256} << 10U;

/// Between now and `due` there is less than half a turn.
bool is_due(std::optional<HostTime> sent, Nanoseconds period, HostTime now) {
    constexpr Nanoseconds kHalfTurn = 8ms;
    return !sent || now - *sent + kHalfTurn >= period;
}

std::string image_topic(const std::string& camera) {
    return kPrefix + std::string("images/") + (camera.empty() ? "camera" : camera);
}

}  // namespace

Result<std::unique_ptr<ViewServer>, Error> ViewServer::open(FoxgloveServer& server, std::string mode) {
    auto topics = std::make_unique<ViewTopics>(server);
    const bridge::MapTopics names;
    auto map = bridge::MapOutlets::open(*topics, names);
    if (!map) return unexpected(map.error());
    auto sensors = bridge::SensorOutlets::open(*topics, names.prefix, names.map_frame);
    if (!sensors) return unexpected(sensors.error());
    auto frames = Outlet::open<ros::tf2_msgs::TFMessage>(*topics, "/tf", bridge::kLastMessage);
    auto urdf = Outlet::open<ros::std_msgs::String>(*topics, "/robot_description", bridge::kLastMessage);
    for (const auto* one : {&frames, &urdf})
        if (!*one) return unexpected(one->error());
    return std::unique_ptr<ViewServer>(new ViewServer(server, std::move(mode), std::move(topics),
                                                      std::move(map).value(), std::move(sensors).value(),
                                                      std::move(frames).value(), std::move(urdf).value()));
}

ViewServer::ViewServer(FoxgloveServer& server, std::string mode, std::unique_ptr<ViewTopics> topics,
                       bridge::MapOutlets map, bridge::SensorOutlets sensors, Outlet frames, Outlet urdf)
    : server_(server),
      mode_(std::move(mode)),
      topics_(std::move(topics)),
      map_outlets_(std::move(map)),
      sensors_(std::move(sensors)),
      frames_(std::move(frames)),
      urdf_outlet_(std::move(urdf)),
      map_(server.open(
          {.topic = std::string(kPrefix) + "map", .encoding = "octoskin", .schema_name = "octoskin.Map"},
          board_)),
      ranges_(server.open({.topic = std::string(kPrefix) + "ranges",
                           .encoding = "octoskin",
                           .schema_name = "octoskin.Ranges"},
                          true)),
      joints_(open_json("joints", "octoskin.Joints")),
      status_(open_json("status", "octoskin.Status")),
      robot_channel_(open_json("robot", "octoskin.Robot")),
      link_(open_json("link", "octoskin.Link")) {
    publish_link();
}

ChannelId ViewServer::open_json(const std::string& topic, const std::string& type) {
    return server_.open({.topic = kPrefix + topic,
                         .encoding = "json",
                         .schema_name = type,
                         .schema_encoding = "jsonschema",
                         .schema = R"({"type":"object","properties":{}})"},
                        true);
}

void ViewServer::on_described(const Json& described) {
    described_ = described;
}

void ViewServer::on_robot(bridge::RobotFacts robot) {
    robot_ = std::move(robot);
    auto now_of = bridge::RobotNow::of(*robot_);
    if (!now_of) spdlog::error("the daemon's robot is not understood: {}", now_of.error());
    robot_now_ = now_of ? std::optional(std::move(now_of).value()) : std::nullopt;
    are_frames_due_ = true;
    map_outlets_.on_robot(*robot_);
    if (const auto opened = sensors_.on_robot(*robot_, wall_now()); !opened)
        spdlog::error("{}", opened.error().message());
    open_images();
    joints_waiting_.clear();
    ranges_waiting_.clear();
    urdf_.reset();  // it follows
    for (const ChannelId channel : {joints_, ranges_, status_}) server_.forget_messages(channel);
    if (!std::exchange(is_connected_, true))
        spdlog::info("{} with rig '{}'", mode_ == "live" ? "daemon" : mode_, robot_->rig);
    why_.clear();
    server_.notify(foxglove::Level::warning, "octoskin.daemon", "");
    publish_robot();
    publish_link();
}

void ViewServer::open_images() {
    std::map<std::string, ChannelId> now;
    for (const bridge::CameraFacts& camera : robot_->cameras) {
        const std::string topic = image_topic(camera.name);
        if (auto before = images_.extract(topic))
            now.insert(std::move(before));
        else if (!now.contains(topic))
            now.emplace(
                topic,
                server_.open({.topic = topic, .encoding = "octoskin", .schema_name = "octoskin.DepthImage"},
                             true));
    }
    for (const auto& [topic, channel] : images_) server_.close(channel);
    images_ = std::move(now);
}

void ViewServer::publish_robot() {
    Json robot = described_;
    robot["urdf"] = urdf_ ? Json(*urdf_) : Json();
    server_.publish(robot_channel_, wall_now(), text_of(robot));
}

void ViewServer::serve_meshes(MeshSearch search) {
    meshes_.emplace(std::move(search));
    server_.serve_assets([this](const std::string& uri) { return meshes_->read(uri); });
}

void ViewServer::on_urdf(const std::string& text) {
    if (meshes_) meshes_->on_urdf(text);
    urdf_ = text.empty() ? std::nullopt : std::optional(text);
    urdf_outlet_.send(ros::std_msgs::String{text}, wall_now());
    publish_robot();
}

void ViewServer::on_image(const watch::WatchedImage& image, HostTime captured) {
    if (!robot_ || image.camera >= robot_->cameras.size()) return;
    std::string payload;
    snapshot::ByteWriter writer(payload);
    writer.put(image.width);
    writer.put(image.height);
    writer.put(captured.ns);
    for (const std::uint16_t depth_mm : image.depth_mm) writer.put(depth_mm);
    server_.publish(images_.at(image_topic(robot_->cameras[image.camera].name)), wall_now(),
                    std::move(payload));
}

void ViewServer::on_map(const watch::WatchedMap& map) {
    board_.on_map(map, wall_now());
    server_.wake_readers(map_);
    map_outlets_.on_map(map);
}

void ViewServer::on_range(const watch::WatchedRange& range, HostTime captured) {
    const bridge::Arrival arrival{monotonic_now(), wall_now()};
    sensors_.on_range(range, arrival.monotonic, bridge::wall_of(captured, arrival));
    const std::string payload = watch::range_payload(range);
    if (ranges_waiting_.size() + payload.size() > kRangeBytesMax) return;
    snapshot::ByteWriter writer(ranges_waiting_);
    writer.put(static_cast<std::uint32_t>(payload.size()));
    writer.put(captured.ns);
    ranges_waiting_ += payload;
}

void ViewServer::on_joints(const watch::WatchedJoints& joints, HostTime sampled) {
    if (robot_now_) robot_now_->take(joints.source, joints.position);
    are_frames_due_ = true;
    joints_waiting_[joints.source] = {joints.position, sampled};
}

void ViewServer::on_status(const Json& status) {
    sensors_.on_status(status);
    server_.publish(status_, wall_now(), text_of(status));
}

void ViewServer::on_lost(const std::string& why) {
    if (why_ != why) spdlog::warn("no daemon: {}", why);
    const bool is_new = std::exchange(is_connected_, false) || why_ != why;
    why_ = why;
    board_.begin_again();
    map_outlets_.on_lost();
    sensors_.on_lost(why);
    server_.notify(foxglove::Level::warning, "octoskin.daemon", "no daemon: " + why);
    if (is_new) publish_link();
}

void ViewServer::change_place(Json place) {
    place_ = std::move(place);
    publish_link();
}

void ViewServer::publish_link() {
    Json link = {{"connected", is_connected_}, {"why", why_}, {"mode", mode_}};
    if (place_.is_object()) link.update(place_);
    server_.publish(link_, wall_now(), text_of(link));
}

void ViewServer::attend() {
    const HostTime now = monotonic_now();
    const WallTime wall = wall_now();
    if (is_due(joints_sent_, kJointsPeriod, now)) {
        joints_sent_ = now;
        publish_joints();
        publish_frames(wall);
    }
    if (is_due(ranges_sent_, kRangesPeriod, now)) {
        ranges_sent_ = now;
        publish_ranges();
    }
    map_outlets_.attend(now, wall);
    sensors_.attend(now, wall);
}

void ViewServer::publish_joints() {
    for (const auto& [source, joints] : joints_waiting_) {
        if (!robot_ || source >= robot_->joint_sources.size()) continue;
        server_.publish(joints_, wall_now(),
                        text_of({{"source", source},
                                 {"joints", robot_->joint_sources[source].joints},
                                 {"positions", joints.position},
                                 {"time_s", seconds_of(joints.sampled - HostTime{0})}}),
                        static_cast<std::uint32_t>(source));
    }
    joints_waiting_.clear();
}

/// The times count from a base of 0, the bus's own.
void ViewServer::publish_ranges() {
    if (ranges_waiting_.empty()) return;
    std::string payload;
    snapshot::ByteWriter(payload).put(std::int64_t{0});
    payload += std::exchange(ranges_waiting_, {});
    server_.publish(ranges_, wall_now(), std::move(payload));
}

void ViewServer::publish_frames(WallTime wall) {
    if (!are_frames_due_ || !robot_now_ || frames_.readers() == 0) return;
    are_frames_due_ = false;
    ros::tf2_msgs::TFMessage message;
    for (const std::string& link : robot_->links) {
        const auto T_map_link = robot_now_->T_map_frame(link);
        if (!T_map_link || link == robot_->root_link) continue;
        message.transforms.push_back({bridge::ros_header(wall, robot_->root_link), link,
                                      bridge::ros_transform(robot_->T_root_map * *T_map_link)});
    }
    frames_.send(message, wall);
}

void ViewServer::notify_counts() {
    map_outlets_.forget_unread();
    server_.notify_dropped();
    const std::string refused = server_.counts().refused_text();
    server_.notify(foxglove::Level::info, "octoskin.refused",
                   refused.empty() ? "" : "refused connections, by reason: " + refused);
}

}  // namespace octoskin::view
