// What several cameras find about one sensor.
#include "host/core/cross_check/cross_checks.hpp"

#include <gtest/gtest.h>

#include <array>

namespace octoskin {
namespace {

SensorEvidence that_agrees(std::uint64_t compared) {
    SensorEvidence evidence;
    evidence.doubt.reset();
    evidence.compared = compared;
    return evidence;
}
SensorEvidence that_contradicts(double strength) {
    SensorEvidence evidence;
    evidence.fault = RangeFault::turned;
    evidence.evidence = strength;
    evidence.doubt.reset();
    return evidence;
}
SensorEvidence undecided(std::uint64_t compared) {
    SensorEvidence evidence;
    evidence.compared = compared;
    return evidence;
}

TEST(CrossChecks, of_one_camera_are_its_own) {
    for (const SensorEvidence& evidence : {that_agrees(3), that_contradicts(13.0), undecided(2)}) {
        const auto found = CrossChecks::merged(std::array{evidence});
        EXPECT_EQ(found.camera, 0U);
        EXPECT_EQ(found.evidence.verdict(), evidence.verdict());
        EXPECT_EQ(found.evidence.compared, evidence.compared);
    }
}

TEST(CrossChecks, report_the_camera_with_the_strongest_evidence_in_any_order) {
    const auto expect_second = [](const SensorEvidence& weaker, const SensorEvidence& stronger) {
        const auto found = CrossChecks::merged(std::array{weaker, stronger});
        EXPECT_EQ(found.camera, 1U);
        EXPECT_EQ(found.evidence.verdict(), stronger.verdict());
        EXPECT_EQ(CrossChecks::merged(std::array{stronger, weaker}).camera, 0U);
    };
    expect_second(undecided(90), that_agrees(10));
    expect_second(undecided(90), that_contradicts(12.0));
    expect_second(that_contradicts(12.0), that_contradicts(14.0));
    expect_second(that_agrees(10), that_agrees(11));
    expect_second(undecided(1), undecided(2));
}

TEST(CrossChecks, report_no_sensor_that_agrees_with_another_camera) {
    for (const auto& evidence : {std::array{that_contradicts(20.0), that_agrees(10), undecided(1)},
                                 std::array{that_agrees(10), undecided(1), that_contradicts(20.0)}}) {
        const auto found = CrossChecks::merged(evidence);
        EXPECT_FALSE(found.evidence.contradicts());
        EXPECT_EQ(found.evidence.verdict(), CrossCheckFinding::cannot_tell);
        EXPECT_EQ(found.evidence.doubt, SensorDoubt::cameras_disagree);
    }
    SensorEvidence far_off = undecided(5);
    far_off.is_far_off = true;
    EXPECT_FALSE(CrossChecks::merged(std::array{far_off, that_agrees(1)}).evidence.contradicts());
    EXPECT_TRUE(CrossChecks::merged(std::array{far_off, undecided(1)}).evidence.contradicts());
}

}  // namespace
}  // namespace octoskin
