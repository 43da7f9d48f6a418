// octoskin status: the daemon's status.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/json_at.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/core/rig/camera_text.hpp"

namespace octoskin::app {
namespace {

namespace fs = std::filesystem;

struct StatusOptions {
    std::filesystem::path socket = default_control_socket();
    bool is_json = false;
};

void print_for_people(const nlohmann::ordered_json& status) {
    print("{}\nrig '{}' on {} ({}), {:.0f} s\n", status.at("octoskin").get<std::string>(),
          status.at("rig").get<std::string>(), status.at("can").at("interface").get<std::string>(),
          status.at("can").at("state").get<std::string>(), status.at("uptime_s").get<double>());
    for (const auto& node : status.at("nodes")) {
        print("node {:>2} {:<16} {}\n", node.at("id").get<int>(), node.at("name").get<std::string>(),
              node.at("verdict").get<std::string>());
    }
    for (const auto& camera : status.at("cameras")) {
        const auto& age = camera.at("age_s");
        print("{:<24} {}{}\n", camera_text(camera.at("name").get<std::string>()),
              camera.at("open").get<bool>() ? "open" : "closed: " + camera.at("why").get<std::string>(),
              age.is_null() ? std::string() : fmt::format(", newest image {:.1f} s old", age.get<double>()));
    }
    print("map: {} known voxels\n", status.at("map").at("known_voxels").get<std::uint64_t>());
    if (const auto socket = status.find("joints_socket");
        socket != status.end() && !socket->is_null() && socket->at("above_rate").get<bool>())
        print(
            "joint states: {:.0f} Hz through the socket, more than the rig's rate: the surplus is left out\n",
            socket->at("rate_hz").get<double>());
    if (status.at("problems").empty()) print("no problems\n");
    for (const auto& problem : status.at("problems")) print("! {}\n", problem.at("text").get<std::string>());
}

/// The bridge to ROS 2, if one runs at its default place.
void print_bridge() {
    constexpr std::chrono::milliseconds kPatience{500};
    const fs::path socket = default_bridge_socket();
    std::error_code error;
    if (!fs::exists(socket, error)) return;
    const auto answer = ask_daemon(socket, "status", kPatience);
    const auto status = nlohmann::ordered_json::parse(answer ? *answer : std::string(), nullptr, false);
    const auto& network = at(status, "network");
    if (!at(network, "participants").is_number_unsigned() ||
        !at(network, "matched_topics").is_number_unsigned())
        return;
    print("bridge: {} other ROS 2 participants, {} of its topics have readers (octoskin bridge status)\n",
          network["participants"].get<std::uint64_t>(), network["matched_topics"].get<std::uint64_t>());
    const auto& problems = at(status, "problems");
    if (!problems.is_array()) return;
    for (const auto& problem : problems)
        if (problem.is_string()) print("! bridge: {}\n", problem.get<std::string>());
}

void show_status(const StatusOptions& options) {
    const auto status = ask_status(options.socket);
    if (!status) throw CommandFailure(status.error());
    if (options.is_json) return print_json(status->dump(2) + "\n");
    print_for_people(*status);
    print_bridge();
}

}  // namespace

void add_status_command(CLI::App& app) {
    auto options = std::make_shared<StatusOptions>();
    CLI::App* command = app.add_subcommand("status", "Print the status of the daemon (`octoskin run`)");
    command->add_flag("--json", options->is_json, "Print all of it, for a script");
    command->add_option("--socket", options->socket, "Control socket of the daemon")->capture_default_str();
    command->callback([options] { show_status(*options); });
}

}  // namespace octoskin::app
