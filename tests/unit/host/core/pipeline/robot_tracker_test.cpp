// Poses of a robot whose joint states come from several sources: an arm of two joints at 100 Hz, and its
// finger at 20 Hz.
#include "host/core/pipeline/robot_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace octoskin {
namespace {

constexpr std::uint8_t kArm = 0;
constexpr std::uint8_t kGripper = 1;

JointDescription joint(const char* name, const char* parent, const char* child, JointKind kind,
                       const Eigen::Vector3d& p_parent, JointLimits limits) {
    JointDescription joint;
    joint.name = name;
    joint.parent_link = parent;
    joint.child_link = child;
    joint.kind = kind;
    joint.T_parent_joint.translation() = p_parent;
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.limits = limits;
    return joint;
}

std::vector<JointDescription> joints() {
    return {joint("shoulder", "base", "upper", JointKind::revolute, {0, 0, 0.2}, {-3.0, 3.0, 2.0}),
            joint("elbow", "upper", "lower", JointKind::revolute, {0.4, 0, 0}, {-3.0, 3.0, 2.0}),
            joint("finger", "lower", "tip", JointKind::prismatic, {0.3, 0, 0}, {0.0, 0.05, 1.0})};
}

HostRig rig() {
    HostRig rig;
    rig.joint_sources = {{.node_id = 10, .joints = {"shoulder", "elbow"}, .rate_hz = 100.0},
                         {.node_id = 11, .joints = {"finger"}, .rate_hz = 20.0}};
    rig.body = {{"base", {0, 0, 0}, {0, 0, 0.2}, 0.05},
                {"lower", {0, 0, 0}, {0.3, 0, 0}, 0.04},
                {"tip", {0, 0, 0}, {0, 0, 0.06}, 0.01}};
    return rig;
}

class RobotTrackerTest : public testing::Test {
  protected:
    void arm(std::int64_t ms, double shoulder, double elbow) {
        ASSERT_TRUE(
            tracker_.add({.sampled = {ms * 1'000'000}, .position_rad = {shoulder, elbow}, .source = kArm}));
    }
    void gripper(std::int64_t ms, double finger) {
        ASSERT_TRUE(
            tracker_.add({.sampled = {ms * 1'000'000}, .position_rad = {finger}, .source = kGripper}));
    }
    const RobotPose* at(std::int64_t ms) { return tracker_.at({ms * 1'000'000}); }
    [[nodiscard]] bool is_settled(std::int64_t ms) const { return tracker_.is_settled({ms * 1'000'000}); }
    Eigen::Vector3d tip(const RobotPose& pose) {
        return pose.T_base_link[*tracker_.robot().find_link("tip")].translation();
    }

    RobotModel robot_ = RobotModel::build("base", joints(), rig().joint_names()).value();
    RobotTracker tracker_ = RobotTracker::build(rig(), robot_, {}).value();
};

TEST_F(RobotTrackerTest, interpolates_each_joint_between_the_samples_of_its_own_source) {
    arm(1000, 0.0, 0.0);
    arm(1010, 0.1, 0.0);
    gripper(980, 0.0);
    gripper(1030, 0.05);
    const RobotPose* const pose = at(1005);
    ASSERT_NE(pose, nullptr);
    EXPECT_EQ(pose->unknown, 0U);
    const Eigen::Vector3d expected(0.7 * std::cos(0.05), 0.7 * std::sin(0.05), 0.2 + 0.025);
    EXPECT_TRUE(tip(*pose).isApprox(expected, 1e-9)) << tip(*pose).transpose();
}

TEST_F(RobotTrackerTest, is_settled_once_every_source_has_a_later_sample_or_is_silent) {
    gripper(1000, 0.0);
    arm(1000, 0.0, 0.0);
    EXPECT_FALSE(is_settled(1005));
    arm(1010, 0.0, 0.0);
    EXPECT_FALSE(is_settled(1005)) << "the gripper's next sample is due";
    for (int ms = 1020; ms <= 1190; ms += 10) arm(ms, 0.0, 0.0);
    EXPECT_FALSE(is_settled(1005));
    arm(1210, 0.0, 0.0);
    EXPECT_TRUE(is_settled(1005)) << "no sample of the gripper that could follow is near enough";
    EXPECT_TRUE(is_settled(1205)) << "later readings do not wait for a silent source";
    EXPECT_FALSE(is_settled(1215));
    gripper(1215, 0.0);
    EXPECT_FALSE(is_settled(1212)) << "the arm's next sample is due";
}

TEST_F(RobotTrackerTest, places_what_a_silent_source_does_not_move) {
    arm(1000, 0.3, 0.0);
    arm(1010, 0.3, 0.0);
    gripper(500, 0.0);
    const RobotPose* const pose = at(1005);
    ASSERT_NE(pose, nullptr);
    EXPECT_EQ(pose->unknown, JointSet{4});
    EXPECT_EQ(tracker_.robot().joints_above(*tracker_.robot().find_link("lower")) & pose->unknown, 0U);
    EXPECT_NE(tracker_.robot().joints_above(*tracker_.robot().find_link("tip")) & pose->unknown, 0U);
    EXPECT_EQ(std::vector<std::uint64_t>(tracker_.times_unknown().begin(), tracker_.times_unknown().end()),
              (std::vector<std::uint64_t>{0, 0, 1}));
    ASSERT_EQ(pose->body_base.size(), 3U);
    EXPECT_EQ(pose->body_base[0].p_b, Eigen::Vector3d(0, 0, 0.2)) << "placed";
    EXPECT_NEAR(pose->body_base[1].p_b.x(), 0.7 * std::cos(0.3), 1e-9) << "placed";
    const PosedCapsule& ball = pose->body_base[2];
    EXPECT_EQ(ball.p_a, ball.p_b);
    EXPECT_NEAR(ball.p_a.x(), 0.7 * std::cos(0.3), 1e-9);
    EXPECT_NEAR(ball.radius_m, 0.05 + 0.06 + 0.01, 1e-9);
}

TEST_F(RobotTrackerTest, has_no_pose_if_no_source_has_samples) {
    EXPECT_EQ(at(1005), nullptr);
    EXPECT_FALSE(is_settled(1005));
    arm(1000, 0.0, 0.0);
    EXPECT_EQ(at(1005), nullptr);
}

TEST_F(RobotTrackerTest, has_a_present_posture_once_every_source_has_sent) {
    arm(1000, 0.1, 0.2);
    EXPECT_FALSE(tracker_.newest());
    gripper(900, 0.03);
    arm(1010, 0.2, 0.3);
    const auto newest = tracker_.newest();
    ASSERT_TRUE(newest);
    EXPECT_EQ(newest->position, (std::vector<double>{0.2, 0.3, 0.03}));
    EXPECT_EQ(newest->oldest, HostTime{900'000'000});
}

// The oracle is the placed robot in random postures.
TEST_F(RobotTrackerTest, ball_of_an_unplaced_capsule_holds_it_in_every_posture) {
    std::mt19937 random(34);
    std::uniform_real_distribution<double> turn(-3.0, 3.0);
    std::uniform_real_distribution<double> slide(0.0, 0.05);
    const RobotBody body = RobotBody::build(rig().body, robot_).value();
    std::vector<Eigen::Isometry3d> T_base_link(robot_.link_count());
    std::vector<PosedCapsule> placed;
    std::vector<PosedCapsule> balls;
    double nearest_m = 1.0;  // of a capsule's end to the surface of its ball
    for (int i = 0; i < 20'000; ++i) {
        const std::array<double, 3> known{turn(random), turn(random), slide(random)};
        const auto unknown = static_cast<JointSet>(1 + random() % 7);
        robot_.forward(known, T_base_link);
        body.pose(robot_, T_base_link, unknown, balls);
        std::array<double, 3> other = known;
        for (std::size_t joint = 0; joint < 3; ++joint)
            if ((unknown >> joint & 1U) != 0) other[joint] = joint < 2 ? turn(random) : slide(random);
        robot_.forward(other, T_base_link);
        body.pose(T_base_link, placed);
        for (std::size_t capsule = 0; capsule < placed.size(); ++capsule) {
            for (const Eigen::Vector3d& end : {placed[capsule].p_a, placed[capsule].p_b}) {
                const double reach_m = (end - balls[capsule].p_a).norm() + placed[capsule].radius_m;
                const bool is_ball = balls[capsule].p_a == balls[capsule].p_b;
                if (!is_ball) {
                    EXPECT_TRUE(placed[capsule].p_a.isApprox(balls[capsule].p_a, 1e-12));
                    continue;
                }
                EXPECT_LE(reach_m, balls[capsule].radius_m + 1e-9) << capsule << ' ' << unknown;
                nearest_m = std::min(nearest_m, balls[capsule].radius_m - reach_m);
            }
        }
    }
    EXPECT_LT(nearest_m, 0.02) << "the ball is no larger than it must be";
}

}  // namespace
}  // namespace octoskin
