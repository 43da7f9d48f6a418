#include "tests/support/experiment_log/experiment_log.hpp"

#include <gtest/gtest.h>

#include "hw/sim/experiment/experiment.hpp"

namespace octoskin::test {

std::vector<StampedFrame> experiment_log(rig::Rig rig, std::uint64_t seed, std::uint32_t revolutions) {
    sim::Scenario scenario =
        sim::read_scenario(OCTOSKIN_SOURCE_DIR "/hw/worlds/experiment.scenario.yaml").value();
    const auto world = sim::World::read(scenario.world).value();
    const auto arm = sim::Arm::read(rig.urdf, rig.base_link, rig.joint_names()).value();
    const sim::Body body(rig::read_capsules(rig.urdf, {}).value());
    rig.cameras.clear();
    scenario.rest_s = 2.0;
    scenario.motion.revolutions = revolutions;
    std::vector<StampedFrame> log;
    const sim::ExperimentInput input{.rig = rig,
                                     .body = body,
                                     .world = world,
                                     .arm = arm,
                                     .scenario = scenario,
                                     .seed = seed,
                                     .is_depth_noise_free = true};
    const sim::ExperimentOutput output{.on_frame =
                                           [&](const wire::CanFrame& frame, WallTime stamp) {
                                               log.push_back({stamp, frame});
                                           },
                                       .on_depth = {},
                                       .on_progress = {}};
    EXPECT_TRUE(sim::run_experiment(input, output));
    return log;
}

}  // namespace octoskin::test
