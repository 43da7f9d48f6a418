// octoskin evaluate: a recording or a map against the world it was made in.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <memory>

#include "host/apps/evaluation/results.hpp"
#include "host/apps/evaluation/survey.hpp"
#include "host/apps/evaluation/truth.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/study/study.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "hw/sim/scenario/scenario.hpp"

namespace octoskin::app {
namespace {

struct EvaluateOptions {
    std::filesystem::path input;
    std::filesystem::path rig;
    std::filesystem::path robot;
    std::filesystem::path scenario;
    std::filesystem::path world;
    std::filesystem::path json;
    std::string configuration = "robust";
};

struct World {
    sim::Scenario scenario;
    sim::World solids;
};

World read_world(const EvaluateOptions& options) {
    auto scenario = sim::read_scenario(options.scenario);
    if (!scenario) throw CommandFailure({ExitCode::bad_config, scenario.error().message()});
    auto solids = sim::World::read(options.world.empty() ? scenario->world : options.world);
    if (!solids) throw CommandFailure({ExitCode::bad_data, solids.error().message()});
    return {std::move(*scenario), std::move(*solids)};
}

evaluation::Truth build(const World& world, const rig::Rig& rig, double resolution_m) {
    spdlog::info("ground truth: a noise-free camera goes round the scene");
    evaluation::TruthConfig config = truth_config_of(world.scenario, resolution_m);
    config.external_camera = rig.camera;
    return evaluation::build_truth(world.solids,
                                   evaluation::render_survey(world.solids, survey_config_of(world.scenario)),
                                   config, rig.T_map_base);
}

struct Judgement {
    std::vector<evaluation::Run> runs;
    bool is_papers_experiment = false;
};

bool is_papers(const rig::Rig& rig, const EvaluateOptions& options) {
    return is_papers_experiment(rig, options.scenario, options.world,
                                shipped_file("hw/worlds/experiment.scenario.yaml"));
}

Judgement judge_recording(const EvaluateOptions& options, const World& world) {
    const auto mapping = read_mapping(options.configuration);
    if (!mapping) throw CommandFailure({ExitCode::bad_config, mapping.error().message()});
    const RecordingPaths recording(options.input);
    const auto meta = read_meta(recording);
    if (!meta) throw CommandFailure({ExitCode::no_input, meta.error().message()});
    spdlog::info("replaying {}", options.input.string());
    const auto playback = play_recording({.recording = recording,
                                          .mapping = *mapping,
                                          .maps = {},
                                          .rig = options.rig,
                                          .robot = options.robot});
    if (!playback) throw CommandFailure(playback.error());
    for (const std::string& warning : playback->warnings) spdlog::warn("{}", warning);
    if (const auto& failed = playback->outcome.depth_error) spdlog::warn("{}", failed->what);
    if (const auto& failed = playback->outcome.can_error) spdlog::warn("{}", failed->what);
    const evaluation::Truth truth = build(world, playback->rig, mapping->map.resolution_m);
    const std::string name = std::filesystem::path(options.configuration).stem().string();
    const MapSet& maps = playback->pipeline.maps();
    const std::uint64_t seed = meta->seed.value_or(0);
    Judgement judgement{.runs = {}, .is_papers_experiment = is_papers(playback->rig, options)};
    judgement.runs.push_back({name, "proximity", seed, evaluation::evaluate(*maps.proximity(), truth)});
    if (playback->rig.camera) {
        judgement.runs.insert(judgement.runs.begin(),
                              {name, "depth", seed, evaluation::evaluate(*maps.depth(), truth)});
        judgement.runs.push_back({name, "fused", seed, evaluation::evaluate(*maps.fused(), truth)});
    }
    return judgement;
}

Judgement judge_map(const EvaluateOptions& options, const World& world) {
    MapReadLimits limits;
    // Whoever made the map may have clamped wider than octoskin does (OctoMap's own defaults are -2
    // and 3.511).
    limits.map.log_odds_min = -20.0F;
    limits.map.log_odds_max = 20.0F;
    const auto map = load_map(options.input, limits);
    if (!map) throw CommandFailure({ExitCode::bad_data, map.error().message});
    if (options.rig.empty()) {
        throw CommandFailure(
            {ExitCode::usage, "a map alone does not say where the robot and the camera stood: give --rig"});
    }
    const auto rig = rig::read_rig(options.rig, options.robot);
    if (!rig) throw CommandFailure({ExitCode::bad_config, rig.error().message()});
    const evaluation::Truth truth = build(world, *rig, map->resolution_m());
    return {{{"map", options.input.stem().string(), 0, evaluation::evaluate(*map, truth)}},
            is_papers(*rig, options)};
}

void evaluate_input(const EvaluateOptions& options) {
    const World world = read_world(options);
    const Judgement judgement = std::filesystem::is_directory(options.input) ? judge_recording(options, world)
                                                                             : judge_map(options, world);
    evaluation::Results results = evaluation::collect(judgement.runs);
    results.is_papers_experiment = judgement.is_papers_experiment;
    fmt::print("{}", evaluation::metrics_table(results));
    if (options.json.empty()) return;
    std::ofstream file(options.json);
    file << evaluation::metrics_json(results);
    file.close();
    if (!file) throw CommandFailure({ExitCode::cannot_create, options.json.string() + ": cannot write"});
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
    auto options = std::make_shared<EvaluateOptions>();
    options->scenario = shipped_file("hw/worlds/experiment.scenario.yaml");
    CLI::App* command =
        app.add_subcommand("evaluate", "Judge a recording, or a map, against the world it was made in");
    command->add_option("input", options->input, "A recording's directory, or a map (.ot, .bt)")
        ->required()
        ->check(CLI::ExistingPath);
    command->add_option("--scenario", options->scenario, "Judged region, hidden objects, world (YAML)")
        ->capture_default_str()
        ->check(CLI::ExistingFile);
    command->add_option("--world", options->world, "World (SDF) in place of the scenario's")
        ->check(CLI::ExistingFile);
    command
        ->add_option("--rig", options->rig, "Rig (YAML): required for a map; in place of a recording's own")
        ->check(CLI::ExistingFile);
    command->add_option("--robot", options->robot, "Robot (URDF) in place of the rig's")
        ->check(CLI::ExistingFile);
    command
        ->add_option("--configuration", options->configuration,
                     "For a recording: paper, robust, or a YAML file")
        ->capture_default_str();
    command->add_option("--json", options->json, "Write every figure to this file too");
    command->callback([options] { evaluate_input(*options); });
}

}  // namespace octoskin::app
