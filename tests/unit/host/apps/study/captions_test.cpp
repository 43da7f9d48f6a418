#include "host/apps/study/captions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace octoskin {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

/// Three sensors of one board, 33 ms every 40 ms, and no camera.
rig::Rig bench() {
    rig::Rig rig;
    rig.nodes.resize(1);
    rig.nodes[0].sensors.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
        rig.nodes[0].config.sensors[i].timing_budget_ms = 33;
        rig.nodes[0].config.sensors[i].inter_measurement_ms = 40;
    }
    return rig;
}

sim::Scenario kitchen() {
    sim::Scenario scenario;
    scenario.ranges = {.sigma_m = 0.015, .min_m = 0.05, .max_m = 2.5};
    scenario.depth_sigma_m = 0.01;
    return scenario;
}

TEST(Idealisations, name_the_timing_and_the_noise_of_this_rig_and_scenario) {
    const auto sentences = idealisations_of(bench(), kitchen());
    EXPECT_THAT(sentences, Contains(HasSubstr("in long mode with a 33 ms timing budget every 40 ms. The "
                                              "datasheet asks for 140 ms to reach 4 m.")));
    EXPECT_THAT(sentences, Contains(HasSubstr("noise (1.5 cm) and reach (0.05 to 2.5 m)")));
}

TEST(Idealisations, list_each_timing_once) {
    rig::Rig rig = bench();
    rig.nodes[0].config.sensors[2].timing_budget_ms = 20;
    rig.nodes[0].config.sensors[2].distance_mode = DistanceMode::short_range;
    EXPECT_EQ(idealisations_of(rig, kitchen()).size(), idealisations_of(bench(), kitchen()).size() + 1);
    EXPECT_THAT(idealisations_of(rig, kitchen()),
                Contains(HasSubstr("in short mode with a 20 ms timing budget every 40 ms.")));
}

TEST(Idealisations, blame_only_what_the_datasheet_does_not_allow) {
    rig::Rig rig = bench();
    rig.nodes[0].sensors.resize(1);
    rig.nodes[0].config.sensors[0].timing_budget_ms = 20;
    EXPECT_THAT(idealisations_of(rig, kitchen()), Contains(HasSubstr("asks for at least 33 ms")));
    rig.nodes[0].config.sensors[0].timing_budget_ms = 140;
    EXPECT_THAT(idealisations_of(rig, kitchen()), Each(Not(HasSubstr("datasheet"))));
}

TEST(Idealisations, speak_of_a_camera_only_if_there_is_one) {
    rig::Rig rig = bench();
    EXPECT_THAT(idealisations_of(rig, kitchen()), Each(Not(HasSubstr("camera"))));
    rig.camera = rig::Camera{};
    EXPECT_THAT(idealisations_of(rig, kitchen()), Contains(HasSubstr("camera's noise (1 cm along the ray")));
}

TEST(SceneCaption, names_only_what_is_in_the_picture) {
    rig::Rig rig = bench();
    sim::Scenario scenario = kitchen();
    EXPECT_EQ(scene_caption(rig, scenario, 0), "The arm.");
    EXPECT_EQ(scene_caption(rig, scenario, 2), "The arm with beams of 2 of its 3 range sensors (red).");
    rig.camera = rig::Camera{};
    scenario.hidden_models = {"mug", "bowl"};
    EXPECT_EQ(scene_caption(rig, scenario, 0),
              "The arm and the external camera. Yellow: what the scenario names as hidden (mug, bowl).");
}

TEST(Command, is_what_a_shell_would_run_again) {
    StudyRequest request;
    request.inputs.rig = "my rig.yaml";
    request.inputs.scenario = "it's.yaml";
    request.seeds = {0, 7};
    request.configurations = {"robust", "paper"};
    request.out = "kout";
    EXPECT_EQ(
        command_of(request),
        "octoskin experiment --rig 'my rig.yaml' --scenario 'it'\\''s.yaml' --seeds 0 7 --configurations "
        "robust paper --out kout");
}

TEST(PapersExperiment, needs_its_rig_its_scenario_and_its_world) {
    const std::filesystem::path papers = std::filesystem::temp_directory_path();  // anything that exists
    rig::Rig rig;
    rig.name = "experiment";
    EXPECT_TRUE(is_papers_experiment(rig, papers, {}, papers));
    EXPECT_FALSE(is_papers_experiment(rig, papers, "other.sdf", papers));
    EXPECT_FALSE(is_papers_experiment(rig, "no such file", {}, papers));
    rig.name = "three_eyes";
    EXPECT_FALSE(is_papers_experiment(rig, papers, {}, papers));
}

}  // namespace
}  // namespace octoskin
