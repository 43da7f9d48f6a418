#include "host/apps/study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <mutex>

#include "host/apps/evaluation/survey.hpp"
#include "host/apps/report/report.hpp"
#include "host/apps/study/captions.hpp"
#include "host/apps/study/configuration.hpp"
#include "host/apps/study/parallel.hpp"
#include "host/apps/study/part_timer.hpp"
#include "host/apps/study/seed_study.hpp"
#include "host/apps/study/study_pictures.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin {
namespace {

using Say = std::function<void(const std::string&)>;
namespace fs = std::filesystem;

struct StudyWorld {
    sim::Scenario scenario;
    sim::World world;
    evaluation::TruthConfig truth;
    evaluation::Survey survey;
};

Result<StudyWorld, AppError> prepare_world(const SimulationRequest& inputs, double resolution_m) {
    auto scenario = sim::read_scenario(inputs.scenario);
    if (!scenario) return fail(ExitCode::bad_config, scenario.error().message());
    auto world = sim::World::read(inputs.world.empty() ? scenario->world : inputs.world);
    if (!world) return fail(ExitCode::bad_data, world.error().message());
    evaluation::TruthConfig truth = truth_config_of(*scenario, resolution_m);
    evaluation::Survey survey = evaluation::render_survey(*world, survey_config_of(*scenario));
    return StudyWorld{std::move(*scenario), std::move(*world), std::move(truth), std::move(survey)};
}

Result<std::vector<StudyConfiguration>, AppError> find_configurations(const std::vector<std::string>& names) {
    std::vector<StudyConfiguration> found;
    for (const std::string& name : names) {
        auto configuration = study_configuration(name);
        if (!configuration) {
            std::string known;
            for (const std::string_view one : kStudyConfigurations)
                known.append(known.empty() ? "" : ", ").append(one);
            return fail(ExitCode::usage,
                        fmt::format("unknown configuration '{}'; there are {}", name, known));
        }
        found.push_back(std::move(*configuration));
    }
    return found;
}

/// The one whose maps are kept and reported: the default, if it was asked for.
std::string main_configuration(const StudyRequest& request) {
    const auto& names = request.configurations;
    const bool has_default = std::find(names.begin(), names.end(), "robust") != names.end();
    return has_default ? "robust" : names.front();
}

/// Studies every seed, `jobs` of them at once.
class SeedWorkers {
  public:
    SeedWorkers(const StudyRequest& request, const std::vector<StudyConfiguration>& configurations,
                const StudyWorld& ground, const Say& say)
        : request_(request),
          configurations_(configurations),
          ground_{ground.world, ground.survey, ground.truth},
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
            .recording = request_.out / (is_first ? "recording" : "recording-seed-" + seed),
            .scratch = request_.out / ("recording-noise-free-seed-" + seed),
            .keeps_recording = is_first,
            .main_configuration = main_configuration(request_),
            .keeps_maps = is_first};
        seed_request.simulation.seed = request_.seeds[index];
        return seed_request;
    }

    const StudyRequest& request_;
    const std::vector<StudyConfiguration>& configurations_;
    StudyGround ground_;
    const Say& say_;
    std::mutex say_mutex_;
};

Status<AppError> write_text(const fs::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.close();
    if (!out) return fail(ExitCode::cannot_create, file.string() + ": cannot write; is the disk full?");
    return Done{};
}

Status<AppError> save_maps(const MapSet& maps, bool has_camera, const fs::path& out) {
    const std::pair<const char*, const FusedMap*> named[] = {
        {"depth", maps.depth()}, {"proximity", maps.proximity()}, {"fused", maps.fused()}};
    for (const auto& [name, map] : named) {
        if (!has_camera && map == maps.depth()) continue;
        for (const char* extension : {".ot", ".bt", ".ply"}) {
            if (const auto saved = save_map(*map, out / (std::string(name) + extension)); !saved) {
                return fail(ExitCode::cannot_create, saved.error().message);
            }
        }
    }
    return Done{};
}

/// Adds up what the seeds took, part by part, in the order of their first appearance.
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

report::Account report_account(const AccountTable& table) {
    report::Account account{table.unit, table.in, table.used, {}};
    for (const auto& row : table.rejected) account.rejected.emplace_back(row.name, row.count);
    return account;
}

Status<AppError> write_report(const StudyRequest& request, const StudyWorld& ground,
                              const evaluation::Results& results, const SeedOutcome& first,
                              const std::string& main_configuration) {
    const Playback& main = *first.main;
    report::ReportInput input{.results = results,
                              .main_configuration = main_configuration,
                              .picture_seed = first.seed,
                              .pictures = draw_pictures(ground.world, ground.scenario, main.rig,
                                                        main.pipeline.maps(), *first.truth),
                              .update_model = study_configuration(main_configuration)->mapping.model,
                              .accounts = {},
                              .hidden_objects = ground.scenario.hidden_models,
                              .idealisations = idealisations_of(main.rig, ground.scenario),
                              .reproduce = {command_of(request)}};
    if (!main.rig.camera) input.title = "octoskin: what the range sensors see";
    for (const AccountTable& table : main.accounts) {
        if (table.in > 0) input.accounts.push_back(report_account(table));
    }
    return write_text(request.out / "report.html", report::report_html(input));
}

std::string program_version() {
    return "octoskin " OCTOSKIN_VERSION;
}

}  // namespace

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
    std::error_code error;  // a file that is not there is not the paper's
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
    const auto configurations = find_configurations(request.configurations);
    if (!configurations) return unexpected(configurations.error());
    std::error_code error;
    fs::create_directories(request.out, error);
    if (error) return fail(ExitCode::cannot_create, request.out.string() + ": " + error.message());

    say("ground truth: a noise-free camera goes round the scene");
    const PartTimer survey_timer("ground truth survey");
    const auto ground = prepare_world(request.inputs, configurations->front().mapping.map.resolution_m);
    if (!ground) return unexpected(ground.error());
    const evaluation::PartTime survey_time = survey_timer.stop();

    auto outcomes = SeedWorkers(request, *configurations, *ground, say).run();
    if (!outcomes) return unexpected(outcomes.error());
    std::vector<evaluation::Run> runs;
    for (const SeedOutcome& outcome : *outcomes)
        runs.insert(runs.end(), outcome.runs.begin(), outcome.runs.end());
    std::vector<evaluation::PartTime> times = total_times(*outcomes);
    times.push_back(survey_time);
    const std::vector<std::pair<std::string, std::string>> provenance{
        {"program", program_version()},
        {"world", ground->scenario.world.filename().string()},
        {"scenario", request.inputs.scenario.filename().string()},
        {"rig", request.inputs.rig.filename().string()}};
    evaluation::Results results = evaluation::collect(runs, times, provenance);
    results.is_papers_experiment = is_papers_experiment(outcomes->front().main->rig, request.inputs.scenario,
                                                        request.inputs.world, request.papers_scenario);

    const SeedOutcome& first = outcomes->front();
    say(fmt::format("seed {}: saving maps", first.seed));
    if (const auto saved =
            save_maps(first.main->pipeline.maps(), first.main->rig.camera.has_value(), request.out);
        !saved)
        return unexpected(saved.error());
    if (const auto written = write_text(request.out / "metrics.json", evaluation::metrics_json(results));
        !written) {
        return unexpected(written.error());
    }
    say(fmt::format("seed {}: drawing the report", first.seed));
    const auto reported = write_report(request, *ground, results, first, main_configuration(request));
    if (!reported) return unexpected(reported.error());
    return results;
}

}  // namespace octoskin
