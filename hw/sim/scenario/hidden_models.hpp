// A scenario's hidden objects against the world that it is played in.
#pragma once

#include "common/result.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

/// That every hidden model of the scenario is a model of the world; the error names the models that there
/// are.
[[nodiscard]] Status<rig::RigError> check_hidden_models(const Scenario& scenario, const World& world);

}  // namespace octoskin::sim
