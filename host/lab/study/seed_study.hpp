// One seed of the experiment: simulated, replayed in each configuration, judged.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/profile/named_mapping.hpp"
#include "host/lab/evaluation/aggregate.hpp"
#include "host/lab/evaluation/results.hpp"
#include "host/lab/evaluation/survey.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "host/lab/simulation/simulation.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin {

/// Input shared by all seeds.
struct StudyGround {
    const sim::World& world;
    const sim::Scenario& scenario;
    const evaluation::Survey& survey;
    const evaluation::TruthConfig& truth;  ///< without the external cameras, which the seed's rig defines
};

struct SeedRequest {
    SimulationRequest simulation;  ///< `seed` must be set; `out` and the noise are set here
    std::vector<NamedMapping> configurations;
    FilePlace recording;  ///< where the noisy recording goes
    FilePlace scratch;    ///< for the noise-free one; removed afterwards
    bool keeps_recording = false;
    std::string main_configuration;  ///< whose maps are returned
    bool keeps_maps = false;
};

struct SeedOutcome {
    std::uint64_t seed = 0;
    std::vector<evaluation::Run> runs;
    std::vector<evaluation::PartTime> times;
    /// Of the main configuration, if `keeps_maps`.
    std::optional<Playback> main;
    std::optional<evaluation::Truth> truth;
    std::optional<evaluation::UnknownSpace> unknown_space;
};

/// `say`: called with one line of progress after each part.
[[nodiscard]] Result<SeedOutcome, AppError> study_seed(const SeedRequest& request, const StudyGround& ground,
                                                       const std::function<void(const std::string&)>& say);

}  // namespace octoskin
