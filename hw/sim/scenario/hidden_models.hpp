// Checks a scenario's hidden objects against the world of the simulation.
#pragma once

#include "common/result.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

/// Checks that every hidden model of the scenario is a model of the world. The error lists the models of the
/// world.
[[nodiscard]] Status<Error> check_hidden_models(const Scenario& scenario, const World& world);

}  // namespace octoskin::sim
