#include "hw/sim/scenario/hidden_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/errors/error_fields.hpp"

namespace octoskin::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;

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
    EXPECT_THAT(checked.error(),
                AllOf(code_is(ErrorCode::unknown_name), file_is("my.scenario.yaml"), line_is(20),
                      key_is("hidden_models"), value_is("'mugg'"), remedy_is(HasSubstr("mug, table"))));
    EXPECT_TRUE(has_its_fields(checked.error()));
}

}  // namespace
}  // namespace octoskin::sim
