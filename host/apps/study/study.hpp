// The whole experiment: seeds x configurations, metrics, maps, pictures, report.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/evaluation/results.hpp"
#include "host/apps/evaluation/survey.hpp"
#include "host/apps/evaluation/truth.hpp"
#include "host/apps/simulation/simulation.hpp"
#include "hw/sim/scenario/scenario.hpp"

namespace octoskin {

struct StudyRequest {
    SimulationRequest inputs;  ///< rig, robot, scenario, world; seed, noise and `out` are not used
    std::vector<std::uint64_t> seeds;
    std::vector<std::string> configurations;
    unsigned jobs = 1;
    std::filesystem::path out;
};

/// Writes into `out`: metrics.json, report.html, the maps depth, proximity and fused (.ot .bt .ply) and
/// recording/ of the first seed in its main configuration (robust if it is among them). `say`: progress, one
/// line each, called under a lock.
[[nodiscard]] Result<evaluation::Results, AppError> run_study(
    const StudyRequest& request, const std::function<void(const std::string&)>& say);

/// The judged region and what else the evaluation takes from a scenario.
[[nodiscard]] evaluation::TruthConfig truth_config_of(const sim::Scenario& scenario, double resolution_m);
/// The ground-truth camera's tour round the scenario's region.
[[nodiscard]] evaluation::SurveyConfig survey_config_of(const sim::Scenario& scenario);

}  // namespace octoskin
