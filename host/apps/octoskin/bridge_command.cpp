// octoskin bridge, octoskin view and octoskin export: become the program of the package octoskin-bridge.
#include <string>
#include <utility>
#include <vector>

#include "host/apps/octoskin/bridge_program.hpp"
#include "host/apps/octoskin/commands.hpp"

namespace octoskin::app {
namespace {

/// Without a command, or with options only, it is `run`.
std::vector<std::string> with_command(std::vector<std::string> arguments) {
    const bool has_command = !arguments.empty() && !arguments.front().starts_with('-');
    const bool asks_help = !arguments.empty() && (arguments.front() == "--help" || arguments.front() == "-h");
    if (!has_command && !asks_help) arguments.insert(arguments.begin(), "run");
    return arguments;
}

/// Adds a command whose arguments, made by `words` of those given, are the bridge program's.
template <class Words>
void add_command(CLI::App& app, const std::string& name, const std::string& description, Words words) {
    CLI::App* command = app.add_subcommand(name, description + " (package octoskin-bridge)");
    command->set_help_flag();  // the program has its own
    command->prefix_command();
    command->callback(
        [command, words] { become_bridge(with_form_of_errors(*command, words(command->remaining()))); });
}

/// A command of the bridge's program that is one of octoskin, too.
void add_same_command(CLI::App& app, const std::string& name, const std::string& description) {
    add_command(app, name, description, [name](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), name);
        return arguments;
    });
}

}  // namespace

void add_bridge_command(CLI::App& app) {
    add_command(app, "bridge",
                "Speak ROS 2: the map in MoveIt and RViz, joint states and depth images from topics",
                with_command);
}

void add_view_command(CLI::App& app) {
    add_same_command(app, "view",
                     "Show the map live, or a recording, in a browser, and to Foxglove and Lichtblick");
}

void add_export_command(CLI::App& app) {
    add_same_command(app, "export",
                     "Write a recording as an MCAP file for Foxglove, PlotJuggler, Rerun and ros2 bag");
}

}  // namespace octoskin::app
