// The experiment's circle with the experiment's arm. Oracle: the circle's own equation.
#include "hw/sim/arm/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/errors/error_fields.hpp"
#include "tests/unit/hw/sim/arm/panda.hpp"

namespace octoskin::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::key_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

constexpr SimTime kStart{3'000'000};

CircleMotion paper_circle() {
    CircleMotion motion;
    motion.link = "panda_link8";
    motion.p_base_centre = {0.45, 0.0, 0.45};
    motion.radius_m = 0.3;
    motion.towards_start = {0, 1, 0};
    motion.towards_quarter = {0, 0, 1};
    motion.R_base_link = Eigen::Vector3d(1, -1, -1).asDiagonal();
    motion.ticks_per_revolution = 300;
    motion.tick_rate_hz = 30.0;
    motion.start_position.resize(7);
    motion.start_position << 0, -0.785, 0, -2.356, 0, 1.571, 0.785;
    return motion;
}

class PandaCircle : public testing::Test {
  protected:
    PandaCircle()
        : arm_(*Arm::read(kPandaUrdf, "panda_link0", kPandaJoints)),
          trajectory_(*Trajectory::circle(arm_, paper_circle(), kStart)) {}

    Eigen::Isometry3d flange(std::int64_t time_us) const {
        return arm_.forward(trajectory_.at({time_us}), "panda_link8");
    }

    Arm arm_;
    Trajectory trajectory_;
};

TEST_F(PandaCircle, is_met_at_every_tick_within_2e_7) {
    for (int tick = 0; tick <= 300; ++tick) {
        const double angle = 2.0 * 3.14159265358979323846 * tick / 300.0;
        const Eigen::Vector3d expected(0.45, 0.3 * std::cos(angle), 0.45 + 0.3 * std::sin(angle));
        // A third of the ticks are whole microseconds; the others are at most half of one away, 0.1 um of
        // path.
        const Eigen::Isometry3d T = flange(kStart.us + std::llround(tick * 1e6 / 30.0));
        const double tolerance_m = tick % 3 == 0 ? 2e-7 : 3e-7;
        EXPECT_LE((T.translation() - expected).norm(), tolerance_m) << "tick " << tick;
        const Eigen::Matrix3d R_expected = Eigen::Vector3d(1, -1, -1).asDiagonal();
        EXPECT_LE((T.linear() - R_expected).norm(), 4e-7) << "tick " << tick;
    }
}

TEST_F(PandaCircle, stays_within_20_um_of_the_arc_between_ticks) {
    for (std::int64_t t = 0; t < 10'000'000; t += 7'001) {
        const double angle = 2.0 * 3.14159265358979323846 * static_cast<double>(t) / 10e6;
        const Eigen::Vector3d expected(0.45, 0.3 * std::cos(angle), 0.45 + 0.3 * std::sin(angle));
        EXPECT_LE((flange(kStart.us + t).translation() - expected).norm(), 2e-5);
    }
}

TEST_F(PandaCircle, rests_before_and_after) {
    EXPECT_EQ(trajectory_.end().us, 13'000'000);
    const Eigen::VectorXd before = trajectory_.at({0});
    EXPECT_EQ(trajectory_.at(kStart), before);
    EXPECT_EQ(trajectory_.at({-5'000'000}), before);
    EXPECT_NE(trajectory_.at({kStart.us + 1000}), before);
    EXPECT_EQ(trajectory_.at({13'000'000}), trajectory_.at({99'000'000}));
}

TEST_F(PandaCircle, moves_no_joint_faster_than_the_panda_can) {
    // Franka's limits: 2.175 rad/s for joints 1 to 4, 2.61 rad/s for 5 to 7; and no jump between two samples.
    for (std::int64_t t = 2'900'000; t < 13'100'000; t += 10'000) {
        const Eigen::VectorXd speed = (trajectory_.at({t + 10'000}) - trajectory_.at({t})) / 0.01;
        EXPECT_LE(speed.cwiseAbs().maxCoeff(), 2.175);
    }
}

TEST_F(PandaCircle, of_two_revolutions_takes_twice_as_long) {
    CircleMotion motion = paper_circle();
    motion.revolutions = 2;
    const auto twice = Trajectory::circle(arm_, motion, kStart);
    ASSERT_TRUE(twice);
    EXPECT_EQ(twice->end().us, 23'000'000);
    EXPECT_LE((arm_.forward(twice->at({23'000'000}), "panda_link8").translation() -
               Eigen::Vector3d(0.45, 0.3, 0.45))
                  .norm(),
              2e-7);
}

TEST_F(PandaCircle, out_of_reach_is_refused_with_the_tick) {
    CircleMotion motion = paper_circle();
    motion.radius_m = 0.9;
    auto refused = Trajectory::circle(arm_, motion, kStart);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error(), AllOf(code_is(ErrorCode::out_of_range), key_is("motion.circle"),
                                       what_is(HasSubstr("tick 0"))));
    motion = paper_circle();
    motion.link = "gripper";
    EXPECT_THAT(Trajectory::circle(arm_, motion, kStart).error(),
                AllOf(code_is(ErrorCode::unknown_name), key_is("motion.circle.link"), value_is("'gripper'"),
                      what_is(HasSubstr("panda_link0, panda_link1")), remedy_is(HasSubstr("--scenario"))));
    motion = paper_circle();
    motion.start_position.resize(3);
    EXPECT_THAT(Trajectory::circle(arm_, motion, kStart).error(),
                AllOf(code_is(ErrorCode::mismatch), key_is("motion.circle.start_position_rad"),
                      what_is(HasSubstr("7 joints")), value_is("3")));
}

}  // namespace
}  // namespace octoskin::sim
