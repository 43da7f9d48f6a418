// octoskin bridge pose: the pose of a camera from /tf_static, as text for the rig.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"
#include "host/bridge/octoskin_bridge/wait_for.hpp"
#include "host/bridge/received/frame_tree.hpp"
#include "host/bridge/robot/robot_facts.hpp"

namespace octoskin::bridge {
namespace {

using app::CommandFailure;

struct PoseOptions {
    std::filesystem::path socket = default_control_socket();
    std::string frame;
    int seconds = 10;
};

void print_pose(const PoseOptions& options) {
    const auto answer = ask_daemon(options.socket, "describe");
    if (!answer) throw CommandFailure(answer.error());
    const auto robot = robot_facts(nlohmann::ordered_json::parse(*answer, nullptr, false));
    if (!robot) throw CommandFailure(foreign_answer(options.socket));
    FrameTree tree;
    const auto found = wait_for<ros::tf2_msgs::TFMessage>(
        "/tf_static", std::chrono::seconds(options.seconds), [&](const ros::tf2_msgs::TFMessage& message) {
            tree.take(message);
            return tree.from_link(options.frame, robot->links);
        });
    if (!found)
        throw CommandFailure(
            ExitCode::unavailable,
            {.code = ErrorCode::no_data,
             .what = tree.why(options.frame),
             .remedy = "start the camera's driver and the publisher of the transform between the "
                       "robot and the camera, or write the pose into the rig by hand"});
    app::print_text(rig_text(*found));
}

}  // namespace

void add_pose_command(CLI::App& app) {
    auto options = std::make_shared<PoseOptions>();
    CLI::App* command = app.add_subcommand("pose",
                                           "Print the pose of a camera's optical frame on the robot's links, "
                                           "from /tf_static, as text for the rig");
    command->add_option("frame", options->frame, "Frame of the depth images (header.frame_id)")->required();
    command->add_option("--socket", options->socket, "Control socket of the daemon")->capture_default_str();
    command->add_option("--seconds", options->seconds, "How long to wait")
        ->check(CLI::Range(1, 600))
        ->capture_default_str();
    command->callback([options] { print_pose(*options); });
}

}  // namespace octoskin::bridge
