// The whole experiment: seeds x configurations, metrics, maps, pictures, report.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "host/lab/evaluation/results.hpp"
#include "host/lab/evaluation/survey.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "host/lab/simulation/scene.hpp"
#include "host/lab/simulation/simulation.hpp"
#include "hw/sim/scenario/scenario.hpp"

namespace octoskin {

struct StudyRequest {
    SimulationRequest inputs;  ///< rig, robot, scenario, world; seed, noise and `out` are not used
    std::vector<std::uint64_t> seeds;
    std::vector<std::string> configurations;
    unsigned jobs = 1;
    /// The scenario of the paper's experiment, to detect whether this run repeats it.
    std::filesystem::path papers_scenario;
    /// JavaScript that shows the maps in the report; absent: the report has its pictures only.
    std::filesystem::path view_script = {};
    std::filesystem::path out;
};

/// Writes into `out`: metrics.json, report.html, the maps depth (if the rig has a camera), proximity and
/// fused (.ot .bt .ply) and recording/ of the first seed in its main configuration (the default if it is
/// among them). `say`: progress, one line each, called under a lock. Inputs that cannot be judged are refused
/// first, and so is an `out` whose content would be lost (check_results_folder()).
[[nodiscard]] Result<evaluation::Results, AppError> run_study(
    const StudyRequest& request, const std::function<void(const std::string&)>& say);

/// Whether a run repeats the paper's experiment, so that the paper's table is shown beside it: the rig's name
/// is one of the shipped experiment*.yaml, the scenario is `papers_scenario` itself, and the world is the
/// scenario's (`world` empty).
[[nodiscard]] bool is_papers_experiment(const rig::Rig& rig, const std::filesystem::path& scenario,
                                        const std::filesystem::path& world,
                                        const std::filesystem::path& papers_scenario);

/// The provenance of the figures, for `evaluation::Results`: this program, and the files with their CRC-32.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance_of(const Scene& scene,
                                                                             const SourceFile& rig);

/// The judged region and the other settings that the evaluation takes from a scenario.
[[nodiscard]] evaluation::TruthConfig truth_config_of(const sim::Scenario& scenario, double resolution_m);
/// The ground-truth camera's tour round the scenario's region.
[[nodiscard]] evaluation::SurveyConfig survey_config_of(const sim::Scenario& scenario);

}  // namespace octoskin
