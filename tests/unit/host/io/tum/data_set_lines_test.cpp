// Lines as the benchmark's description shows them, and lines that are none.
#include "host/io/tum/data_set_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace octoskin::tum {
namespace {

using testing::HasSubstr;

TEST(DataSetLines, an_image_has_a_time_to_the_nanosecond_and_a_name) {
    const auto image = parse_image_line("1305031102.160407 depth/1305031102.160407.png");
    ASSERT_TRUE(image);
    EXPECT_EQ(image->captured.ns, 1'305'031'102'160'407'000);
    EXPECT_EQ(image->file, "depth/1305031102.160407.png");
}

TEST(DataSetLines, a_time_may_have_any_number_of_decimals) {
    const auto ns = [](const char* line) { return parse_image_line(line)->captured.ns; };
    EXPECT_EQ(ns("7 a.png"), 7'000'000'000);
    EXPECT_EQ(ns("7. a.png"), 7'000'000'000);
    EXPECT_EQ(ns("7.5 a.png"), 7'500'000'000);
    EXPECT_EQ(ns("0.123456789 a.png"), 123'456'789);
    EXPECT_EQ(ns("0.1234567899 a.png"), 123'456'789);
    EXPECT_EQ(ns("9000000000 a.png"), 9'000'000'000'000'000'000);
}

TEST(DataSetLines, a_pose_takes_points_of_the_camera_into_the_map) {
    // Half a turn about z by its quaternion x y z w = 0 0 1 0.
    const auto pose = parse_pose_line("1305031102.1758 1.25 -2 0.5 0 0 1 0");
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->at.ns, 1'305'031'102'175'800'000);
    EXPECT_TRUE(
        (pose->T_map_camera * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(0.25, -4, 3.5), 1e-15));
}

TEST(DataSetLines, a_camera_that_looks_along_x_has_the_quaternion_that_says_so) {
    // Optical frame: z forward, x right, y down; map: x forward, z up.
    const auto pose = parse_pose_line("1 0 0 0 0.5 -0.5 0.5 -0.5");
    ASSERT_TRUE(pose);
    EXPECT_TRUE((pose->T_map_camera * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));
    EXPECT_TRUE((pose->T_map_camera * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));
    EXPECT_TRUE((pose->T_map_camera * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ()));
}

TEST(DataSetLines, a_quaternion_of_four_decimals_becomes_a_rotation) {
    const auto pose = parse_pose_line("1305031098.6659 1.3563 0.6305 1.6380 0.6132 0.5962 -0.3311 -0.3986");
    ASSERT_TRUE(pose);
    const Eigen::Matrix3d R = pose->T_map_camera.linear();
    EXPECT_TRUE((R * R.transpose()).isIdentity(1e-14));
    EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
}

TEST(DataSetLines, what_is_no_image_line_is_refused_with_the_reason) {
    for (const auto& [line, reason] : std::initializer_list<std::pair<const char*, const char*>>{
             {"", "expected a time in seconds, found ''"},
             {"depth/1.png 1", "found 'depth/1.png'"},
             {"-1 a.png", "found '-1'"},
             {"1.5e9 a.png", "found '1.5e9'"},
             {"1.-5 a.png", "found '1.-5'"},
             {".5 a.png", "found '.5'"},
             {"9000000001 a.png", "found '9000000001'"},
             {"99999999999999999999 a.png", "expected a time"},
             {"nan a.png", "found 'nan'"},
             {"1.5", "expected the name of an image"},
             {"1.5  \t", "expected the name of an image"},
             {"1.5 a.png b.png", "found more"}}) {
        const auto image = parse_image_line(line);
        ASSERT_FALSE(image) << line;
        EXPECT_THAT(image.error(), HasSubstr(reason)) << line;
    }
}

TEST(DataSetLines, what_is_no_pose_line_is_refused_with_the_reason) {
    for (const auto& [line, reason] : std::initializer_list<std::pair<const char*, const char*>>{
             {"x 0 0 0 0 0 0 1", "expected a time"},
             {"1 0 0 0 0 0 0", "found ''"},
             {"1 0 0 0 0 0 0 1 0", "found more"},
             {"1 0 0 zero 0 0 0 1", "found 'zero'"},
             {"1 0 0 nan 0 0 0 1", "found 'nan'"},
             {"1 0 0 inf 0 0 0 1", "found 'inf'"},
             {"1 0 0 1000001 0 0 0 1", "found '1000001'"},
             {"1 0 0 1,5 0 0 0 1", "found '1,5'"},
             {"1 0 0 0 0 0 0 0", "length is 0.0"},
             {"1 0 0 0 0 0 0 1.02", "length is 1.02"},
             {"1 0 0 0 0 0 0 0.98", "length is 0.98"}}) {
        const auto pose = parse_pose_line(line);
        ASSERT_FALSE(pose) << line;
        EXPECT_THAT(pose.error(), HasSubstr(reason)) << line;
    }
}

}  // namespace
}  // namespace octoskin::tum
