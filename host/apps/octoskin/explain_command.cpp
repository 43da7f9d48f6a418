// octoskin explain: which measurements gave a voxel its state.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/explain/explanation.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/playback/playback_options.hpp"

namespace octoskin::app {
namespace {

struct ExplainOptions {
    std::array<double, 3> p_map{};
    PlaybackOptions playback;
    std::size_t lines = 20;
    bool is_json = false;
};

void explain_voxel(const ExplainOptions& options) {
    if (options.playback.recording.empty()) {
        throw CommandFailure(
            ExitCode::usage,
            {.code = ErrorCode::bad_argument,
             .what = "is required",
             .remedy = "give the directory that `octoskin record` (with a running daemon) or "
                       "`octoskin-lab simulate` made",
             .key = "--recording"});
    }
    const auto explanation = explain(playback_request(options.playback),
                                     {options.p_map[0], options.p_map[1], options.p_map[2]}, options.lines);
    if (!explanation) throw CommandFailure(explanation.error());
    for (const std::string& warning : explanation->warnings) spdlog::warn("{}", warning);
    if (options.is_json) {
        print_json(
            to_json(*explanation).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
            "\n");
    } else {
        print_text(to_text(*explanation));
    }
    if (explanation->lost) throw CommandFailure(*explanation->lost);
}

}  // namespace

void add_explain_command(CLI::App& app) {
    auto options = std::make_shared<ExplainOptions>();
    CLI::App* command = app.add_subcommand(
        "explain", "List the readings and depth frames of a recording that gave a voxel its state");
    command->add_option("x", options->p_map[0], "The point, metres in the map frame")->required();
    command->add_option("y", options->p_map[1])->required();
    command->add_option("z", options->p_map[2])->required();
    command->add_option(
        "--recording", options->playback.recording,
        "Directory of the recording, as `octoskin record` and `octoskin-lab simulate` make it (required)");
    add_playback_options(*command, options->playback);
    command->add_option("--lines", options->lines, "List at most this many contributions, the newest ones")
        ->check(from_to(0, 1'000'000))
        ->capture_default_str();
    command->add_flag("--json", options->is_json, "For a script");
    command->callback([options] { explain_voxel(*options); });
}

}  // namespace octoskin::app
