// octoskin-lab evaluate: a recording or a map against the world it was made in.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <optional>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/shipped_file.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/playback/data_set_playback.hpp"
#include "host/apps/playback/map_provenance.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/profile/named_mapping.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/apps/robot/given_robot.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/lab/evaluation/results.hpp"
#include "host/lab/evaluation/survey.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "host/lab/octoskin_lab/commands.hpp"
#include "host/lab/octoskin_lab/model_path.hpp"
#include "host/lab/octoskin_lab/recorded_scene.hpp"
#include "host/lab/study/judged_maps.hpp"
#include "host/lab/study/study.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::app {
namespace {

struct EvaluateOptions {
    std::filesystem::path input;
    std::filesystem::path rig;
    GivenRobot robot;
    std::filesystem::path scenario;
    std::filesystem::path world;
    std::filesystem::path json;
    std::filesystem::path recording;
    std::string configuration = kDefaultMapping;
};

/// A data set has no world file to judge its maps against.
[[noreturn]] void refuse_data_set(const std::filesystem::path& data_set) {
    throw CommandFailure(ExitCode::usage,
                         {.code = ErrorCode::unsupported,
                          .what = "a data set has no ground truth of its world, so its maps cannot be judged",
                          .remedy = "look at them (octovis, or the .ply)",
                          .file = data_set});
}

Scene judged(Scene scene) {
    if (const auto still = check_stands_still(scene); !still) throw CommandFailure(still.error());
    return scene;
}

/// The scene of `recording`; files given in `options` replace its own.
Scene recorded_scene(const FilePlace& recording, const EvaluateOptions& options) {
    auto found = read_recorded_scene(recording, {options.scenario, options.world});
    if (!found) throw CommandFailure(found.error());
    for (const std::string& warning : found->warnings) spdlog::warn("{}", warning);
    return judged(std::move(found->scene));
}

evaluation::Truth build(const Scene& scene, const rig::Rig& rig, double resolution_m) {
    spdlog::info("judging in {}, {}", scene.world_file.file.string(), scene.scenario_file.file.string());
    evaluation::TruthConfig config = truth_config_of(scene.scenario, resolution_m);
    config.external_cameras = rig.external_cameras();
    if (const auto fault = evaluation::region_fault(config.region, resolution_m, rig.T_map_base))
        throw CommandFailure(ExitCode::bad_config, scene.scenario.error("region", *fault));
    spdlog::info("ground truth: rendering the tour of a noise-free camera");
    auto truth = evaluation::build_truth(
        scene.world, evaluation::render_survey(scene.world, survey_config_of(scene.scenario)), config,
        rig.T_map_base);
    if (!truth) throw CommandFailure(ExitCode::bad_config, scene.scenario.error("region", truth.error()));
    return std::move(*truth);
}

bool is_papers(const rig::Rig& rig, const Scene& scene) {
    std::error_code error;
    const auto& world = scene.world_file.file;
    const bool is_own_world = std::filesystem::equivalent(world, scene.scenario.world.shown(), error);
    return is_papers_experiment(rig, scene.scenario_file.file, is_own_world ? std::filesystem::path() : world,
                                shipped_file("hw/worlds/experiment.scenario.yaml"));
}

/// The figures and their provenance.
evaluation::Results results_of(const std::vector<evaluation::Run>& runs, const rig::Rig& rig,
                               const Scene& scene, const FilePlace& rig_file) {
    auto results =
        evaluation::collect(runs, {}, provenance_of(scene, source_file(rig_file, rig.extended_files)));
    results.is_papers_experiment = is_papers(rig, scene);
    return results;
}

struct Judged {
    evaluation::Results results;
    std::optional<AppError> lost =
        std::nullopt;  ///< set if most of the recording was lost, although there are figures
};

Judged judge_recording(const EvaluateOptions& options) {
    const auto configuration = named_mapping(options.configuration);
    if (!configuration) throw CommandFailure(configuration.error());
    const MappingConfig& mapping = configuration->mapping;
    const RecordingPaths recording(options.input);
    const PlaybackRequest request{
        .recording = recording,
        .mapping = mapping,
        .configuration = configuration->name,
        .maps = every_feed(),
        .rig = options.rig,
        .robot = options.robot,
        .warn_first = [](const std::string& warning) { spdlog::warn("{}", warning); }};
    if (is_data_set(recording)) refuse_data_set(options.input);
    if (const auto checked = check_playable(request); !checked) throw CommandFailure(checked.error());
    const Scene scene = recorded_scene(options.input, options);
    const auto meta = read_meta(recording);
    if (!meta) throw CommandFailure(reading_error(ExitCode::bad_data, meta.error()));
    spdlog::info("replaying {}", options.input.string());
    const auto playback = play_recording(request);
    if (!playback) throw CommandFailure(playback.error());
    for (const std::string& warning : playback->warnings) spdlog::warn("{}", warning);
    if (const auto failure = failure_of(*playback)) throw CommandFailure(*failure);
    const evaluation::Truth truth = build(scene, playback->rig, mapping.map.resolution_m);
    const std::vector<evaluation::Run> runs =
        judge_maps(*playback, *configuration, meta->seed.value_or(0), truth);
    return {results_of(runs, playback->rig, scene,
                       options.rig.empty() ? recording.rig() : FilePlace(options.rig)),
            loss_of(*playback)};
}

/// Warns if `rig` is probably not the one that the map was made with.
void doubt_rig(const EvaluateOptions& options, const rig::Rig& rig, const MapProvenance& provenance) {
    const std::uint32_t hash = rig::rig_hash(rig);
    if (provenance.origin) {
        if (hash == provenance.origin->rig_hash) return;
        spdlog::warn("{} is another rig than {}, which the map was made with; the figures are wrong",
                     options.rig.string(), provenance.origin->rig.string());
        return;
    }
    if (!provenance.recording) return;
    const auto own = RecordingPaths(*provenance.recording).rig();
    const auto recorded = rig::read_rig(own);
    if (!recorded) {
        spdlog::warn("{}; it is unknown whether {} is the rig that the map was made with",
                     recorded.error().message(), options.rig.string());
    } else if (rig::rig_hash(*recorded) != hash) {
        spdlog::warn(
            "{} is another rig than {}, of the recording beside the map; unless the map was made with it, "
            "the figures are wrong",
            options.rig.string(), own.shown().string());
    }
}

/// The rig file to name in a remedy: the map's provenance, else the recording's rig.
std::string rig_to_give(const MapProvenance& provenance) {
    // The file is not opened: a map from an untrusted source could name any path.
    if (provenance.origin) return provenance.origin->rig.string();
    if (provenance.recording) {
        const FilePlace own = RecordingPaths(*provenance.recording).rig();
        if (own.is_file()) return own.shown().string();
    }
    return "RECORDING/rig.yaml";
}

/// The rig with the pose of the map's grid.
rig::Rig rig_of_map(const EvaluateOptions& options, const MapProvenance& provenance) {
    if (options.rig.empty()) {
        throw CommandFailure(
            ExitCode::usage,
            {.code = ErrorCode::bad_argument,
             .what = "is required: a map does not contain the poses of robot and camera",
             .remedy = "give --rig " + rig_to_give(provenance) + ", which has the map's shift (T_map_base)",
             .key = "--rig"});
    }
    rig::Rig rig = value_or_fail(read_given_rig(options.rig, options.robot.urdf));
    doubt_rig(options, rig, provenance);
    return rig;
}

Scene scene_of_map(const EvaluateOptions& options, const std::optional<FilePlace>& recording) {
    if (recording) return recorded_scene(*recording, options);
    if (options.scenario.empty()) {
        throw CommandFailure(ExitCode::usage,
                             {.code = ErrorCode::bad_argument,
                              .what = "no recording is beside this map, and a map does not name its world",
                              .remedy = "give --scenario (shipped: " +
                                        shipped_file("hw/worlds/experiment.scenario.yaml").string() +
                                        "), or --recording, the recording that it was made from",
                              .file = options.input,
                              .key = "--scenario"});
    }
    auto scene = read_scene(options.scenario, options.world);
    if (!scene) throw CommandFailure(scene.error());
    for (const std::string& warning : scene->world.warnings()) spdlog::warn("{}", warning);
    return judged(std::move(*scene));
}

Judged judge_map(const EvaluateOptions& options) {
    MapReadLimits limits;
    // Another program may have clamped the map at wider limits than octoskin (OctoMap's defaults are -2 and
    // 3.511).
    limits.map.log_odds_min = -20.0F;
    limits.map.log_odds_max = 20.0F;
    const auto loaded = load_map(options.input, limits);
    if (!loaded) throw CommandFailure(reading_error(options.input, {ExitCode::bad_data, loaded.error()}));
    for (const std::string& warning : loaded->warnings) spdlog::warn("{}", warning);
    const FusedMap& map = loaded->map;
    const auto provenance = provenance_of_map(options.input, options.recording);
    if (!provenance) throw CommandFailure(provenance.error());
    if (provenance->origin && is_of_data_set(*provenance->origin) && options.scenario.empty())
        refuse_data_set(provenance->origin->recording);
    for (const std::string& warning : provenance->warnings) spdlog::warn("{}", warning);
    const rig::Rig rig = rig_of_map(options, *provenance);
    const Scene scene = scene_of_map(options, provenance->recording);
    const evaluation::Truth truth = build(scene, rig, map.resolution_m());
    // A map file does not contain its mapping, and has no counts.
    const std::vector<evaluation::Run> runs = {
        {"map", options.input.stem().string(), 0, evaluation::evaluate(map, truth, MissUnits{})}};
    return {results_of(runs, rig, scene, options.rig)};
}

/// Called before any work is done.
void check_output(const std::filesystem::path& json) {
    std::error_code error;
    // A link such as /dev/stdout is not a file that would be overwritten.
    const bool is_file = std::filesystem::is_regular_file(std::filesystem::symlink_status(json, error));
    if (json.extension() != ".json" && is_file) {
        throw CommandFailure(ExitCode::cannot_create,
                             {.code = ErrorCode::already_exists,
                              .what = "exists and is not a .json file; it is not overwritten",
                              .file = json,
                              .key = "--json"});
    }
    if (const auto checked = check_text_place(json); !checked) throw CommandFailure(checked.error());
}

void evaluate_input(const EvaluateOptions& options) {
    const bool is_recording = std::filesystem::is_directory(options.input);
    if (is_recording && !options.recording.empty()) {
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::conflict,
                                               .what = "applies to a map, and this is a recording",
                                               .remedy = "leave --recording out",
                                               .file = options.input,
                                               .key = "--recording"});
    }
    if (!options.json.empty()) check_output(options.json);
    const Judged judged = is_recording ? judge_recording(options) : judge_map(options);
    print_text(evaluation::metrics_table(judged.results));
    if (!options.json.empty()) {
        const auto written =
            write_text(options.json, printable_json(evaluation::metrics_json(judged.results)));
        if (!written) throw CommandFailure(written.error());
    }
    if (judged.lost) throw CommandFailure(*judged.lost);
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
    auto options = std::make_shared<EvaluateOptions>();
    CLI::App* command =
        app.add_subcommand("evaluate", "Judge a recording, or a map, against the world it was made in");
    command->add_option("input", options->input, "A recording's directory, or a map (.ot, .bt)")
        ->required()
        ->check(existing_path());
    command
        ->add_option("--scenario", options->scenario,
                     "Judged region, hidden objects, world (YAML) in place of the recording's; one that is "
                     "another is used, with a warning")
        ->check(existing_file());
    command->add_option("--world", options->world, "World (SDF) in place of the recording's; likewise")
        ->check(existing_file());
    add_model_path(*command);
    command
        ->add_option(
            "--rig", options->rig,
            "Rig (YAML) in place of the recording's. For a map it is required: give RECORDING/rig.yaml, "
            "which has the seed's shift of the map's grid")
        ->check(existing_file());
    add_robot_options(*command, options->robot, "Robot (URDF) in place of the rig's");
    command->add_option(
        "--recording", options->recording,
        "For a map: the directory of the recording that it was made from; without it, the one "
        "beside the map");
    command->add_option("--configuration", options->configuration, configuration_help("For a recording"))
        ->capture_default_str();
    command->add_option("--json", options->json, "Write every figure to this file too");
    command->callback([options] { evaluate_input(*options); });
}

}  // namespace octoskin::app
