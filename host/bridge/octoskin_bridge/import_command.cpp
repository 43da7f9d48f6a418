// octoskin bridge import: a bag as a recording.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/interruption.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/recording/given_bag.hpp"
#include "host/bridge/mcap/bag_import.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"

namespace octoskin::bridge {
namespace {

/// A line for each five seconds that it takes.
ImportReport report_share() {
    using Clock = std::chrono::steady_clock;
    return [last = Clock::now()](double share) mutable {
        if (Clock::now() - last < std::chrono::seconds(5)) return;
        last = Clock::now();
        spdlog::info("importing: {:.0f} %", 100.0 * share);
    };
}

void print_topic(const std::string& topic, const TopicAccount& account) {
    app::print("{:<40} {:>8} messages = {} used + {} rejected\n", topic, account.messages, account.used,
               account.rejected_in_all());
    for (const auto& [reason, count] : account.rejected) app::print("  {:<30} {:>8}\n", reason, count);
}

void print_account(const BagAccount& topics) {
    std::uint64_t others = 0;
    std::uint64_t messages = 0;
    for (const auto& [topic, account] : topics) {
        if (!account.rejected.contains(kNotNeeded)) {
            print_topic(topic, account);
            continue;
        }
        ++others;
        messages += account.messages;
    }
    if (others > 0) app::print("{} messages of {} other topics are not needed\n", messages, others);
}

void import_to_folder(const BagRequest& request) {
    const app::Interruption interruption;
    const ImportedBag imported = app::value_or_fail(import_bag(request, report_share()));
    print_account(imported.topics);
    app::print("{}: {:.1f} s, {} CAN frames, {} depth frames\n", request.folder.string(), imported.duration_s,
               imported.can_frames, imported.depth_frames);
    static_cast<void>(app::flush_standard_output());  // a failure is reported at the end
    for (const std::string& warning : imported.warnings) spdlog::warn("{}", warning);
}

/// A file, or a folder of which given_bag() decides.
CLI::Validator existing_bag() {
    return {[](std::string& path) -> std::string {
                std::error_code error;
                return std::filesystem::is_directory(path, error) ? "" : app::existing_file()(path);
            },
            ""};
}

}  // namespace

void add_import_command(CLI::App& app) {
    struct Options {
        BagRequest request;
        std::filesystem::path bag;
    };
    auto options = std::make_shared<Options>();
    BagRequest& request = options->request;
    CLI::App* command = app.add_subcommand(
        "import", "Make a recording of an MCAP file: joint states, depth images and CAN frames of a bag");
    command
        ->add_option("bag", options->bag,
                     "MCAP file of ROS 2, or a folder of `ros2 bag` with one and its metadata.yaml")
        ->required()
        ->check(existing_bag());
    command->add_option("out", request.folder, "Directory of the recording, new or empty")->required();
    command->add_option("--rig", request.rig, "Rig (YAML); its cameras name the topics: device: ros:/TOPIC")
        ->required()
        ->check(app::existing_file());
    app::add_robot_options(*command, request.robot, "Robot (URDF) in place of the rig's");
    command->add_option("--joint-states", request.joint_states,
                        "Topic of sensor_msgs/JointState (default: /joint_states)");
    command
        ->add_option(
            "--can", request.can,
            "Topic of CAN frames (can_msgs/Frame, ros2_socketcan_msgs/FdFrame). May be given several "
            "times (default: /from_can_bus and /from_can_bus_fd)")
        ->allow_extra_args(false);
    command->add_flag(
        "--log-time", request.uses_log_time,
        "Times are those at which messages were logged, in place of the stamps in their headers");
    command->callback([options] {
        options->request.bag = app::value_or_fail(given_bag(options->bag));
        import_to_folder(options->request);
    });
}

}  // namespace octoskin::bridge
