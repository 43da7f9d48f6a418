#include "host/lab/study/captions.hpp"

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
    scenario.depth_noise = sim::gaussian_noise(0.01);
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

TEST(Idealisations, call_a_sensor_a_ray_only_if_the_rig_does) {
    rig::Rig rig = bench();
    EXPECT_THAT(idealisations_of(rig, kitchen()),
                AllOf(Contains(HasSubstr("The range sensors measure along one ideal ray each.")),
                      Each(Not(HasSubstr("sub-rays")))));
    for (rig::Sensor& sensor : rig.nodes[0].sensors) sensor.cone = rig::Cone{};
    EXPECT_THAT(
        idealisations_of(rig, kitchen()),
        AllOf(Contains(HasSubstr("The range sensors see a cone of 27 degrees as a bundle of sub-rays;")),
              Contains(HasSubstr("diffuse with a reflectivity of 50 %")),
              Contains(HasSubstr("follow from the signal")), Each(Not(HasSubstr("ideal ray"))),
              Each(Not(HasSubstr("1.5 cm")))));
}

TEST(Idealisations, tell_sensors_of_both_kinds_apart_and_name_zones) {
    rig::Rig rig = bench();
    rig.nodes[0].sensors[1].cone = rig::Cone{.half_angle_deg = 10.0};
    EXPECT_THAT(idealisations_of(rig, kitchen()),
                AllOf(Contains(HasSubstr("2 of the 3 range sensors measure along one ideal ray each.")),
                      Contains(HasSubstr("1 of the 3 range sensors see a cone of 20 degrees")),
                      Each(Not(HasSubstr("zone")))));
    rig.nodes[0].config.sensors[1].zones[0].width = 6;
    EXPECT_THAT(idealisations_of(rig, kitchen()), Contains(HasSubstr("shared between the zones")));
    rig.nodes[0].config.sensors[0].zone_count = 2;
    EXPECT_THAT(idealisations_of(rig, kitchen()),
                Contains(HasSubstr("ray each, of a zone along its middle")));
}

TEST(RangeCounting, is_what_the_mapping_does_with_the_optics_of_the_rig) {
    rig::Rig rig = bench();
    const auto rays = range_counting_of(rig, fast_mapping());
    EXPECT_TRUE(rays.has_rays);
    EXPECT_FALSE(rays.cone || rays.zone);
    for (rig::Sensor& sensor : rig.nodes[0].sensors) sensor.cone = rig::Cone{};
    const auto cones = range_counting_of(rig, fast_mapping());
    EXPECT_FALSE(cones.has_rays);
    EXPECT_EQ(cones.cone, fast_mapping().cone);
    EXPECT_FALSE(cones.zone);
    EXPECT_TRUE(range_counting_of(rig, paper_mapping()).has_rays) << "range_update: ray";
    EXPECT_FALSE(range_counting_of(rig, paper_mapping()).cone);
    rig.nodes[0].config.sensors[0].zones[0] = {.centre_spad = 199, .width = 6, .height = 6};
    const auto both = range_counting_of(rig, fast_mapping());
    EXPECT_EQ(both.cone, fast_mapping().cone);
    EXPECT_EQ(both.zone, fast_mapping().zone);
}

TEST(Idealisations, speak_of_a_camera_only_if_there_is_one) {
    rig::Rig rig = bench();
    EXPECT_THAT(idealisations_of(rig, kitchen()), Each(Not(HasSubstr("camera"))));
    rig.cameras = {rig::Camera{}};
    EXPECT_THAT(idealisations_of(rig, kitchen()), Contains(HasSubstr("camera's noise (1 cm along the ray")));
    rig.cameras = {rig::Camera{.name = "left"}, rig::Camera{.name = "right"}};
    EXPECT_THAT(idealisations_of(rig, kitchen()),
                Contains(HasSubstr("The noise of each of the 2 depth cameras (1 cm along the ray")));
    sim::Scenario before_kinect = kitchen();
    before_kinect.depth_noise = {sim::KinectNoise{}};
    EXPECT_THAT(idealisations_of(rig, before_kinect),
                AllOf(Contains(HasSubstr("1.2 mm + 1.9 mm (z - 0.4 m)^2")), Each(Not(HasSubstr("1 cm")))));
}

TEST(SceneCaption, names_only_what_is_in_the_picture) {
    rig::Rig rig = bench();
    sim::Scenario scenario = kitchen();
    EXPECT_EQ(scene_caption(rig, scenario, 0), "The arm.");
    EXPECT_EQ(scene_caption(rig, scenario, 2), "The arm with beams of 2 of its 3 range sensors (red).");
    rig.cameras = {rig::Camera{}};
    scenario.hidden_models = {"mug", "bowl"};
    EXPECT_EQ(scene_caption(rig, scenario, 0),
              "The arm and the external camera. Yellow: what the scenario names as hidden (mug, bowl).");
    rig.cameras = {rig::Camera{.name = "left"}, rig::Camera{.name = "right"}};
    EXPECT_EQ(scene_caption(rig, kitchen(), 2),
              "The arm with beams of 2 of its 3 range sensors (red), and the 2 external cameras.");
    for (rig::Camera& camera : rig.cameras) camera.link = "hand";
    EXPECT_EQ(scene_caption(rig, kitchen(), 0), "The arm.");
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
        "octoskin-lab experiment --rig 'my rig.yaml' --scenario 'it'\\''s.yaml' --seeds 0 7 --configurations "
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
