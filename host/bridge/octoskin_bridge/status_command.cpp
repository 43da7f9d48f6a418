// octoskin bridge status
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"

namespace octoskin::bridge {
namespace {

using Json = nlohmann::ordered_json;

struct StatusOptions {
    std::filesystem::path socket = default_bridge_socket();
    bool is_json = false;
};

void print_for_people(const Json& status) {
    const Json& network = status.at("network");
    app::print("{}: {} other participants, {} topics with readers\n",
               network.at("description").get<std::string>(), network.at("participants").get<std::uint64_t>(),
               network.at("matched_topics").get<std::uint64_t>());
    for (const Json& topic : status.at("topics"))
        if (topic.at("readers").get<std::uint64_t>() > 0)
            app::print("{:<40} {} readers, {} sent\n", topic.at("topic").get<std::string>(),
                       topic.at("readers").get<std::uint64_t>(), topic.at("sent").get<std::uint64_t>());
    const Json& joints = status.at("joint_states");
    app::print("joint states: {} received, {} forwarded\n", joints.at("received").get<std::uint64_t>(),
               joints.at("forwarded").get<std::uint64_t>());
    for (const Json& camera : status.at("cameras"))
        app::print("{}: {} images received, {} sent to the daemon, {} lost\n",
                   camera.at("topic").get<std::string>(), camera.at("received").get<std::uint64_t>(),
                   camera.at("sent").get<std::uint64_t>(), camera.at("lost").get<std::uint64_t>());
    if (status.at("problems").empty()) app::print("no problems\n");
    for (const Json& problem : status.at("problems")) app::print("! {}\n", problem.get<std::string>());
}

void show_status(const StatusOptions& options) {
    auto answer = ask_daemon(options.socket, "status");
    if (!answer) {
        AppError error = answer.error();
        if (error.error.code == ErrorCode::no_listener || error.error.code == ErrorCode::not_found)
            error.error = {
                .code = ErrorCode::no_listener,
                .what = "no bridge listens there",
                .remedy = "start octoskin bridge, or name its place with --socket (its --status-socket)",
                .file = options.socket};
        throw app::CommandFailure(error);
    }
    const Json status = Json::parse(*answer, nullptr, false);
    if (!status.is_object() || !status.contains("network"))
        throw app::CommandFailure(foreign_answer(options.socket));
    options.is_json ? app::print_json(status.dump(2) + "\n") : print_for_people(status);
}

}  // namespace

void add_status_command(CLI::App& app) {
    auto options = std::make_shared<StatusOptions>();
    CLI::App* command = app.add_subcommand("status", "Print the status of a running bridge");
    command->add_flag("--json", options->is_json, "Print all of it, for a script");
    command->add_option("--socket", options->socket, "Status socket of the bridge")->capture_default_str();
    command->callback([options] { show_status(*options); });
}

}  // namespace octoskin::bridge
