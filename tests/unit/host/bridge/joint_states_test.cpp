// sensor_msgs/JointState to lines of the joint socket.
#include "host/bridge/received/joint_states.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace octoskin::bridge {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kWallAhead = 1'700'000'000 * kSecond;  ///< of the monotonic clock

Arrival at(double s) {
    const auto ns = static_cast<std::int64_t>(std::llround(s * 1e9));
    return {HostTime{ns}, WallTime{kWallAhead + ns}};
}

ros::sensor_msgs::JointState message(double stamp_s, std::vector<std::string> names,
                                     std::vector<double> position) {
    const std::int64_t ns = at(stamp_s).wall.ns;
    return {
        .header = {{static_cast<std::int32_t>(ns / kSecond), static_cast<std::uint32_t>(ns % kSecond)}, ""},
        .name = std::move(names),
        .position = std::move(position),
        .velocity = {},
        .effort = {}};
}

/// An arm and a gripper through the socket, a rail on the bus.
class JointStatesTest : public testing::Test {
  protected:
    void TearDown() override { EXPECT_EQ(states_.counts().sum(), states_.counts().received); }
    std::optional<std::string> arm(double sent_s, double arrived_s, std::uint64_t publisher = 1) {
        return states_.take(message(sent_s, {"elbow", "shoulder"}, {2.0, 1.0}), publisher, at(arrived_s));
    }
    JointStates states_{{{true, {"shoulder", "elbow"}}, {true, {"finger"}}, {false, {"rail"}}}};
};

TEST_F(JointStatesTest, become_lines_by_name_with_the_time_of_the_sample) {
    EXPECT_EQ(arm(10.0, 10.02), "10.000000 shoulder=1 elbow=2");
    EXPECT_EQ(states_.take(message(10.1, {"wheel", "finger", "rail"}, {9.0, 0.5, 3.0}), 2, at(10.1)),
              "10.100000 finger=0.5")
        << "others are left out, and so is what comes over the bus";
    EXPECT_EQ(states_.take(message(10.2, {"finger", "shoulder", "elbow"}, {0.5, 1.0, 2.0}), 3, at(12.0)),
              std::nullopt);
    EXPECT_EQ(states_.counts().behind, 1U);
}

TEST_F(JointStatesTest, are_from_their_arrival_if_the_stamp_is_0) {
    auto unstamped = message(0.0, {"finger"}, {0.25});
    unstamped.header.stamp = {};
    EXPECT_EQ(states_.take(unstamped, 1, at(20.0)), "20.000000 finger=0.25");
    EXPECT_EQ(states_.take(unstamped, 1, at(20.5)), "20.500000 finger=0.25") << "not still";
}

TEST_F(JointStatesTest, of_a_clock_that_is_off_are_counted) {
    EXPECT_TRUE(arm(10.0, 10.149));
    EXPECT_FALSE(arm(10.1, 10.251));
    EXPECT_EQ(states_.stamp_age().count(), 151'000'000);
    EXPECT_TRUE(arm(10.3, 10.2951));
    EXPECT_FALSE(arm(10.4, 10.394));
    EXPECT_EQ(states_.stamp_age().count(), -6'000'000);
    EXPECT_EQ(states_.counts().behind, 1U);
    EXPECT_EQ(states_.counts().ahead, 1U);
}

TEST_F(JointStatesTest, whose_stamp_does_not_advance_are_counted) {
    EXPECT_TRUE(arm(10.0, 10.0));
    EXPECT_FALSE(arm(10.0, 10.01));
    EXPECT_FALSE(arm(9.99, 10.02));
    EXPECT_EQ(states_.counts().still, 2U);
}

TEST_F(JointStatesTest, that_are_wrong_are_counted_by_reason) {
    EXPECT_FALSE(states_.take(message(1.0, {"finger", "rail"}, {0.5}), 1, at(1.0)));
    EXPECT_FALSE(states_.take(message(1.0, {"finger"}, {std::nan("")}), 1, at(1.0)));
    EXPECT_FALSE(states_.take(message(1.0, {"finger", "finger"}, {0.5, 0.5}), 1, at(1.0)));
    EXPECT_FALSE(states_.take(message(1.0, {"shoulder"}, {0.5}), 1, at(1.0)));
    EXPECT_FALSE(states_.take(message(1.0, {"wheel", "rail"}, {0.5, std::nan("")}), 1, at(1.0)));
    EXPECT_FALSE(states_.take({}, 1, at(1.0)));
    states_.note_malformed();
    EXPECT_EQ(states_.counts().wrong_size, 1U);
    EXPECT_EQ(states_.counts().not_finite, 1U);
    EXPECT_EQ(states_.counts().repeated_name, 1U);
    EXPECT_EQ(states_.counts().partial, 1U);
    EXPECT_EQ(states_.missing(), "elbow");
    EXPECT_EQ(states_.counts().other_joints, 2U);
    EXPECT_EQ(states_.counts().malformed, 1U);
    EXPECT_EQ(states_.counts().forwarded, 0U);
}

TEST_F(JointStatesTest, of_two_publishers_of_the_same_joints_are_not_used) {
    EXPECT_TRUE(arm(1.0, 1.0, 1));
    EXPECT_TRUE(states_.take(message(1.01, {"finger"}, {0.5}), 2, at(1.01))) << "of other joints";
    EXPECT_FALSE(arm(1.02, 1.02, 3));
    EXPECT_FALSE(arm(1.03, 1.03, 1)) << "which of them is right is not known";
    EXPECT_EQ(states_.counts().second_sender, 2U);
    EXPECT_TRUE(arm(2.1, 2.1, 1)) << "the other one has ended";
}

TEST_F(JointStatesTest, that_come_too_often_are_thinned) {
    int forwarded = 0;
    for (int i = 0; i < 10'000; ++i) forwarded += arm(1.0 + 1e-4 * i, 1.0 + 1e-4 * i) ? 1 : 0;
    EXPECT_GE(forwarded, 990);
    EXPECT_LE(forwarded, 1112);
    EXPECT_EQ(states_.counts().too_frequent, 10'000U - static_cast<unsigned>(forwarded));
}

TEST_F(JointStatesTest, without_a_stamp_that_waited_together_are_represented_by_the_newest) {
    const auto unstamped = [](double position, double arrived_s, std::uint64_t publisher) {
        JointStates::Received one{message(0.0, {"finger"}, {position}), publisher, at(arrived_s)};
        one.message.header.stamp = {};
        return one;
    };
    EXPECT_EQ(states_.take({unstamped(0.1, 5.0, 1), unstamped(0.2, 5.0001, 1), unstamped(0.3, 5.0002, 1)}),
              std::vector<std::string>{"5.000200 finger=0.3"});
    EXPECT_EQ(states_.take({unstamped(0.4, 6.0, 1), unstamped(0.5, 6.01, 1)}).size(), 2U)
        << "these came in time";
    EXPECT_EQ(states_.counts().too_frequent, 2U);
}

TEST_F(JointStatesTest, of_many_publishers_take_bounded_memory) {
    for (std::uint64_t publisher = 0; publisher < 1000; ++publisher)
        (void)arm(1.0 + 1e-3 * static_cast<double>(publisher), 1.0 + 1e-3 * static_cast<double>(publisher),
                  publisher);
    EXPECT_GE(states_.counts().second_sender, 990U);
}

}  // namespace
}  // namespace octoskin::bridge
