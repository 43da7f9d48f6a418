#include "host/io/tum/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::tum {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::is_no_error;
using testing_support::line_is;
using testing_support::what_is;

constexpr Nanoseconds kGapMax{50'000'000};

class TrajectoryTest : public testing::Test {
  protected:
    Trajectory read(const std::string& text) {
        auto trajectory = Trajectory::read(folder_.write("groundtruth.txt", text), kGapMax);
        EXPECT_TRUE(trajectory) << trajectory.error().message();
        return *trajectory;
    }
    Error error_of(const std::string& text) {
        const Error error = error_in(Trajectory::read(folder_.write("groundtruth.txt", text), kGapMax));
        EXPECT_TRUE(has_its_fields(error));
        return error;
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
    EXPECT_EQ(trajectory.counts().used, 3U);
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
    EXPECT_FALSE(trajectory.at(HostTime{at_ms(10'000).ns - 1'001}));
    EXPECT_FALSE(trajectory.at(HostTime{at_ms(10'100).ns + 1'001}));
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
    EXPECT_EQ(trajectory.counts().repeated, 1U);
}

TEST_F(TrajectoryTest, the_gap_that_is_bridged_is_as_it_is_asked_for) {
    const auto file = folder_.write("slow.txt", "1.00 0 0 0 0 0 0 1\n1.20 1 0 0 0 0 0 1\n");
    EXPECT_FALSE(Trajectory::read(file, Nanoseconds{199'999'999})->at(at_ms(1'100)));
    const auto wide = Trajectory::read(file, Nanoseconds{200'000'000});
    EXPECT_NEAR(wide->at(at_ms(1'100))->translation().x(), 0.5, 1e-12);
    EXPECT_EQ(wide->gap_about(at_ms(1'100)), Nanoseconds{200'000'000});
    EXPECT_EQ(wide->gap_about(at_ms(1'200)), Nanoseconds{0});
    EXPECT_FALSE(wide->gap_about(at_ms(999)));
    EXPECT_FALSE(wide->gap_about(at_ms(1'201)));
}

TEST_F(TrajectoryTest, a_pose_within_a_microsecond_is_that_of_the_instant) {
    const Trajectory trajectory = read("1.00 7 0 0 0 0 0 1\n1.0000015 8 0 0 0 0 0 1\n2 9 0 0 0 0 0 1\n");
    const auto x = [&](std::int64_t ns) { return trajectory.at(HostTime{ns})->translation().x(); };
    EXPECT_EQ(x(999'999'000), 7.0);
    EXPECT_EQ(x(1'000'000'700), 7.0);
    EXPECT_EQ(x(1'000'000'800), 8.0);
    EXPECT_EQ(x(2'000'001'000), 9.0);
    EXPECT_FALSE(trajectory.at(HostTime{999'998'999}));
    EXPECT_FALSE(trajectory.at(HostTime{2'000'001'001}));
    EXPECT_FALSE(trajectory.at(HostTime{1'000'002'501}));
}

TEST_F(TrajectoryTest, where_a_pose_is_not_known_there_is_none_up_to_its_neighbours) {
    const Trajectory trajectory =
        read("1.00 0 0 0 0 0 0 1\n1.01 nan nan nan 0 0 0 1\n1.02 2 0 0 0 0 0 1\n1.03 3 0 0 0 0 0 1\n");
    EXPECT_EQ(trajectory.counts().in, 4U);
    EXPECT_EQ(trajectory.counts().used, 3U);
    EXPECT_EQ(trajectory.counts().no_pose, 1U);
    EXPECT_TRUE(trajectory.at(at_ms(1'000)));
    for (const int ms : {1'005, 1'010, 1'015}) EXPECT_FALSE(trajectory.at(at_ms(ms))) << ms;
    EXPECT_TRUE(trajectory.at(at_ms(1'020)));
    EXPECT_NEAR(trajectory.at(at_ms(1'025))->translation().x(), 2.5, 1e-12);
}

TEST_F(TrajectoryTest, lines_that_are_no_poses_are_counted_and_the_first_is_named) {
    const Trajectory trajectory = read("1.00 0 0 0 0 0 0 1\n1.01 broken\n1.02 2 0 0 0 0 0 1\n" +
                                       std::string(4097, '7') + "\n1.03 0 0 0 0 0 0 5\n");
    const PoseCounts& counts = trajectory.counts();
    EXPECT_EQ(counts.in, 5U);
    EXPECT_EQ(counts.used, 2U);
    EXPECT_EQ(counts.bad.count, 3U);
    EXPECT_THAT(*counts.bad.first, AllOf(code_is(ErrorCode::bad_syntax), file_is("groundtruth.txt"),
                                         line_is(2), what_is(StartsWith("expected tx ty tz"))));
    EXPECT_NEAR(trajectory.at(at_ms(1'010))->translation().x(), 1.0, 1e-12);
}

TEST_F(TrajectoryTest, poses_out_of_order_are_put_in_order_and_the_first_is_named) {
    const Trajectory trajectory =
        read("# a\n1.02 2 0 0 0 0 0 1\n1.00 0 0 0 0 0 0 1\n1.01 1 0 0 0 0 0 1\n0.99 9 0 0 0 0 0 1\n");
    EXPECT_EQ(trajectory.counts().used, 4U);
    EXPECT_EQ(trajectory.counts().unordered, 2U);
    EXPECT_THAT(*trajectory.counts().disorder,
                AllOf(code_is(ErrorCode::bad_value), file_is("groundtruth.txt"), line_is(3),
                      what_is(HasSubstr("its time is before"))));
    EXPECT_NEAR(trajectory.at(at_ms(1'015))->translation().x(), 1.5, 1e-12);
}

TEST_F(TrajectoryTest, is_read_with_a_byte_order_mark_and_from_utf_16) {
    EXPECT_EQ(read("\xEF\xBB\xBF" + std::string(kQuarterTurn)).counts().used, 3U);
    std::string utf_16 = "\xFF\xFE";
    for (const char c : std::string(kQuarterTurn)) utf_16 += {c, '\0'};
    EXPECT_EQ(read(utf_16).counts().used, 3U);
}

// y upwards, in camera and map: of a camera that looked up (a positive turn about x, in such a left-handed
// frame) what it sees ahead is higher. With y down the same turn has the other sign.
TEST_F(TrajectoryTest, with_y_upwards_is_turned_into_right_handed_frames) {
    const auto file =
        folder_.write("up.txt", "1 1 2 3 0.70710678118654752 0 0 0.70710678118654752\n");  // 90 deg about x
    const auto up = Trajectory::read(file, kGapMax, CameraAxes::y_up);
    const auto T = up->at(at_ms(1'000));
    ASSERT_TRUE(T);
    EXPECT_TRUE(T->translation().isApprox(Eigen::Vector3d(1, -2, 3)));
    // In the file's frames the axis ahead (0, 0, 1) becomes (0, -1, 0), which is (0, 1, 0) with y turned.
    EXPECT_TRUE((T->linear() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
    EXPECT_NEAR(T->linear().determinant(), 1.0, 1e-12);
}

TEST_F(TrajectoryTest, without_any_pose_an_error_names_file_and_line) {
    EXPECT_THAT(error_of("# a\n\n1 0 0 zero 0 0 0 1\n"),
                AllOf(code_is(ErrorCode::bad_syntax), file_is("groundtruth.txt"), line_is(3),
                      what_is(StartsWith("expected tx ty tz"))));
    EXPECT_THAT(error_of(std::string(4097, '#') + "\n"),
                AllOf(code_is(ErrorCode::too_large), line_is(1), what_is(HasSubstr("4096 bytes"))));
    EXPECT_THAT(error_of(std::string(4096, '#') + "\n"), is_no_error());
    const auto absent = Trajectory::read(folder_ / "absent.txt", kGapMax);
    ASSERT_FALSE(absent);
    EXPECT_THAT(absent.error(), AllOf(code_is(ErrorCode::not_found), file_is("absent.txt")));
}

}  // namespace
}  // namespace octoskin::tum
