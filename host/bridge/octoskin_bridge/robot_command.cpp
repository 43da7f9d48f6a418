// octoskin bridge robot: saves the robot that ROS 2 describes.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"
#include "host/bridge/octoskin_bridge/wait_for.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {
namespace {

using app::CommandFailure;

struct RobotOptions {
    std::filesystem::path file;
    std::string topic = "/robot_description";
    int seconds = 10;
};

void save_robot(const RobotOptions& options) {
    const auto participant = take_part();
    const auto urdf = wait_for<ros::std_msgs::String>(
        *participant, options.topic, std::chrono::steady_clock::now() + std::chrono::seconds(options.seconds),
        [](const ros::std_msgs::String& message) { return std::optional(message.data); });
    if (!urdf)
        throw CommandFailure(
            ExitCode::unavailable,
            {.code = ErrorCode::no_data,
             .what = fmt::format("nothing publishes {} within {} s", options.topic, options.seconds),
             .remedy = "start robot_state_publisher, or name the topic with --topic"});
    std::error_code error;
    if (std::filesystem::exists(std::filesystem::symlink_status(options.file, error)))
        throw CommandFailure(ExitCode::cannot_create, {.code = ErrorCode::already_exists,
                                                       .what = "exists already",
                                                       .remedy = "give a new file",
                                                       .file = options.file});
    if (const auto written = write_text(options.file, *urdf); !written) throw CommandFailure(written.error());
    app::print("{}: {} bytes\n", options.file.string(), urdf->size());
}

}  // namespace

void add_robot_command(CLI::App& app) {
    auto options = std::make_shared<RobotOptions>();
    CLI::App* command =
        app.add_subcommand("robot", "Save the robot that /robot_description publishes as a URDF file");
    command->add_option("file", options->file, "New file, as arm.urdf")->required();
    command->add_option("--topic", options->topic, "Topic of the URDF")->capture_default_str();
    command->add_option("--seconds", options->seconds, "How long to wait")
        ->check(CLI::Range(1, 600))
        ->capture_default_str();
    command->callback([options] { save_robot(*options); });
}

}  // namespace octoskin::bridge
