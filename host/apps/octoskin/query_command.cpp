// octoskin query: is a posture or a path of the arm free, and where is space unknown?
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/playback/map_provenance.hpp"
#include "host/apps/query/joint_lines.hpp"
#include "host/apps/query/query_answer.hpp"
#include "host/apps/query/query_request.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFooter =
    "Exit codes: 0 all of it is free (or, with --unknown, pockets are listed); 1 something occupied is in\n"
    "the way; 2 nothing occupied is, but something is unknown or stale, or a link of the arm has no body;\n"
    "64 command line, joints beyond their limits; 65 a map or path that cannot be used, or the answer is\n"
    "not of a daemon of this version; 66 no such file; 69 no daemon, or the joint state is not known;\n"
    "74 the daemon does not answer; 78 the rig.\n"
    "The links, voxels and distances of an answer: docs/how-to/query.md.";

struct QueryOptions {
    std::optional<std::string> map;  ///< empty: the daemon is asked
    std::optional<std::string> rig;
    std::optional<std::string> robot;
    std::vector<PackagePath> packages;
    std::filesystem::path socket = default_control_socket();
    std::optional<std::string> joints;
    std::optional<std::string> stands;
    std::optional<std::string> path;
    bool is_json = false;
    bool lists_unknown = false;
    std::optional<double> own_space_m;
    std::optional<double> z_min_m;
    QueryRequest request;
};

struct Question {
    QueryRequest request;
    std::vector<double> stands;      ///< of a map file: the arm's posture; empty: not known
    std::vector<std::size_t> lines;  ///< of the path's file, one for each configuration; empty: there is none
};

AppError missing_name(const char* option) {
    return {ExitCode::usage,
            {.code = ErrorCode::bad_argument,
             .what = "the file name is missing (is a variable of the shell empty?)",
             .key = option}};
}

/// An empty name is a variable that is not set, not an option that was left out.
void check_file(const char* option, const std::optional<std::string>& file) {
    if (!file) return;
    if (file->empty()) throw CommandFailure(missing_name(option));
    std::string name = *file;
    (void)existing_file()(name);  // throws
}

/// An option without effect is refused: its user expects another answer.
void check_options(const CLI::App& command, const QueryOptions& options) {
    const auto refuse = [&command](std::initializer_list<const char*> names, const char* why,
                                   const char* remedy) {
        for (const char* name : names)
            if (command.count(name) > 0)
                throw CommandFailure(
                    ExitCode::usage,
                    {.code = ErrorCode::conflict, .what = why, .remedy = remedy, .key = name});
    };
    if (!options.map) {
        refuse({"--rig", "--robot", "--package-path"}, "is for a map file, and a daemon uses its own",
               "leave it out, or name the map");
        refuse({"--stands"}, "is for a map file, and a daemon uses the arm's present posture",
               "leave it out, or name the map");
    } else {
        refuse({"--socket"}, "is where a daemon listens, but a map file is given",
               "leave out one of the two");
    }
    if (options.lists_unknown) {
        refuse({"--path"}, "with --unknown, views are searched from one posture", "give it as --joints");
        refuse({"--reach"}, "--unknown gives no distances", "leave it out");
    } else {
        refuse({"--radius", "--above", "--pockets", "--tries"}, "is for --unknown",
               "give --unknown, too, or leave it out");
    }
    if (options.socket.empty()) throw CommandFailure(missing_name("--socket"));
    check_file("map", options.map);
    check_file("--rig", options.rig);
    check_file("--robot", options.robot);
}

std::vector<double> read_joints(const char* option, const std::string& text) {
    const auto numbers = read_numbers(text);
    if (numbers && !numbers->empty()) return *numbers;
    Error error = field_error(numbers ? "" : numbers.error());
    error.key = fmt::format("{} '{}'", option, text);
    throw CommandFailure(ExitCode::usage, std::move(error));
}

JointPath read_path(const std::string& name) {
    if (name == "-") return value_or_fail(read_joint_path(std::cin, "standard input"));
    std::error_code error;
    if (std::filesystem::is_directory(name, error))
        throw CommandFailure(ExitCode::usage,
                             in_file({ErrorCode::wrong_kind_of_file,
                                      "is a directory, not a file with one configuration a line"},
                                     name));
    std::ifstream file(name);
    if (!file)
        throw CommandFailure(reading_error(
            name,
            {ExitCode::no_input, in_file({errno == ENOENT ? ErrorCode::not_found : ErrorCode::system_error,
                                          fmt::format("cannot be read: {}", std::strerror(errno))},
                                         name)}));
    return value_or_fail(read_joint_path(file, name));
}

/// Without the arm's posture, the queried posture would free its own space and be "free" on an empty map. A
/// path of several configurations begins at the arm's posture, and so do the ways to views.
void check_own_space(const QueryOptions& options, const Question& question) {
    if (!options.map || !options.own_space_m || options.stands || options.lists_unknown) return;
    if (question.request.path.size() > 1) return;
    throw CommandFailure(ExitCode::usage,
                         {.code = ErrorCode::bad_argument,
                          .what = "with a map file needs the arm's posture: else the queried posture would "
                                  "count as the arm's own space, and be free whatever the map contains",
                          .remedy = "give --stands, the arm's posture in the map",
                          .key = "--own-space"});
}

Question question_of(const QueryOptions& options) {
    Question question{options.request, {}, {}};
    QueryRequest& request = question.request;
    request.kind = options.lists_unknown ? QueryKind::pockets : QueryKind::postures;
    request.own_space_m = options.own_space_m;
    request.z_min_m = options.z_min_m;
    if (options.stands) question.stands = read_joints("--stands", *options.stands);
    if (options.joints) request.path = {read_joints("--joints", *options.joints)};
    if (options.path) {
        JointPath path = read_path(*options.path);
        request.path = std::move(path.configurations);
        question.lines = std::move(path.lines);
    }
    if (auto fault = fault_of(request)) throw CommandFailure(ExitCode::usage, std::move(*fault));
    check_own_space(options, question);
    return question;
}

/// Warns if the map was made with another rig. The map of a replay names its rig.
void doubt_rig(const QueryOptions& options, const rig::Rig& rig) {
    const auto origin = origin_of_map(*options.map);
    if (!origin) {
        spdlog::warn("{}; so it is not known whether {} is the rig that the map was made with",
                     origin.error().message(), *options.rig);
    } else if (*origin && (*origin)->rig_hash != rig::rig_hash(rig)) {
        spdlog::warn(
            "{} is another rig than {}, which the map was made with: the answer may be of another arm, or of "
            "another place",
            *options.rig, (*origin)->rig.string());
    }
}

Json ask_map_file(const QueryOptions& options, const Question& question) {
    if (!options.rig)
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                               .what = "is required: a map file does not contain the robot",
                                               .remedy = "give the rig that the map was made with",
                                               .key = "--rig"});
    const rig::Rig rig = value_or_fail(read_rig_with_body(
        *options.rig, {options.robot.value_or(""), options.packages}, BodyFitting::if_needed));
    const auto setup = make_host_setup(rig);
    if (!setup) throw CommandFailure(reading_error(ExitCode::bad_config, setup.error()));
    MapReadLimits limits;
    limits.map.log_odds_min = -20.0F;  // the map may have been made with wider limits
    limits.map.log_odds_max = 20.0F;
    doubt_rig(options, rig);
    auto map = load_map(*options.map, limits);
    if (!map) throw CommandFailure(reading_error(*options.map, {ExitCode::bad_data, map.error()}));
    for (const std::string& warning : map->warnings) spdlog::warn("{}", warning);
    KeptField field;
    return answer_query(question.request,
                        {&setup->rig, &setup->robot, std::move(map->map), question.stands, &field});
}

Json ask_running_daemon(const QueryOptions& options, const QueryRequest& request) {
    const std::string line = to_line(request);
    if (line.size() > ControlSocket::kRequestMax)
        throw CommandFailure(
            ExitCode::usage,
            {.code = ErrorCode::too_large,
             .what = fmt::format("a daemon accepts requests of at most {} bytes", ControlSocket::kRequestMax),
             .value = fmt::format("a path that takes {} bytes", line.size()),
             .remedy = "query parts of the path, or write its numbers with fewer digits",
             .key = "--path"});
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

/// An answer that is an error, for one of the path's configurations or (0) for all of it.
class Refusal : public CommandFailure {
  public:
    Refusal(AppError error, std::size_t configuration)
        : CommandFailure(std::move(error)), configuration_(configuration) {}
    [[nodiscard]] std::size_t configuration() const noexcept { return configuration_; }

  private:
    std::size_t configuration_;
};

/// The error in the answer, with the line of the path that it is about.
Refusal refusal(const QueryOptions& options, const Question& question, const Json& answer) {
    auto refused = refusal_of(answer);
    if (!refused) refused = foreign_answer(options.socket);
    const std::size_t configuration = answer.value("configuration", std::size_t{0});
    if (configuration > 0 && configuration <= question.lines.size())
        refused->error =
            in_file(std::move(refused->error), options.path == "-" ? "standard input" : *options.path,
                    static_cast<int>(question.lines[configuration - 1]));
    return {std::move(*refused), configuration};
}

/// The usual reason why little is free, for users who do not know it.
std::string hint(const QueryOptions& options, const Json& answer) {
    const std::string hint = fmt::format(
        "(No sensor sees the space of the arm itself, and all of it is unknown: with --own-space M{}, what "
        "is unknown or stale within M metres of the arm counts as free.)\n",
        options.map ? " and --stands JOINTS, its posture" : "");
    if (options.own_space_m || !answer.at("links_unknown").empty()) return {};
    if (!answer.contains("pockets")) {
        const Json& state = answer.at("state");
        return state == "unknown" || state == "stale" ? hint : std::string();
    }
    const bool lacks_views = answer.at("views_not_tried").is_null() &&
                             std::ranges::any_of(answer.at("pockets"), [](const Json& pocket) {
                                 return pocket.at("view").is_null();
                             });
    return lacks_views ? hint : std::string();
}

ExitCode answered(const QueryOptions& options) {
    const Question question = question_of(options);
    const Json answer =
        options.map ? ask_map_file(options, question) : ask_running_daemon(options, question.request);
    try {
        if (!answer.at("ok").get<bool>()) throw refusal(options, question, answer);
        const ExitCode outcome = outcome_of(answer);
        const std::string text = query_text(answer) + hint(options, answer);  // refuses a foreign answer
        options.is_json ? print_json(answer.dump(2) + "\n") : print_text(text);
        return outcome;
    } catch (const Json::exception&) {
        throw CommandFailure(foreign_answer(options.socket));
    }
}

/// For a script; the sentence follows on standard error.
void print_refusal(const CommandFailure& failure, std::size_t configuration) {
    Json refused = query_refused(failure.error());
    if (configuration > 0) refused["configuration"] = configuration;
    print_json(refused.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void ask(const CLI::App& command, const QueryOptions& options) {
    ExitCode outcome = ExitCode::ok;
    try {
        check_options(command, options);
        outcome = answered(options);
    } catch (const Refusal& refused) {
        if (options.is_json) print_refusal(refused, refused.configuration());
        throw;
    } catch (const CommandFailure& failure) {
        if (options.is_json) print_refusal(failure, 0);
        throw;
    }
    if (outcome != ExitCode::ok) throw CLI::RuntimeError(static_cast<int>(outcome));
}

void add_posture_options(CLI::App& command, QueryOptions& options) {
    CLI::Option* const joints =
        command
            .add_option("--joints", options.joints,
                        "The joint configuration: plain numbers with commas between them, rad (m for a "
                        "prismatic joint), one for each of the rig's joints in their order, such as "
                        "0,-0.785,0,-2.356,0,1.571,0.785; without it, the arm's present posture")
            ->type_name("JOINTS");
    command
        .add_option("--path", options.path,
                    "A file with one such configuration a line, or '-' for standard input: at most 1000, in "
                    "1 MiB; the motion between two lines is checked, too")
        ->type_name("FILE")
        ->excludes(joints);
    command
        .add_option("--step", options.request.step,
                    "For a path: between two checked postures no joint moves further than this, rad (m), and "
                    "no link further than half a voxel")
        ->check(from_to(kStepMin, 10.0))
        ->capture_default_str();
    command.add_option("--padding", options.request.padding_m, "Added to the radius of each capsule, m")
        ->check(from_to(0.0, 1.0))
        ->capture_default_str();
    command.add_option("--reach", options.request.reach_m, "Give distances up to this one, m; 0: none")
        ->check(from_to(0.0, kReachMax_m))
        ->capture_default_str();
    command
        .add_option("--ignore-link", options.request.links_ignored,
                    "A link of the robot that is left out; once for each such link")
        ->type_name("LINK")
        ->expected(1)
        ->take_all();
    command.add_flag("--all-links", options.request.asks_unmoved_links,
                     "Include bodies that no joint moves: the arm's base");
    command
        .add_option("--own-space", options.own_space_m,
                    "At the arm's present posture, occupied space counts as free where only the arm can be; "
                    "unknown and stale space counts as free within this many metres of the arm. Give it only "
                    "if nothing can hide that close")
        ->check(from_to(0.0, 1.0));
    command
        .add_option("--min-evidence", options.request.min_evidence,
                    "Free space counts as unknown with less than this many images and ranges behind it; of a "
                    "camera alone a voxel has 5 at most (with the default mapping)")
        ->check(from_to(0.0, kMinEvidenceMax))
        ->capture_default_str();
    command
        .add_option("--stands", options.stands,
                    "For a map file: the arm's posture, as --joints; without it, the beginning of --path. A "
                    "daemon uses the present posture")
        ->type_name("JOINTS");
}

void add_pocket_options(CLI::App& command, QueryOptions& options) {
    command.add_flag("--unknown", options.lists_unknown,
                     "List the largest pockets of unknown space about the robot's base that border on free "
                     "space, and postures of the arm from which a sensor looks into them");
    command
        .add_option("--radius", options.request.radius_m,
                    "With --unknown: within this many metres of the robot's base")
        ->check(from_to(0.05, kRadiusMax_m))
        ->capture_default_str();
    command
        .add_option(
            "--above", options.z_min_m,
            "With --unknown: from this height in the map on, m; without it, from the height of the base")
        ->check(from_to(-1000.0, 1000.0));
    command.add_option("--pockets", options.request.pockets_max, "With --unknown: list at most this many")
        ->check(from_to(std::size_t{0}, kConfigurationsMax))
        ->capture_default_str();
    command
        .add_option("--tries", options.request.views_tried,
                    "With --unknown: try this many postures of the arm; 0: none, no view is searched")
        ->check(from_to(std::size_t{0}, kViewsTriedMax))
        ->capture_default_str();
}

}  // namespace

void add_query_command(CLI::App& app) {
    auto options = std::make_shared<QueryOptions>();
    CLI::App* command =
        app.add_subcommand("query",
                           "Check whether a posture or a path of the arm is free, stale, unknown or "
                           "occupied; with the distance to obstacles and the age of the measurements");
    // Existence of the files is checked with the question, so that --json reports it, too.
    command
        ->add_option("map", options->map, "A saved map (.ot or .bt); without it the running daemon is asked")
        ->type_name("FILE");
    command->add_option("--rig", options->rig, "For a map file: the rig that it was made with")
        ->type_name("FILE");
    command->add_option("--robot", options->robot, "For a map file: URDF in place of the rig's")
        ->type_name("FILE");
    add_package_paths(*command, options->packages);
    add_posture_options(*command, *options);
    add_pocket_options(*command, *options);
    command->add_option("--socket", options->socket, "Control socket of the daemon")
        ->type_name("FILE")
        ->capture_default_str();
    command->add_flag(
        "--json", options->is_json,
        "For a script: the answer as the daemon gives it, or an object with \"error\" and the \"exit\" "
        "code");
    command->footer(kFooter);
    command->callback([options, command] { ask(*command, *options); });
}

}  // namespace octoskin::app
