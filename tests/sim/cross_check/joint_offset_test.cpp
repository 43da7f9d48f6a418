// Joints that are not where their joint states say, in the worlds of cross_check_test: no sound sensor is
// named once the joint is likely, nor the sound camera alone. The figures are in
// docs/results/notebook-2026-11.md. By default six runs; three times as many with
// OCTOSKIN_CROSS_CHECK_SEEDS=1, and so on.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "tests/sim/cross_check/cross_check_runs.hpp"

namespace octoskin {
namespace {

using namespace testing_support;

/// Of the arm's seven; the last turns the sensors about their own ring's axis.
constexpr std::size_t kJoints = 6;
constexpr std::array<double, 6> kOffsetsRad = {0.05, -0.1, 0.15, -0.05, 0.1, -0.15};

struct Count {
    std::size_t runs = 0;
    std::size_t with_sensors = 0;  ///< at any time
    std::size_t with_sensors_at_the_end = 0;
    std::size_t camera_alone = 0;    ///< at any time
    std::size_t joint_alone = 0;     ///< at any time
    std::size_t other_joint = 0;     ///< of those, in the end another one
    std::size_t cannot_tell = 0;     ///< which of the two, in the end
    std::size_t nothing_is_off = 0;  ///< at any time
};

void add(const Outcome& outcome, std::size_t joint, Count& count) {
    ++count.runs;
    count.with_sensors += outcome.named.empty() ? 0U : 1U;
    count.with_sensors_at_the_end +=
        std::ranges::count(outcome.at_the_end, CrossCheckFinding::contradicts) > 0 ? 1U : 0U;
    count.camera_alone += outcome.camera_named_s ? 1U : 0U;
    count.joint_alone += outcome.joint_named_s ? 1U : 0U;
    count.nothing_is_off += outcome.fault_named_s ? 0U : 1U;
    const auto& fault = outcome.fault_at_the_end;
    if (!fault || !fault->joint) return;
    count.cannot_tell += fault->camera ? 1U : 0U;
    count.other_joint += !fault->camera && fault->joint->joint != joint ? 1U : 0U;
}

/// Each joint in another world, with another offset and kind of optics.
Outcome outcome_of_draw(std::size_t draw) {
    const std::size_t joint = draw % kJoints;
    const std::size_t round = draw / kJoints;
    const Place& place = places()[(draw + round) % places().size()];
    const double offset_rad = kOffsetsRad.at((joint + 2 * round) % kOffsetsRad.size());
    KeptChoice choice = choice_of(place, round);
    choice.joint_offset_rad.at(joint) = offset_rad;
    const std::string rig = rigs_of(place)[(joint + round) % 3];
    const Outcome outcome = outcome_of(keep_runs({rig}, seeds() == 0 ? 2 : 1, choice).front());
    print("joint " + std::to_string(joint + 1) + " by " + std::to_string(offset_rad) + ", " + place.world +
              ", " + rig,
          outcome);
    return outcome;
}

TEST(JointOffset, names_neither_a_sound_sensor_nor_the_sound_camera_alone) {
    const std::size_t draws = kJoints * std::max<std::size_t>(1, 3 * seeds());
    Count count;
    for (std::size_t draw = 0; draw < draws; ++draw) add(outcome_of_draw(draw), draw % kJoints, count);
    std::printf(
        "%zu runs: %zu name a sensor, %zu the camera alone, %zu a joint alone, %zu of them another in the "
        "end, %zu cannot tell in the end, %zu find nothing\n",
        count.runs, count.with_sensors, count.camera_alone, count.joint_alone, count.other_joint,
        count.cannot_tell, count.nothing_is_off);
    EXPECT_EQ(count.with_sensors_at_the_end, 0U);
    EXPECT_LE(6 * count.with_sensors, count.runs) << "before there is evidence of a joint";
    EXPECT_EQ(count.camera_alone, 0U);
    EXPECT_EQ(count.other_joint, 0U);
    EXPECT_GE(2 * (count.runs - count.nothing_is_off), count.runs);
}

}  // namespace
}  // namespace octoskin
