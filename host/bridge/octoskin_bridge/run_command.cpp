// octoskin bridge run
#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <regex>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/log_format.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/bridge/bridge/bridge.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"

namespace octoskin::bridge {
namespace {

using app::CommandFailure;

CLI::Validator topic_name() {
    return {[](const std::string& text) -> std::string {
                static const std::regex kName("(/[A-Za-z_][A-Za-z0-9_]*)+");
                return std::regex_match(text, kName)
                           ? ""
                           : "expected a topic as /left/octoskin, found '" + text + "'";
            },
            "TOPIC"};
}

CLI::Validator frame_name() {
    return {[](const std::string& text) -> std::string {
                static const std::regex kName("[A-Za-z_][A-Za-z0-9_/]*");
                return std::regex_match(text, kName)
                           ? ""
                           : "expected a frame as octoskin_map, without a slash at its begin, found '" +
                                 text + "'";
            },
            "FRAME"};
}

struct RunOptions {
    BridgeOptions bridge{.control = default_control_socket(),
                         .joints = default_joint_socket(),
                         .status_socket = default_bridge_socket()};
    std::vector<double> unknown_box;
};

void check_box(RunOptions& options) {
    if (options.unknown_box.empty()) return;
    const std::vector<double>& b = options.unknown_box;
    const Eigen::AlignedBox3d box(Eigen::Vector3d(b[0], b[1], b[2]), Eigen::Vector3d(b[3], b[4], b[5]));
    // At the finest resolution of a rig.
    constexpr double kFinest_m = 0.01;
    if (!(box.sizes().array() > 0.0).all() || !(voxels_in(box, kFinest_m) <= kUnknownVoxelsMax))
        throw CommandFailure(
            ExitCode::usage,
            {.code = ErrorCode::bad_argument,
             .what = "--unknown-box needs three lower and three higher coordinates, of a box of at "
                     "most 20 cubic metres"});
    options.bridge.topics.unknown_box = box;
}

void run_bridge(RunOptions& options) {
    std::getenv("JOURNAL_STREAM") != nullptr ? app::set_journal_format() : app::set_log_format();
    check_box(options);
    auto bridge = Bridge::open(options.bridge);
    if (!bridge) throw CommandFailure(bridge.error());
    (*bridge)->run();
}

}  // namespace

void add_run_command(CLI::App& app) {
    auto options = std::make_shared<RunOptions>();
    BridgeOptions& bridge = options->bridge;
    CLI::App* command = app.add_subcommand("run",
                                           "Publish the map, ranges and problems; take joint states, depth "
                                           "images and the planner's objects");
    command->add_option("--socket", bridge.control, "Control socket of the daemon")->capture_default_str();
    command->add_option("--joints", bridge.joints, "Joint socket of the daemon")->capture_default_str();
    command
        ->add_option("--status-socket", bridge.status_socket,
                     "Where `octoskin bridge status` asks this program")
        ->capture_default_str();
    command->add_flag("--this-machine-only", bridge.this_machine_only,
                      "Send nothing to other machines and take nothing from them");
    command->add_option("--prefix", bridge.topics.prefix, "Prefix of the topics, for several robots")
        ->check(topic_name())
        ->capture_default_str();
    command->add_option("--map-frame", bridge.topics.map_frame, "Name of the map's frame")
        ->check(frame_name())
        ->capture_default_str();
    command->add_option("--planning-scene", bridge.topics.scene, "Topic of MoveIt's scene")
        ->check(topic_name())
        ->capture_default_str();
    command
        ->add_option("--planner", bridge.planner_scene,
                     "Topic with the planner's objects, which are left out")
        ->check(topic_name())
        ->capture_default_str();
    command
        ->add_option(
            "--planning-frame", bridge.planning_frame,
            "The planner's name of the robot's root link, if it has another one (MoveIt's virtual joint)")
        ->check(frame_name());
    command->add_option("--joint-states", bridge.joint_states, "Topic of the joint states")
        ->check(topic_name())
        ->capture_default_str();
    command->add_option("--robot-description", bridge.robot_description, "Topic of the robot's URDF")
        ->check(topic_name())
        ->capture_default_str();
    command
        ->add_option("--object-padding", bridge.topics.object_padding_m,
                     "Voxels this close to an object of the planner are left out, too (metres)")
        ->check(app::from_to(0.0, 0.5))
        ->capture_default_str();
    command
        ->add_option(
            "--unknown-box", options->unknown_box,
            "X Y Z X Y Z in metres, map frame: unknown space between them is an obstacle in the planning "
            "scene. A planner like MoveIt's takes unknown space for free")
        ->expected(6);
    command
        ->add_option("--own-space", bridge.topics.own_space_m,
                     "With --unknown-box: unknown space this close to the robot is no obstacle (metres)")
        ->check(app::from_to(0.0, 1.0))
        ->capture_default_str();
    command->footer(
        "The network is that of a ROS 2 node with the same environment: ROS_DOMAIN_ID, "
        "ROS_AUTOMATIC_DISCOVERY_RANGE,\n"
        "ROS_STATIC_PEERS, ROS_LOCALHOST_ONLY, CYCLONEDDS_URI.");
    command->callback([options] { run_bridge(*options); });
}

}  // namespace octoskin::bridge
