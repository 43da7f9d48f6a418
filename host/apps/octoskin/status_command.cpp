// octoskin status: what the daemon says of itself.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/octoskin/commands.hpp"

namespace octoskin::app {
namespace {

struct StatusOptions {
    std::filesystem::path socket = default_control_socket();
    bool is_json = false;
};

void print_for_people(const nlohmann::ordered_json& status) {
    fmt::print("{}\nrig '{}' on {} ({}), {:.0f} s\n", status["octoskin"].get<std::string>(),
               status["rig"].get<std::string>(), status["can"]["interface"].get<std::string>(),
               status["can"]["state"].get<std::string>(), status["uptime_s"].get<double>());
    for (const auto& node : status["nodes"]) {
        fmt::print("node {:>2} {:<16} {}\n", node["id"].get<int>(), node["name"].get<std::string>(),
                   node["verdict"].get<std::string>());
    }
    fmt::print("map: {} known voxels\n", status["map"]["known_voxels"].get<std::uint64_t>());
    if (status["problems"].empty()) fmt::print("no problems\n");
    for (const auto& problem : status["problems"]) fmt::print("! {}\n", problem.get<std::string>());
}

void show_status(const StatusOptions& options) {
    const auto answer = ask_daemon(options.socket, "status");
    if (!answer) throw CommandFailure(answer.error());
    const auto status = nlohmann::ordered_json::parse(*answer, nullptr, false);
    if (status.is_discarded())
        throw CommandFailure({ExitCode::bad_data, options.socket.string() + ": answered no JSON"});
    if (options.is_json) {
        fmt::print("{}\n", status.dump(2));
    } else {
        print_for_people(status);
    }
}

}  // namespace

void add_status_command(CLI::App& app) {
    auto options = std::make_shared<StatusOptions>();
    CLI::App* command = app.add_subcommand("status", "What the daemon (`octoskin run`) says of itself");
    command->add_flag("--json", options->is_json, "All of it, for a script");
    command->add_option("--socket", options->socket, "Where the daemon listens")->capture_default_str();
    command->callback([options] { show_status(*options); });
}

}  // namespace octoskin::app
