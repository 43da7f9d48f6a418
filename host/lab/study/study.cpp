#include "host/lab/study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <mutex>

#include "host/apps/playback/map_folder.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/apps/version/version.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/lab/evaluation/survey.hpp"
#include "host/lab/report/report.hpp"
#include "host/lab/simulation/scene.hpp"
#include "host/lab/study/captions.hpp"
#include "host/lab/study/configurations.hpp"
#include "host/lab/study/parallel.hpp"
#include "host/lab/study/part_timer.hpp"
#include "host/lab/study/results_folder.hpp"
#include "host/lab/study/seed_study.hpp"
#include "host/lab/study/study_pictures.hpp"
#include "host/lab/study/work_folder.hpp"

namespace octoskin {
namespace {

using Say = std::function<void(const std::string&)>;
namespace fs = std::filesystem;

/// What every seed has in common.
struct StudyWorld {
    Scene scene;
    SourceFile rig_file;
    evaluation::TruthConfig truth;
};

/// Reads the scene, and refuses one that cannot be judged before anything is rendered or simulated.
Result<StudyWorld, AppError> read_world(const SimulationRequest& inputs, double resolution_m) {
    auto scene = read_scene(inputs.scenario, inputs.world);
    if (!scene) return unexpected(scene.error());
    if (const auto still = check_stands_still(*scene); !still) return unexpected(still.error());
    report_world_warnings(inputs, scene->world);
    const auto rig = read_given_rig(inputs.rig, inputs.robot.urdf);
    if (!rig) return unexpected(rig.error());
    evaluation::TruthConfig truth = truth_config_of(scene->scenario, resolution_m);
    // Each seed shifts the map a little and is checked again. This check is for regions that no shift makes
    // valid.
    if (auto fault =
            evaluation::region_fault(truth.region, truth.resolution_m, Eigen::Isometry3d::Identity()))
        return fail(ExitCode::bad_config, scene->scenario.error("region", std::move(*fault)));
    return StudyWorld{std::move(*scene), source_file(inputs.rig, rig->extended_files), std::move(truth)};
}

/// The configuration of the maps, the pictures and the headline.
const NamedMapping& main_of(const std::vector<NamedMapping>& configurations) {
    const auto ours =
        std::find_if(configurations.begin(), configurations.end(),
                     [](const auto& configuration) { return configuration.name == kDefaultMapping; });
    return ours == configurations.end() ? configurations.front() : *ours;
}

/// Studies every seed, `jobs` of them at once.
class SeedWorkers {
  public:
    /// Files that are not kept are created and removed in `work`.
    SeedWorkers(const StudyRequest& request, const std::vector<NamedMapping>& configurations,
                const StudyGround& ground, const OpenFolder& results, const OpenFolder& work, const Say& say)
        : request_(request),
          results_(results),
          work_(work),
          configurations_(configurations),
          ground_(ground),
          say_(say) {}

    Result<std::vector<SeedOutcome>, AppError> run() {
        return work_in_parallel<SeedOutcome, AppError>(
            request_.seeds.size(), request_.jobs, [this](std::size_t index) {
                return study_seed(request_for(index), ground_, [this, index](const std::string& line) {
                    const std::lock_guard lock(say_mutex_);
                    say_(fmt::format("seed {}: {}", request_.seeds[index], line));
                });
            });
    }

  private:
    SeedRequest request_for(std::size_t index) const {
        const bool is_first = index == 0;
        const std::string seed = std::to_string(request_.seeds[index]);
        SeedRequest seed_request{
            .simulation = request_.inputs,
            .configurations = configurations_,
            .recording = is_first ? FilePlace(results_, "recording") : FilePlace(work_, "seed-" + seed),
            .scratch = FilePlace(work_, "noise-free-seed-" + seed),
            .keeps_recording = is_first,
            .main_configuration = main_of(configurations_).name,
            .keeps_maps = is_first};
        seed_request.simulation.on_world_warning = {};  // the same warnings for every seed
        seed_request.simulation.seed = request_.seeds[index];
        return seed_request;
    }

    const StudyRequest& request_;
    const OpenFolder results_;
    const OpenFolder work_;
    const std::vector<NamedMapping>& configurations_;
    const StudyGround& ground_;
    const Say& say_;
    std::mutex say_mutex_;
};

/// Sums the times of the seeds by part, in the order of first appearance.
std::vector<evaluation::PartTime> total_times(const std::vector<SeedOutcome>& outcomes) {
    std::vector<evaluation::PartTime> totals;
    for (const SeedOutcome& outcome : outcomes) {
        for (const evaluation::PartTime& time : outcome.times) {
            const auto known = std::find_if(totals.begin(), totals.end(),
                                            [&](const auto& total) { return total.part == time.part; });
            if (known == totals.end()) {
                totals.push_back(time);
            } else {
                known->wall_s += time.wall_s;
                known->cpu_s += time.cpu_s;
            }
        }
    }
    return totals;
}

report::ReportCounters report_counters(const CounterTable& table) {
    report::ReportCounters inputs{table.title(), table.in, table.used, {}};
    for (const auto& row : table.rejected) inputs.rejected.emplace_back(row.name, row.count);
    return inputs;
}

/// Empty if the page of `octoskin view` is not installed: the report then has its pictures only.
std::string script_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

Status<AppError> write_report(const StudyRequest& request, const OpenFolder& folder, const StudyWorld& world,
                              const evaluation::Results& results, const SeedOutcome& first,
                              const NamedMapping& main_configuration) {
    const Playback& main = *first.main;
    report::ReportInput input{.results = results,
                              .main_configuration = main_configuration.name,
                              .picture_seed = first.seed,
                              .pictures = draw_pictures(world.scene.world, world.scene.scenario, main.rig,
                                                        main.pipeline.maps(), *first.truth),
                              .update_model = main_configuration.mapping.model,
                              .range_counting = range_counting_of(main.rig, main_configuration.mapping),
                              .inputs = {},
                              .hidden_objects = world.scene.scenario.hidden_models,
                              .idealisations = idealisations_of(main.rig, world.scene.scenario),
                              .reproduce = {command_of(request)}};
    input.cameras = main.rig.cameras.size();
    input.viewed_maps = viewed_maps(main.pipeline.maps(), input.cameras);
    input.view_script = script_of(request.view_script);
    if (input.cameras == 0) input.title = "octoskin: what the range sensors see";
    if (input.cameras > 1) input.title = "octoskin: what the cameras cannot see";
    for (const CounterTable& table : main.inputs) {
        if (table.in > 0) input.inputs.push_back(report_counters(table));
    }
    return write_text({folder, "report.html"}, report::report_html(input));
}

/// Refuses a folder before it is changed. A move that a killed octoskin left unfinished is completed first;
/// the folder is then checked under its lock.
Status<AppError> check_before_locked(const fs::path& out) {
    const auto there = OpenFolder::open(out, FolderAccess::write);
    if (!there || there->kind_of(FileSet::kReadyFolder) != EntryKind::absent) return Done{};
    return check_results_folder(*there);
}

std::string with_crc(const SourceFile& source) {
    return source.file.filename().string() + (source.crc32 ? ", CRC-32 " + crc_text(*source.crc32) : "");
}

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance_of(const Scene& scene, const SourceFile& rig) {
    return {{"program", program_version()},
            {"world", with_crc(scene.world_file)},
            {"scenario", with_crc(scene.scenario_file)},
            {"rig", with_crc(rig)}};
}

evaluation::TruthConfig truth_config_of(const sim::Scenario& scenario, double resolution_m) {
    evaluation::TruthConfig config;
    config.resolution_m = resolution_m;
    config.region = {scenario.region.p_base_min, scenario.region.p_base_max, scenario.region.floor_top_m};
    config.hidden_models = scenario.hidden_models;
    return config;
}

bool is_papers_experiment(const rig::Rig& rig, const fs::path& scenario, const fs::path& world,
                          const fs::path& papers_scenario) {
    constexpr std::string_view kRigs[] = {"experiment", "experiment_classical", "experiment_low_camera"};
    std::error_code error;  // a missing file is not the paper's scenario
    return world.empty() && std::ranges::find(kRigs, rig.name) != std::end(kRigs) &&
           fs::equivalent(scenario, papers_scenario, error);
}

evaluation::SurveyConfig survey_config_of(const sim::Scenario& scenario) {
    Eigen::Vector3d p_base_min = scenario.region.p_base_min;
    p_base_min.z() = scenario.region.floor_top_m.value_or(p_base_min.z());
    evaluation::SurveyConfig config;
    config.viewpoints =
        viewpoints_of(evaluation::SurveyPattern::around(p_base_min, scenario.region.p_base_max));
    return config;
}

Result<evaluation::Results, AppError> run_study(const StudyRequest& request, const Say& say) {
    if (const auto checked = check_seeds(request.seeds); !checked) return unexpected(checked.error());
    const auto configurations = find_configurations(request.configurations);
    if (!configurations) return unexpected(configurations.error());
    if (const auto checked = check_before_locked(request.out); !checked) return unexpected(checked.error());
    const auto world = read_world(request.inputs, configurations->front().mapping.map.resolution_m);
    if (!world) return unexpected(world.error());
    auto folder = MapFolder::open(request.out);
    if (!folder) return unexpected(folder.error());
    if (const auto checked = check_results_folder(folder->folder()); !checked)
        return unexpected(checked.error());

    say("ground truth: rendering the tour of a noise-free camera");
    const PartTimer survey_timer("ground truth survey");
    const evaluation::Survey survey =
        evaluation::render_survey(world->scene.world, survey_config_of(world->scene.scenario));
    const evaluation::PartTime survey_time = survey_timer.stop();
    const StudyGround ground{world->scene.world, world->scene.scenario, survey, world->truth};

    const auto work = WorkFolder::create(folder->folder());
    if (!work) return unexpected(work.error());
    auto outcomes =
        SeedWorkers(request, *configurations, ground, folder->folder(), work->folder(), say).run();
    if (!outcomes) return unexpected(outcomes.error());
    std::vector<evaluation::Run> runs;
    for (const SeedOutcome& outcome : *outcomes)
        runs.insert(runs.end(), outcome.runs.begin(), outcome.runs.end());
    std::vector<evaluation::PartTime> times = total_times(*outcomes);
    times.push_back(survey_time);
    evaluation::Results results =
        evaluation::collect(runs, times, provenance_of(world->scene, world->rig_file));
    results.unknown_space = outcomes->front().unknown_space;
    results.is_papers_experiment = is_papers_experiment(outcomes->front().main->rig, request.inputs.scenario,
                                                        request.inputs.world, request.papers_scenario);

    const SeedOutcome& first = outcomes->front();
    say(fmt::format("seed {}: saving maps", first.seed));
    if (const auto saved = folder->save(named_maps(*first.main), first.main->origin); !saved)
        return unexpected(saved.error());
    if (const auto noted = note_result(folder->folder(), kMapOriginFile); !noted)
        return unexpected(noted.error());
    if (const auto written =
            write_text({folder->folder(), "metrics.json"}, evaluation::metrics_json(results));
        !written) {
        return unexpected(written.error());
    }
    if (const auto noted = note_result(folder->folder(), "metrics.json"); !noted)
        return unexpected(noted.error());
    say(fmt::format("seed {}: drawing the report", first.seed));
    const auto reported =
        write_report(request, folder->folder(), *world, results, first, main_of(*configurations));
    if (!reported) return unexpected(reported.error());
    if (const auto noted = note_result(folder->folder(), "report.html"); !noted)
        return unexpected(noted.error());
    return results;
}

}  // namespace octoskin
