#include "host/io/tum/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::tum {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class TrajectoryTest : public testing::Test {
  protected:
    Trajectory read(const std::string& text) {
        auto trajectory = Trajectory::read(folder_.write("groundtruth.txt", text));
        EXPECT_TRUE(trajectory) << trajectory.error().what;
        return *trajectory;
    }
    std::string error_of(const std::string& text) {
        const auto trajectory = Trajectory::read(folder_.write("groundtruth.txt", text));
        return trajectory ? "no error" : trajectory.error().what;
    }

    testing_support::ScratchFolder folder_;
};

constexpr HostTime at_ms(std::int64_t ms) {
    return HostTime{1'000'000 * ms};
}

// A quarter turn about z and 1 m along x within 40 ms.
constexpr const char* kQuarterTurn =
    "# comment\n"
    "\n"
    "10.00 0 0 0 0 0 0 1\r\n"
    "10.04 1 0 0 0 0 0.70710678118654752 0.70710678118654752\n"
    "10.10 2 0 0 0 0 0 1\n";

TEST_F(TrajectoryTest, gives_each_pose_at_its_own_time) {
    const Trajectory trajectory = read(kQuarterTurn);
    EXPECT_EQ(trajectory.poses(), 3U);
    EXPECT_TRUE(trajectory.at(at_ms(10'000))->isApprox(Eigen::Isometry3d::Identity()));
    EXPECT_EQ(trajectory.at(at_ms(10'040))->translation().x(), 1.0);
    EXPECT_EQ(trajectory.at(at_ms(10'100))->translation().x(), 2.0);
}

TEST_F(TrajectoryTest, turns_and_moves_evenly_between_two_poses) {
    const Trajectory trajectory = read(kQuarterTurn);
    for (int ms = 0; ms <= 40; ++ms) {
        const auto T_map_camera = trajectory.at(at_ms(10'000 + ms));
        ASSERT_TRUE(T_map_camera) << ms;
        const double angle = std::numbers::pi / 2 * ms / 40.0;
        const Eigen::Vector3d x = T_map_camera->linear() * Eigen::Vector3d::UnitX();
        EXPECT_NEAR(x.x(), std::cos(angle), 1e-12) << ms;
        EXPECT_NEAR(x.y(), std::sin(angle), 1e-12) << ms;
        EXPECT_NEAR(T_map_camera->translation().x(), ms / 40.0, 1e-12) << ms;
    }
}

TEST_F(TrajectoryTest, a_quaternion_and_its_negative_are_the_same_and_no_turn_lies_between) {
    const Trajectory trajectory = read("1.00 0 0 0 0 0 0 1\n1.02 0 0 0 0 0 0 -1\n");
    EXPECT_TRUE(trajectory.at(at_ms(1'010))->linear().isIdentity(1e-12));
}

TEST_F(TrajectoryTest, knows_nothing_before_behind_or_within_a_gap) {
    const Trajectory trajectory = read(kQuarterTurn);
    EXPECT_FALSE(trajectory.at(HostTime{at_ms(10'000).ns - 1}));
    EXPECT_FALSE(trajectory.at(HostTime{at_ms(10'100).ns + 1}));
    EXPECT_FALSE(trajectory.at(at_ms(10'041)));  // 60 ms between the poses about it
    EXPECT_FALSE(read("").at(at_ms(0)));
}

TEST_F(TrajectoryTest, a_gap_of_exactly_50_ms_is_none) {
    EXPECT_TRUE(read("1.00 0 0 0 0 0 0 1\n1.05 0 0 0 0 0 0 1\n").at(at_ms(1'025)));
    EXPECT_FALSE(read("1.00 0 0 0 0 0 0 1\n1.050000001 0 0 0 0 0 0 1\n").at(at_ms(1'025)));
}

TEST_F(TrajectoryTest, of_two_poses_with_one_time_the_first_counts) {
    const Trajectory trajectory = read("1 5 0 0 0 0 0 1\n1 6 0 0 0 0 0 1\n1.01 5 0 0 0 0 0 1\n");
    EXPECT_EQ(trajectory.at(at_ms(1'000))->translation().x(), 5.0);
    EXPECT_EQ(trajectory.at(at_ms(1'005))->translation().x(), 5.0);
    EXPECT_EQ(trajectory.repeated(), 1U);
}

TEST_F(TrajectoryTest, an_error_names_file_and_line) {
    const std::string file = (folder_ / "groundtruth.txt").string();
    EXPECT_EQ(error_of("# a\n1 0 0 0 0 0 0 1\n0.9 0 0 0 0 0 0 1\n"),
              file + ":3: its time is before that of the pose above it");
    EXPECT_THAT(error_of("# a\n\n1 0 0 zero 0 0 0 1\n"), StartsWith(file + ":3: expected tx ty tz"));
    EXPECT_THAT(error_of("1 0 0 0 0 0 0 1\n" + std::string(4097, '#') + "\n"),
                StartsWith(file + ":2: longer than 4096 bytes"));
    EXPECT_EQ(error_of("1 0 0 0 0 0 0 1\n" + std::string(4096, '#') + "\n"), "no error");
    const auto absent = Trajectory::read(folder_ / "absent.txt");
    ASSERT_FALSE(absent);
    EXPECT_THAT(absent.error().what, HasSubstr("absent.txt: no such file"));
}

}  // namespace
}  // namespace octoskin::tum
