#include "hw/sim/scenario/hidden_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace octoskin::sim {
namespace {

World world_of(const std::vector<std::string>& models) {
    std::vector<Solid> solids;
    for (const std::string& model : models) {
        Solid solid;
        solid.name = model + "/body/visual";
        solid.model = model;
        solid.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        solid.triangles = {{0, 1, 2}};
        solid.is_closed = false;
        solids.push_back(solid);
    }
    return World(solids);
}

TEST(HiddenModels, that_the_world_has_are_accepted) {
    Scenario scenario;
    EXPECT_TRUE(check_hidden_models(scenario, world_of({"table", "mug"})));
    scenario.hidden_models = {"mug", "table"};
    EXPECT_TRUE(check_hidden_models(scenario, world_of({"table", "mug"})));
}

TEST(HiddenModels, that_the_world_has_not_is_refused_with_those_it_has) {
    Scenario scenario;
    scenario.hidden_models = {"mug", "mugg"};
    scenario.places["hidden_models"] = {"my.scenario.yaml", 20};
    const auto checked = check_hidden_models(scenario, world_of({"table", "mug", "mug"}));
    ASSERT_FALSE(checked);
    EXPECT_EQ(
        checked.error().message(),
        "my.scenario.yaml:20: hidden_models: expected models of the world, found 'mugg'; it has mug, table");
}

}  // namespace
}  // namespace octoskin::sim
