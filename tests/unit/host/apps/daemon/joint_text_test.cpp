#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "host/apps/daemon/joint_line.hpp"
#include "tests/support/bus/line_joints.hpp"

namespace octoskin {
namespace {

using testing_support::one_source;

constexpr HostTime kNow{100'000'000'000};

std::optional<JointTextFault> fault_of(std::string_view text, std::size_t joints = 3) {
    const auto sample = parse_joints(text, one_source(joints), kNow, kNow);
    return sample ? std::nullopt : std::optional(sample.error());
}

TEST(JointText, is_positions_of_when_it_came_or_of_the_time_before_them) {
    const HostTime came = kNow - std::chrono::milliseconds(20);
    const auto now = parse_joints("0.5 -1e-3 8\n", one_source(3), kNow, came);
    ASSERT_TRUE(now);
    EXPECT_EQ(now->samples.at(0).sampled, came);
    EXPECT_EQ(now->samples.at(0).position, (std::vector<double>{0.5, -1e-3, 8.0}));
    const auto timed = parse_joints("99.75, 1, 2,\t3", one_source(3), kNow, came);
    ASSERT_TRUE(timed);
    EXPECT_EQ(timed->samples.at(0).sampled, HostTime{99'750'000'000});
    EXPECT_EQ(timed->samples.at(0).position, (std::vector<double>{1, 2, 3}));
}

TEST(JointText, fault_is_told_with_what_is_wrong_and_what_it_may_be) {
    const auto reported = [](JointTextFault fault, std::string_view text) {
        return describe(fault, text, one_source(3), kNow);
    };
    using enum JointTextFault;
    EXPECT_EQ(reported(wrong_count, "1 2\n"), "wrong_count: 2 numbers, the rig has 3 joints");
    EXPECT_EQ(reported(not_a_number, "1, x7 y"), "not_a_number: \"x7\"");
    EXPECT_EQ(reported(too_large, "0.1 -90 45"),
              "too_large: joint 2 of 3 is -90, beyond +-8.388607: degrees, or millimetres?");
    EXPECT_EQ(reported(too_large, "99.5 0.1 0 9"),
              "too_large: joint 3 of 3 is 9, beyond +-8.388607: degrees, or millimetres?");
    EXPECT_EQ(reported(too_long, "1 2 3"), "too_long: over 4096 bytes");
    EXPECT_EQ(reported(time_off, "90 1 2 3"), "time_off: 90, and CLOCK_MONOTONIC here is 100.000");
    EXPECT_EQ(reported(time_off, "1750000000.25 1 2 3"),
              "time_off: 1750000000.25, and CLOCK_MONOTONIC here is 100.000: it looks like wall time");
    EXPECT_EQ(reported(time_off, "100200 1 2 3"),
              "time_off: 100200, and CLOCK_MONOTONIC here is 100.000: it looks like milliseconds");
    EXPECT_EQ(reported(time_off, "99500000 1 2 3"),
              "time_off: 99500000, and CLOCK_MONOTONIC here is 100.000: it looks like microseconds");
    EXPECT_EQ(reported(time_off, "100000000123 1 2 3"),
              "time_off: 100000000123, and CLOCK_MONOTONIC here is 100.000: it looks like nanoseconds");
    EXPECT_EQ(reported(time_off, "1 2 3"), "time_off");
}

TEST(JointText, says_what_is_wrong) {
    EXPECT_EQ(fault_of(""), JointTextFault::wrong_count);
    EXPECT_EQ(fault_of("1 2"), JointTextFault::wrong_count);
    EXPECT_EQ(fault_of("100 1 2 3 4"), JointTextFault::wrong_count);
    EXPECT_EQ(fault_of("1 2 x"), JointTextFault::not_a_number);
    EXPECT_EQ(fault_of("1 2 3x"), JointTextFault::not_a_number);
    EXPECT_EQ(fault_of("1 2 nan"), JointTextFault::not_a_number);
    EXPECT_EQ(fault_of("1 2 inf"), JointTextFault::not_a_number);
    EXPECT_EQ(fault_of("1 2 1e999"), JointTextFault::not_a_number);
    EXPECT_EQ(fault_of("98.9 1 2 3"), JointTextFault::time_off);
    EXPECT_EQ(fault_of("101.1 1 2 3"), JointTextFault::time_off);
    EXPECT_EQ(fault_of("99.1 1 2 3"), std::nullopt);
    EXPECT_EQ(fault_of("1 2 8.388607"), std::nullopt);
    EXPECT_EQ(fault_of("1 2 -8.3886071"), JointTextFault::too_large);
    EXPECT_EQ(fault_of(std::string(kJointTextMax + 1, ' ')), JointTextFault::too_long);
}

TEST(JointText, must_tell_its_time_where_nobody_knows_when_it_came) {
    const auto untimed = parse_joints("1 2 3", one_source(3), kNow, std::nullopt);
    ASSERT_FALSE(untimed);
    EXPECT_EQ(untimed.error(), JointTextFault::time_off);
    const auto timed = parse_joints("99.75 1 2 3", one_source(3), kNow, std::nullopt);
    ASSERT_TRUE(timed);
    EXPECT_EQ(timed->samples.at(0).sampled, HostTime{99'750'000'000});
}

/// An arm of two joints, and a gripper of two, of which the second turns for ever.
LineJoints arm_and_gripper() {
    return {{{.index = 0, .names = {"shoulder", "elbow"}, .rate_hz = 100.0, .turns = {false, false}},
             {.index = 2, .names = {"finger", "wheel"}, .rate_hz = 10.0, .turns = {false, true}}}};
}

TEST(JointText, of_several_sources_is_a_sample_of_each) {
    const auto line = parse_joints("99.5 0.1 0.2 0.3 0.4", arm_and_gripper(), kNow, kNow);
    ASSERT_TRUE(line);
    ASSERT_EQ(line->samples.size(), 2U);
    EXPECT_EQ(line->samples[0].position, (std::vector<double>{0.1, 0.2}));
    EXPECT_EQ(line->samples[1].position, (std::vector<double>{0.3, 0.4}));
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(line->samples[i].source, i);
        EXPECT_EQ(line->samples[i].sampled, HostTime{99'500'000'000});
    }
}

TEST(JointText, by_name_is_in_any_order_of_any_sources_and_may_have_other_names) {
    const auto both =
        parse_joints("elbow=-0.2 lamp=99 finger=0.3,wheel=0.4 shoulder=0.1", arm_and_gripper(), kNow, kNow);
    ASSERT_TRUE(both);
    ASSERT_EQ(both->samples.size(), 2U);
    EXPECT_EQ(both->samples[0].position, (std::vector<double>{0.1, -0.2}));
    EXPECT_EQ(both->samples[1].position, (std::vector<double>{0.3, 0.4}));
    EXPECT_FALSE(both->has_own_time);

    const auto gripper =
        parse_joints("99.75 wheel=0.4 lamp=nan finger=0.3 lamp=x\n", arm_and_gripper(), kNow, kNow);
    ASSERT_TRUE(gripper);
    ASSERT_EQ(gripper->samples.size(), 1U) << "no joint of the arm";
    EXPECT_EQ(gripper->samples[0].source, 1U);
    EXPECT_EQ(gripper->samples[0].sampled, HostTime{99'750'000'000});
}

TEST(JointText, by_name_has_each_name_once_with_a_number) {
    const auto fault = [](std::string_view text) {
        const auto line = parse_joints(text, arm_and_gripper(), kNow, kNow);
        return line ? std::nullopt : std::optional(line.error());
    };
    using enum JointTextFault;
    EXPECT_EQ(fault("shoulder=1 elbow="), not_a_number);
    EXPECT_EQ(fault("shoulder=1 elbow=x"), not_a_number);
    EXPECT_EQ(fault("shoulder=1 elbow=nan"), not_a_number);
    EXPECT_EQ(fault("shoulder=1 elbow=1 elbow=2"), not_a_number);
    EXPECT_EQ(fault("shoulder=1 2"), not_a_number);
    EXPECT_EQ(fault("100 100 shoulder=1 elbow=1"), not_a_number);
    EXPECT_EQ(fault("shoulder=1"), wrong_count);
    EXPECT_EQ(fault("finger=0 wheel=0 shoulder=1"), wrong_count) << "a part of the arm";
    EXPECT_EQ(fault("lamp=1"), wrong_count);
    EXPECT_EQ(fault("shoulder=1 elbow=9"), too_large);
    EXPECT_EQ(fault("50 shoulder=1 elbow=1"), time_off);
    EXPECT_EQ(fault("lamp=1000 shoulder=1 elbow=1"), std::nullopt);
    EXPECT_EQ(describe(wrong_count, "elbow=1", arm_and_gripper(), kNow),
              "wrong_count: without shoulder, which the rig has in one source with the others");
    EXPECT_EQ(describe(wrong_count, "lamp=1", arm_and_gripper(), kNow),
              "wrong_count: no name of a joint that comes through the socket");
    EXPECT_EQ(describe(too_large, "elbow=90 shoulder=0", arm_and_gripper(), kNow),
              "too_large: elbow is 90, beyond +-8.388607: degrees, or millimetres?");
}

TEST(JointText, of_a_continuous_joint_may_be_any_number_of_turns) {
    const auto line = parse_joints("0 0 0 1000.5", arm_and_gripper(), kNow, kNow);
    ASSERT_TRUE(line);
    EXPECT_NEAR(line->samples[1].position[1], std::remainder(1000.5, 2.0 * std::numbers::pi), 1e-9);
    EXPECT_EQ(fault_of("0 0 1000.5"), JointTextFault::too_large) << "without limits only";
}

TEST(JointText, takes_any_bytes) {
    std::mt19937 random(11);
    for (int i = 0; i < 20'000; ++i) {
        std::string text(random() % 64, '\0');
        for (char& letter : text) letter = "0123456789.-+e ,\n\tnaif=q1=q2=\0\xff"[random() % 30];
        const LineJoints joints = one_source(1 + random() % 7);
        const auto line = parse_joints(text, joints, kNow, kNow);
        EXPECT_TRUE(line ? !line->samples.at(0).position.empty()
                         : !describe(line.error(), text, joints, kNow).empty());
    }
}

}  // namespace
}  // namespace octoskin
