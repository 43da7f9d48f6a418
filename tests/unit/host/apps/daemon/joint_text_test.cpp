#include <gtest/gtest.h>

#include <random>
#include <string>

#include "host/apps/daemon/joint_socket.hpp"

namespace octoskin {
namespace {

constexpr HostTime kNow{100'000'000'000};

std::optional<JointTextFault> fault_of(std::string_view text, std::size_t joints = 3) {
    const auto sample = parse_joints(text, joints, kNow, kNow);
    return sample ? std::nullopt : std::optional(sample.error());
}

TEST(JointText, is_positions_of_when_it_came_or_of_the_time_before_them) {
    const HostTime came = kNow - std::chrono::milliseconds(20);
    const auto now = parse_joints("0.5 -1e-3 8\n", 3, kNow, came);
    ASSERT_TRUE(now);
    EXPECT_EQ(now->sampled, came);
    EXPECT_EQ(now->position, (std::vector<double>{0.5, -1e-3, 8.0}));
    const auto timed = parse_joints("99.75, 1, 2,\t3", 3, kNow, came);
    ASSERT_TRUE(timed);
    EXPECT_EQ(timed->sampled, HostTime{99'750'000'000});
    EXPECT_EQ(timed->position, (std::vector<double>{1, 2, 3}));
}

TEST(JointText, fault_is_told_with_what_is_wrong_and_what_it_may_be) {
    const auto reported = [](JointTextFault fault, std::string_view text) {
        return describe(fault, text, 3, kNow);
    };
    using enum JointTextFault;
    EXPECT_EQ(reported(wrong_count, "1 2\n"), "wrong_count: 2 numbers, the rig has 3 joints");
    EXPECT_EQ(reported(not_a_number, "1, x7 y"), "not_a_number: \"x7\"");
    EXPECT_EQ(reported(too_large, "0.1 -90 45"),
              "too_large: joint 2 of 3 is -90, beyond +-8.388607: degrees, or millimetres?");
    EXPECT_EQ(reported(too_large, "99.5 0.1 0 9"),
              "too_large: joint 3 of 3 is 9, beyond +-8.388607: degrees, or millimetres?");
    EXPECT_EQ(reported(too_long, "1 2 3"), "too_long: over 1024 bytes");
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
    const auto untimed = parse_joints("1 2 3", 3, kNow, std::nullopt);
    ASSERT_FALSE(untimed);
    EXPECT_EQ(untimed.error(), JointTextFault::time_off);
    const auto timed = parse_joints("99.75 1 2 3", 3, kNow, std::nullopt);
    ASSERT_TRUE(timed);
    EXPECT_EQ(timed->sampled, HostTime{99'750'000'000});
}

TEST(JointText, takes_any_bytes) {
    std::mt19937 random(11);
    for (int i = 0; i < 20'000; ++i) {
        std::string text(random() % 64, '\0');
        for (char& letter : text) letter = "0123456789.-+e ,\n\tnaif\0\xff"[random() % 24];
        const std::size_t joints = 1 + random() % 7;
        const auto sample = parse_joints(text, joints, kNow, kNow);
        EXPECT_TRUE(sample ? !sample->position.empty()
                           : !describe(sample.error(), text, joints, kNow).empty());
    }
}

}  // namespace
}  // namespace octoskin
