#include "hw/sim/scenario/hidden_models.hpp"

#include <set>

#include "hw/rigfile/joined.hpp"
#include "hw/sim/scenario/scenario_keys.hpp"

namespace octoskin::sim {

Status<Error> check_hidden_models(const Scenario& scenario, const World& world) {
    std::set<std::string> models;
    for (const Solid& solid : world.solids()) models.insert(solid.model);
    for (const std::string& hidden : scenario.hidden_models) {
        if (models.contains(hidden)) continue;
        return unexpected(
            scenario.error(keys::kHiddenModels.path, {ErrorCode::unknown_name, "expected models of the world",
                                                      "'" + hidden + "'", "it has " + rig::joined(models)}));
    }
    return Done{};
}

}  // namespace octoskin::sim
