// octoskin bridge, octoskin view and octoskin export: become the program of the package octoskin-bridge.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/io/openni2/helper_process.hpp"

namespace octoskin::app {
namespace {

constexpr const char* kProgram = "octoskin-bridge";

/// Without a command, or with options only, it is `run`.
std::vector<std::string> with_command(std::vector<std::string> arguments) {
    const bool has_command = !arguments.empty() && !arguments.front().starts_with('-');
    const bool asks_help = !arguments.empty() && (arguments.front() == "--help" || arguments.front() == "-h");
    if (!has_command && !asks_help) arguments.insert(arguments.begin(), "run");
    return arguments;
}

[[noreturn]] void become_bridge(std::vector<std::string> words) {
    const auto program = openni2::find_helper(kProgram);
    if (!program)
        throw CommandFailure(
            ExitCode::unavailable,
            {.code = ErrorCode::no_program,
             .what = std::string(kProgram) + " is not installed",
             .remedy = "install the package octoskin-bridge (in a build: its target of this name)"});
    words.insert(words.begin(), kProgram);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    ::execv(program->c_str(), pointers.data());
    throw CommandFailure(ExitCode::unavailable,
                         {.code = ErrorCode::no_program, .what = std::strerror(errno), .file = *program});
}

/// A command of its own that is one of the bridge's program.
void add_command_of_bridge(CLI::App& app, const std::string& name, const std::string& description) {
    CLI::App* command = app.add_subcommand(name, description + " (package octoskin-bridge)");
    command->set_help_flag();  // the program has its own
    command->prefix_command();
    command->callback([command, name] {
        std::vector<std::string> words = command->remaining();
        words.insert(words.begin(), name);
        become_bridge(std::move(words));
    });
}

}  // namespace

void add_bridge_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "bridge",
        "Speak ROS 2: the map in MoveIt and RViz, joint states and depth images from topics (package "
        "octoskin-bridge)");
    command->set_help_flag();  // the program has its own
    command->prefix_command();
    command->callback([command] { become_bridge(with_command(command->remaining())); });
}

void add_view_command(CLI::App& app) {
    add_command_of_bridge(app, "view", "Show the map live in a browser, and to Foxglove and Lichtblick");
}

void add_export_command(CLI::App& app) {
    add_command_of_bridge(app, "export",
                          "Write a recording as an MCAP file for Foxglove, PlotJuggler, Rerun and ros2 bag");
}

}  // namespace octoskin::app
