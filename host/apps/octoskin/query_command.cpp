// octoskin query: may the arm stand so, go there; and where has nobody looked?
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/octoskin/arguments.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/octoskin/standard_output.hpp"
#include "host/apps/querying/query_answer.hpp"
#include "host/apps/querying/query_request.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFooter =
    "Exit codes: 0 all of it is free (or, with --unknown, pockets are listed); 1 something occupied is in "
    "the\n"
    "way; 2 nothing is, but something unknown or stale; 64 command line, joints beyond their limits; 65 a "
    "map or "
    "path\n"
    "that cannot be used, not the answer of a daemon of this version; 66 no such file; 69 no daemon, or "
    "nobody\n"
    "knows how the arm stands; 74 the daemon does not answer; 78 the rig.\n"
    "An answer tells links, voxels and distances: docs/planner.md.";

struct QueryOptions {
    std::filesystem::path map;
    std::filesystem::path rig;
    std::filesystem::path robot;
    std::filesystem::path socket = default_control_socket();
    std::optional<std::string> joints;
    std::string path;
    bool is_json = false;
    bool lists_unknown = false;
    std::optional<double> own_space_m;
    std::optional<double> z_min_m;
    QueryRequest request;
};

/// Numbers with commas or blanks between them; empty if something else is among them.
std::optional<std::vector<double>> numbers_of(std::string line) {
    for (char& c : line)
        if (c == ',' || c == ';') c = ' ';
    std::istringstream words(line);
    std::vector<double> numbers;
    for (std::string word; words >> word;) {
        std::size_t end = 0;
        try {
            numbers.push_back(std::stod(word, &end));
        } catch (const std::exception&) {
            return std::nullopt;
        }
        if (end != word.size()) return std::nullopt;
    }
    return numbers;
}

/// A configuration a line; empty lines and those that begin with # are none.
std::vector<std::vector<double>> read_path(std::istream& stream, const std::string& name) {
    std::vector<std::vector<double>> path;
    std::size_t number = 0;
    for (std::string line; std::getline(stream, line);) {
        ++number;
        if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
        const auto configuration = numbers_of(line);
        if (!configuration || path.size() >= kConfigurationsMax) {
            throw CommandFailure(
                {ExitCode::bad_data,
                 fmt::format("{}:{}: {}", name, number,
                             configuration ? fmt::format("more than {} configurations", kConfigurationsMax)
                                           : "expected a joint configuration: numbers and commas")});
        }
        path.push_back(*configuration);
    }
    if (path.empty()) throw CommandFailure({ExitCode::bad_data, name + ": no joint configuration in it"});
    return path;
}

QueryRequest request_of(const QueryOptions& options) {
    QueryRequest request = options.request;
    request.kind = options.lists_unknown ? QueryKind::pockets : QueryKind::postures;
    request.own_space_m = options.own_space_m;
    request.z_min_m = options.z_min_m;
    if (options.joints) {
        const auto position = numbers_of(*options.joints);
        if (!position || position->empty())
            throw CommandFailure({ExitCode::usage, "--joints '" + *options.joints +
                                                       "': expected numbers with commas between them"});
        request.path = {*position};
    } else if (options.path == "-") {
        request.path = read_path(std::cin, "standard input");
    } else if (!options.path.empty()) {
        std::ifstream file(options.path);
        if (!file)
            throw CommandFailure(
                reading_error(options.path, {ExitCode::no_input, options.path + ": cannot be read"}));
        request.path = read_path(file, options.path);
    }
    if (const std::string fault = fault_of(request); !fault.empty())
        throw CommandFailure({ExitCode::usage, fault});
    return request;
}

Json ask_map_file(const QueryOptions& options, const QueryRequest& request) {
    if (options.rig.empty())
        throw CommandFailure({ExitCode::usage,
                              "a map file does not say what robot is asked about: give --rig, "
                              "the one that the map was made with"});
    const rig::Rig rig = value_or_fail(read_given_rig(options.rig, options.robot));
    const auto setup = make_host_setup(rig);
    if (!setup) throw CommandFailure(reading_error(ExitCode::bad_config, setup.error()));
    MapReadLimits limits;
    limits.map.log_odds_min = -20.0F;  // whoever made it may have clamped wider
    limits.map.log_odds_max = 20.0F;
    auto map = load_map(options.map, limits);
    if (!map) throw CommandFailure(reading_error(options.map, {ExitCode::bad_data, map.error().message}));
    KeptField field;
    return answer_query(request, {&setup->rig, &setup->robot, std::move(map).value(), {}, &field});
}

Json ask_running_daemon(const QueryOptions& options, const QueryRequest& request) {
    const std::string line = to_line(request);
    if (line.size() > ControlSocket::kRequestMax)
        throw CommandFailure(
            {ExitCode::usage,
             fmt::format("the path takes {} bytes as a request; a daemon takes {}: ask about "
                         "parts of it, or write its numbers with fewer digits",
                         line.size(), ControlSocket::kRequestMax)});
    const auto answer = ask_daemon(options.socket, line, std::chrono::seconds(60));
    if (!answer) throw CommandFailure(answer.error());
    Json json = Json::parse(*answer, nullptr, false);
    if (!json.is_object() || !json.contains("ok")) throw CommandFailure(foreign_answer(options.socket));
    return json;
}

ExitCode outcome_of(const Json& answer) {
    if (answer.contains("pockets") || answer.at("state") == "free") return ExitCode::ok;
    return answer.at("state") == "occupied" ? ExitCode::failed : ExitCode::uncertain;
}

void ask(const QueryOptions& options) {
    const QueryRequest request = request_of(options);
    const Json answer =
        options.map.empty() ? ask_running_daemon(options, request) : ask_map_file(options, request);
    ExitCode outcome = ExitCode::ok;
    try {
        if (!answer.at("ok").get<bool>()) {
            const int code = answer.value("code", static_cast<int>(ExitCode::unavailable));
            throw CommandFailure({static_cast<ExitCode>(code), answer.at("error").get<std::string>()});
        }
        outcome = outcome_of(answer);
        print("{}", options.is_json ? answer.dump(2) + "\n" : query_text(answer));
    } catch (const Json::exception&) {
        throw CommandFailure(foreign_answer(options.socket));
    }
    if (outcome != ExitCode::ok) throw CLI::RuntimeError(static_cast<int>(outcome));
}

void add_posture_options(CLI::App& command, QueryOptions& options) {
    CLI::Option* const joints = command.add_option(
        "--joints", options.joints,
        "The joint configuration, rad (m for a prismatic joint), in the order of the rig's "
        "joints: 0,-0.785,0,...; without it as the arm stands (of a daemon)");
    command
        .add_option("--path", options.path,
                    "A file with a configuration a line, or '-'; what lies between two lines is asked about, "
                    "too")
        ->excludes(joints);
    command
        .add_option("--step", options.request.step, "No joint moves further between two postures asked about")
        ->check(from_to(kStepMin, 10.0))
        ->capture_default_str();
    command.add_option("--padding", options.request.padding_m, "Added to the radius of each capsule, m")
        ->check(from_to(0.0, 1.0))
        ->capture_default_str();
    command.add_option("--reach", options.request.reach_m, "How far distances are told, m; 0: none are")
        ->check(from_to(0.0, kReachMax_m))
        ->capture_default_str();
    command.add_option("--ignore-link", options.request.links_ignored, "A link that is not asked about")
        ->allow_extra_args(false);
    command.add_flag("--all-links", options.request.asks_unmoved_links,
                     "Ask about bodies that no joint moves, too: the arm's base");
    command
        .add_option(
            "--own-space", options.own_space_m,
            "What lies within the arm as it stands (of a map file: where the path begins), and what is "
            "unknown within so many metres of it, counts as free. Give it where nothing can hide "
            "there")
        ->check(from_to(0.0, 1.0));
}

void add_pocket_options(CLI::App& command, QueryOptions& options) {
    command.add_flag("--unknown", options.lists_unknown,
                     "List the largest pockets of unknown space about the robot's base that border on free "
                     "space, and how the arm would have to stand so that a sensor looks into them");
    command.add_option("--radius", options.request.radius_m, "With --unknown: of the ball about the base, m")
        ->check(from_to(0.05, kRadiusMax_m))
        ->capture_default_str();
    command
        .add_option("--above", options.z_min_m,
                    "With --unknown: from this height on, m in the map (the base's)")
        ->check(from_to(-1000.0, 1000.0));
    command.add_option("--pockets", options.request.pockets_max, "With --unknown: list so many at most")
        ->check(from_to(std::size_t{0}, kConfigurationsMax))
        ->capture_default_str();
    command
        .add_option("--tries", options.request.views_tried,
                    "With --unknown: try so many postures of the arm; 0: none")
        ->check(from_to(std::size_t{0}, kViewsTriedMax))
        ->capture_default_str();
}

}  // namespace

void add_query_command(CLI::App& app) {
    auto options = std::make_shared<QueryOptions>();
    CLI::App* command = app.add_subcommand("query",
                                           "Is a posture or a path of the arm free, stale, unknown or "
                                           "occupied, how far is what is in the way, and "
                                           "how old is what that rests on");
    command
        ->add_option("map", options->map, "A saved map (.ot or .bt); without it the running daemon is asked")
        ->check(existing_file());
    command->add_option("--rig", options->rig, "Of a map file: the rig that it was made with")
        ->check(existing_file());
    command->add_option("--robot", options->robot, "Of a map file: URDF in place of the rig's")
        ->check(existing_file());
    add_posture_options(*command, *options);
    add_pocket_options(*command, *options);
    command->add_option("--socket", options->socket, "Where the daemon listens")->capture_default_str();
    command->add_flag("--json", options->is_json, "For a script");
    command->footer(kFooter);
    command->callback([options] { ask(*options); });
}

}  // namespace octoskin::app
