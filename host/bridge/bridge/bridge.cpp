#include "host/bridge/bridge/bridge.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/bridge/cdr/cdr_reader.hpp"
#include "host/bridge/dds/interfaces.hpp"
#include "host/bridge/dds/local_packets.hpp"
#include "host/bridge/received/robot_description.hpp"

namespace octoskin::bridge {
namespace {

using namespace std::chrono_literals;

constexpr std::int32_t kJointsKept = 256;
constexpr std::int32_t kScenesKept = 16;
// Thousands of joints; objects with some hundred thousand triangles; the largest URDF that is compared.
constexpr std::size_t kJointBytesMax = std::size_t{256} << 10U;
constexpr std::size_t kSceneBytesMax = std::size_t{16} << 20U;
constexpr std::size_t kDescriptionBytesMax = std::size_t{17} << 20U;

Arrival now() {
    const ClockPair clocks = read_clocks();
    return {clocks.monotonic, clocks.wall};
}

/// Both clocks when the message arrived, also if it was taken later.
Arrival arrival_of(const dds::Sample& sample) {
    const Arrival taken = now();
    const Nanoseconds waited = taken.monotonic - sample.arrived;
    return {sample.arrived, WallTime{taken.wall.ns - waited.count()}};
}

}  // namespace

Result<std::unique_ptr<Bridge>, AppError> Bridge::open(BridgeOptions options) {
    const auto failed = [](const Error& error) { return unexpected(AppError{ExitCode::unavailable, error}); };
    auto network = dds::network_of(dds::process_environment, options.this_machine_only);
    if (!network) return unexpected(AppError{ExitCode::usage, network.error()});
    auto participant = dds::Participant::open(*network);
    if (!participant) return failed(participant.error());
    auto topics = std::make_unique<dds::Topics>(**participant);
    auto map = MapOutlets::open(*topics, options.topics);
    if (!map) return failed(map.error());
    auto sensors = SensorOutlets::open(*topics, options.topics.prefix, options.topics.map_frame);
    if (!sensors) return failed(sensors.error());
    std::unique_ptr<Bridge> bridge(new Bridge(std::move(options), std::move(network).value(),
                                              std::move(participant).value(), std::move(topics),
                                              std::move(map).value(), std::move(sensors).value()));
    auto socket = ControlSocket::open(
        bridge->options_.status_socket, bridge->loop_,
        [raw = bridge.get()](const std::string& line) { return raw->answer(line); }, ControlSocket::kIdleMax,
        "--status-socket");
    if (!socket) return unexpected(socket.error());
    bridge->status_socket_ = std::move(socket).value();
    return bridge;
}

Bridge::Bridge(BridgeOptions options, dds::Network network, std::unique_ptr<dds::Participant> participant,
               std::unique_ptr<dds::Topics> topics, MapOutlets map, SensorOutlets sensors)
    : options_(std::move(options)),
      network_(std::move(network)),
      participant_(std::move(participant)),
      topics_(std::move(topics)),
      map_(std::move(map)),
      sensors_(std::move(sensors)),
      joint_topic_(*participant_, options_.joint_states, ros::sensor_msgs::JointState::kType,
                   dds::Durability::volatile_, kJointsKept, kJointBytesMax),
      joint_states_({}),
      scene_topic_(*participant_, options_.planner_scene, ros::moveit_msgs::PlanningScene::kType,
                   dds::Durability::volatile_, kScenesKept, kSceneBytesMax),
      description_topic_(*participant_, options_.robot_description, ros::std_msgs::String::kType,
                         dds::Durability::transient_local, 1, kDescriptionBytesMax),
      begun_(monotonic_now()) {}

Bridge::~Bridge() {
    if (joint_socket_ >= 0) ::close(joint_socket_);
}

void Bridge::run() {
    spdlog::info("ROS 2: {}", network_.description);
    daemon_.emplace(loop_, options_.control, *this, DaemonLink::Wishes{});
    for (const int signal : {SIGTERM, SIGINT})
        sources_.push_back(loop_.on_signal(signal, [this] { loop_.stop(0); }));
    sources_.push_back(loop_.on_readable(participant_->descriptor(), [this] { on_dds(); }));
    sources_.push_back(loop_.every(20ms, [this] { publish(); }));
    sources_.push_back(loop_.every(500ms, [this] {
        daemon_->attend();
        attend_interfaces();
        attend_network();
        update_surroundings();  // for the problems, also without a reader
        map_.forget_unread();
        report_problems();
    }));
    daemon_->attend();
    attend_interfaces();
    attend_network();
    (void)::sd_notify(0, "READY=1");
    (void)loop_.run();
    (void)::sd_notify(0, "STOPPING=1");
}

void Bridge::on_dds() {
    if (participant_->clear()) attend_network();
    take_joint_states();
    take_planner_scenes();
    take_robot_description();
    for (const auto& camera : cameras_) camera->take(arrival_of);
}

void Bridge::attend_network() {
    others_ = participant_->others();
    const std::vector<dds::Endpoint> writers = participant_->other_writers();
    has_clock_topic_ = std::ranges::any_of(writers, [](const auto& one) { return one.topic == "rt/clock"; });
    joint_topic_.attend(writers);
    scene_topic_.attend(writers);
    description_topic_.attend(writers);
    for (const auto& camera : cameras_) camera->attend(writers, monotonic_now());
    if (scene_topic_.publishers() == 0) objects_.clear();
}

/// Cyclone DDS and its peers notice a lost link only after seconds. With addresses that change, the kernel's
/// filter has to change, too.
void Bridge::attend_interfaces() {
    interfaces_now_ = dds::running_interfaces();
    interfaces_.insert(interfaces_now_.begin(), interfaces_now_.end());
    if (network_.is_local_only && !dds::receive_from_this_machine_only())
        spdlog::error("cannot keep the DDS sockets to this machine");
}

void Bridge::publish() {
    const Arrival arrival = now();
    if (map_.is_due(arrival.monotonic)) {
        update_surroundings();
        map_.attend(arrival.monotonic, arrival.wall);
    }
    sensors_.attend(arrival.monotonic, arrival.wall);
}

void Bridge::on_robot(RobotFacts robot) {
    robot_ = std::move(robot);
    lost_.clear();
    auto now_of = RobotNow::of(*robot_);
    if (!now_of) spdlog::error("the daemon's robot is not understood: {}", now_of.error());
    robot_now_ = now_of ? std::optional(std::move(now_of).value()) : std::nullopt;
    joint_states_.change_sources(robot_->joint_sources);
    compare_description();
    map_.on_robot(*robot_);
    if (const auto opened = sensors_.on_robot(*robot_, wall_now()); !opened)
        spdlog::error("{}", opened.error().message());
    cameras_.clear();
    for (const CameraFacts& camera : robot_->cameras)
        if (camera.topic())
            cameras_.push_back(std::make_unique<ImageInlet>(*participant_, camera, options_.control));
    spdlog::info("daemon with rig '{}': frame {}, {} sensors, {} cameras from topics", robot_->rig,
                 robot_->root_link, robot_->sensors.size(), cameras_.size());
    attend_network();
}

void Bridge::on_map(const watch::WatchedMap& map) {
    map_.on_map(map);
}

void Bridge::on_range(const watch::WatchedRange& range, HostTime captured) {
    const Arrival arrival = now();
    sensors_.on_range(range, arrival.monotonic, wall_of(captured, arrival));
}

void Bridge::on_joints(const watch::WatchedJoints& joints, HostTime) {
    if (robot_now_) robot_now_->take(joints.source, joints.position);
}

void Bridge::on_status(const nlohmann::ordered_json& status) {
    sensors_.on_status(status);
}

void Bridge::on_lost(const std::string& why) {
    if (lost_ != why) spdlog::warn("no daemon: {}", why);
    lost_ = why;
    map_.on_lost();
    sensors_.on_lost(why);
}

void Bridge::take_joint_states() {
    std::vector<JointStates::Received> received;
    for (const dds::Sample& sample : joint_topic_.take(kJointsKept)) {
        auto message = cdr::read<ros::sensor_msgs::JointState>(sample.bytes);
        if (message)
            received.push_back({std::move(message).value(), sample.writer, arrival_of(sample)});
        else
            joint_states_.note_malformed();
    }
    for (const std::string& line : joint_states_.take(received)) send_joints(line);
}

/// Without a daemon the sample is lost: the next one comes soon.
void Bridge::send_joints(const std::string& line) {
    if (joint_socket_ < 0) {
        const auto connected = connect_unix_socket(options_.joints, SOCK_DGRAM, 100ms);
        if (connected) joint_socket_ = *connected;
    }
    if (joint_socket_ >= 0 &&
        ::send(joint_socket_, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0)
        return;
    joint_states_.note_unsent();
    const bool is_gone = joint_socket_ >= 0 && errno != EAGAIN;
    if (is_gone) ::close(std::exchange(joint_socket_, -1));
}

void Bridge::take_planner_scenes() {
    for (const dds::Sample& sample : scene_topic_.take(kScenesKept)) {
        const auto scene = cdr::read<ros::moveit_msgs::PlanningScene>(sample.bytes);
        scene ? objects_.take(*scene) : objects_.note_malformed();
    }
}

void Bridge::take_robot_description() {
    for (const dds::Sample& sample : description_topic_.take(1)) {
        auto text = cdr::read<ros::std_msgs::String>(sample.bytes);
        description_.reset();
        description_problem_.clear();
        if (text)
            description_ = std::move(text->data);
        else
            description_problem_ = options_.robot_description + " " + cdr::describe(text.error());
        compare_description();
    }
}

void Bridge::compare_description() {
    if (description_ && robot_) description_problem_ = description_differs(*description_, *robot_);
}

void Bridge::update_surroundings() {
    unplaced_.clear();
    if (!robot_now_) return;
    auto placed = objects_.placed([this](const std::string& frame) {
        return robot_now_->T_map_frame(frame == options_.planning_frame ? robot_->root_link : frame);
    });
    unplaced_ = std::move(placed.unplaced);
    map_.change_surroundings(
        std::move(placed.solids), objects_.version(),
        options_.topics.unknown_box ? robot_now_->body_map() : std::vector<PosedCapsule>{});
}

void Bridge::report_problems() {
    joints_lately_.note(joint_states_.counts(), monotonic_now());
    for (const auto& camera : cameras_) camera->note_counts(monotonic_now());
    const std::vector<std::string> present = problems();
    for (const std::string& problem : present)
        if (std::ranges::find(reported_, problem) == reported_.end()) spdlog::warn("{}", problem);
    for (const std::string& problem : reported_)
        if (std::ranges::find(present, problem) == present.end()) spdlog::info("over: {}", problem);
    reported_ = present;
    using ros::diagnostic_msgs::DiagnosticStatus;
    std::vector<DiagnosticStatus> notes;
    for (const std::string& problem : present)
        notes.push_back({.level = DiagnosticStatus::kWarn,
                         .name = "octoskin: bridge",
                         .message = problem,
                         .hardware_id = "octoskin",
                         .values = {}});
    sensors_.change_notes(std::move(notes));
}

}  // namespace octoskin::bridge
