// The camera or a joint: which of the two explains what several sensors contradict.
#include "host/core/cross_check/pose_judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "host/core/cross_check/cross_check.hpp"

namespace octoskin {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kSensors = 6;

/// Even over 0 .. 1.
double draw(int i, double step) {
    return std::fmod(step * i, 1.0);
}

/// Sensors look at planes of all directions about 2 m before the camera. Joint 2 turns about an axis that
/// stays where it is, as the first of an arm does; joint 4's turns with the posture, and joint 6 moves none.
class PoseJudgeTest : public testing::Test {
  protected:
    static JointTwists twists_at(int image) {
        const auto about = [](const Vector3d& axis, const Vector3d& through) {
            return JointTwist{.turn = axis, .shift = through.cross(axis)};
        };
        const double posture = 0.05 * image;
        JointTwists twists;
        twists[2] = about(Vector3d::UnitY(), {0.2, 0.0, 1.5});
        twists[4] = about(Vector3d(std::cos(posture), 0.0, std::sin(posture)),
                          {0.3 * std::sin(posture), 0.3 * std::cos(posture), 1.6});
        return twists;
    }

    static RangeChange change_at(int image, std::size_t sensor) {
        const int i = image * static_cast<int>(kSensors) + static_cast<int>(sensor);
        const Vector3d p(-0.8 + 1.6 * draw(i, 0.618), -0.6 + 1.2 * draw(i, 0.414), 1.6 + draw(i, 0.732));
        const Vector3d normal =
            Vector3d(-0.8 + 1.6 * draw(i, 0.236), -0.8 + 1.6 * draw(i, 0.303), -1.0).normalized();
        const PlaneHit hit{.p = p,
                           .direction = (Vector3d(0.2, 0.1, 1.0) + 0.3 * p).normalized(),
                           .plane = {.normal = normal, .distance_m = -normal.dot(p)},
                           .share = 1.0};
        return range_change({.off_m = 0.0, .sigma_m = 0.02, .is_from_behind = false}, {&hit, 1})
            .value_or(RangeChange{});
    }

    /// Images of ten per second, from the first one on. `off`: what a range is off by, of its change.
    template <typename Off>
    void look(int images, const Off& off) {
        for (int image = 0; image < images; ++image) look_at(image, off);
    }

    template <typename Off>
    void look_at(int image, const Off& off) {
        const JointTwists twists = twists_at(image);
        for (std::size_t sensor = 0; sensor < kSensors; ++sensor) {
            RangeChange change = change_at(image, sensor);
            if (change.weight == 0.0) continue;
            change.off_m = off(change, twists, sensor);
            judge_.compare(static_cast<std::uint16_t>(sensor), change, twists);
        }
        judge_.decide(HostTime{100'000'000LL * image});
    }

    PoseJudge judge_{kSensors, 7};
};

TEST_F(PoseJudgeTest, finds_nothing_where_nothing_is_off) {
    look(100, [](const RangeChange&, const JointTwists&, std::size_t) { return 0.0; });
    EXPECT_FALSE(judge_.fault());
    EXPECT_FALSE(judge_.is_suspect());
}

TEST_F(PoseJudgeTest, names_the_joint_that_is_off_after_some_seconds_and_the_camera_beside_it_until_then) {
    const auto off = [](const RangeChange& change, const JointTwists& twists, std::size_t) {
        return 0.05 * change.of_joint(twists[4]);
    };
    int image = 0;
    while (image < 100 && !judge_.fault()) look_at(image++, off);
    ASSERT_TRUE(judge_.fault());
    EXPECT_TRUE(judge_.fault()->camera && judge_.fault()->joint);
    EXPECT_TRUE(judge_.is_suspect());
    while (image < 150) look_at(image++, off);
    ASSERT_TRUE(judge_.fault());
    EXPECT_FALSE(judge_.fault()->camera);
    ASSERT_TRUE(judge_.fault()->joint);
    EXPECT_EQ(judge_.fault()->joint->joint, 4U);
    EXPECT_NEAR(judge_.fault()->joint->offset, 0.05, 0.01);
    EXPECT_GE(judge_.fault()->explained, 4U);
}

TEST_F(PoseJudgeTest, names_neither_before_an_error_has_lasted_3_s) {
    const auto off = [](const RangeChange& change, const JointTwists& twists, std::size_t) {
        return 0.05 * change.of_joint(twists[4]);
    };
    int suspect_since = 0;
    while (suspect_since < 100 && !judge_.is_suspect()) look_at(suspect_since++, off);
    ASSERT_TRUE(judge_.is_suspect());
    for (int image = suspect_since; image < suspect_since + 30; ++image) {
        EXPECT_FALSE(judge_.fault()) << image;
        look_at(image, off);
    }
}

TEST_F(PoseJudgeTest, cannot_tell_the_camera_from_a_joint_whose_axis_stays_where_it_is) {
    look(150, [](const RangeChange& change, const JointTwists& twists, std::size_t) {
        return 0.03 * change.of_joint(twists[2]);
    });
    ASSERT_TRUE(judge_.fault());
    EXPECT_TRUE(judge_.fault()->camera);
    ASSERT_TRUE(judge_.fault()->joint);
    EXPECT_EQ(judge_.fault()->joint->joint, 2U);
    EXPECT_NEAR(judge_.fault()->joint->offset, 0.03, 0.01);
}

TEST_F(PoseJudgeTest, names_the_camera_alone_where_no_joint_does_the_same) {
    look(150, [](const RangeChange& change, const JointTwists&, std::size_t) {
        return change.of_camera.head<3>().dot(Vector3d(0.02, -0.02, 0.03)) +
               change.of_camera.segment<3>(3).dot(Vector3d(0.02, 0.03, 0.01));
    });
    ASSERT_TRUE(judge_.fault());
    EXPECT_TRUE(judge_.fault()->camera);
    EXPECT_FALSE(judge_.fault()->joint);
}

TEST_F(PoseJudgeTest, one_sensor_that_is_off_is_neither) {
    look(150,
         [](const RangeChange&, const JointTwists&, std::size_t sensor) { return sensor == 1 ? 0.06 : 0.0; });
    EXPECT_FALSE(judge_.fault());
    EXPECT_FALSE(judge_.is_suspect());
}

TEST_F(PoseJudgeTest, says_which_of_the_two_it_is_and_by_how_much) {
    const std::vector<std::string> joints = {"shoulder", "elbow"};
    const CameraError camera{.turn_deg = {0.0, 2.0, 0.0}, .shift_m = {0.03, 0.0, 0.0}, .depth_scale = 1.0};
    const JointError joint{.joint = 1, .offset = -0.05};
    const std::string both = describe(PoseFault{camera, joint, 3}, joints);
    EXPECT_EQ(both.find("camera or joint elbow: "), 0U) << both;
    EXPECT_NE(both.find("-0.050 rad"), std::string::npos) << both;
    EXPECT_NE(both.find("turned by 2.0 deg"), std::string::npos) << both;
    EXPECT_EQ(describe(PoseFault{camera, std::nullopt, 3}, joints).find("camera: "), 0U);
    EXPECT_EQ(describe(PoseFault{std::nullopt, joint, 3}, joints).find("joint elbow: "), 0U);
}

}  // namespace
}  // namespace octoskin
