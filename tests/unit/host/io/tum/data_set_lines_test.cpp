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
    EXPECT_EQ(ns(".5 a.png"), 500'000'000);
    EXPECT_EQ(ns("9000000000 a.png"), 9'000'000'000'000'000'000);
}

TEST(DataSetLines, a_time_with_an_exponent_or_a_plus_is_exactly_the_decimal_that_it_writes) {
    const auto ns = [](const char* line) { return parse_image_line(line)->captured.ns; };
    // As evo and numpy.savetxt write 1305031102.175303936 and 1403636579.763555527.
    EXPECT_EQ(ns("1.305031102175303936e+09 a.png"), 1'305'031'102'175'303'936);
    EXPECT_EQ(ns("1.403636579763555527E9 a.png"), 1'403'636'579'763'555'527);
    EXPECT_EQ(ns("+1305031102.5 a.png"), 1'305'031'102'500'000'000);
    EXPECT_EQ(ns("0.000000000000000000e+00 a.png"), 0);
    EXPECT_EQ(ns("12345e-3 a.png"), 12'345'000'000);
    EXPECT_EQ(ns("1e-9 a.png"), 1);
    EXPECT_EQ(ns("1e-10 a.png"), 0);
    EXPECT_EQ(ns("0e+99 a.png"), 0);
    EXPECT_EQ(ns("0.0000000009e19 a.png"), 9'000'000'000'000'000'000);
}

TEST(DataSetLines, of_a_colour_and_a_depth_image_the_depth_image_is_taken_whichever_comes_first) {
    const auto icl = parse_image_line("7 depth/7.png 7 rgb/7.png");
    ASSERT_TRUE(icl) << icl.error();
    EXPECT_EQ(icl->file, "depth/7.png");
    const auto tum = parse_image_line("1.25 rgb/a.png 1.50 Depth/b.png");
    ASSERT_TRUE(tum) << tum.error();
    EXPECT_EQ(tum->file, "Depth/b.png");
    EXPECT_EQ(tum->captured.ns, 1'500'000'000);
    EXPECT_THAT(parse_image_line("1 a.png 1 b.png").error(), HasSubstr("found 'a.png' and 'b.png'"));
    EXPECT_FALSE(parse_image_line("1 depth/a.png 1 depth/b.png"));
}

TEST(DataSetLines, a_pose_of_no_number_or_of_a_zero_quaternion_is_not_known) {
    for (const char* line : {"1 nan nan nan nan nan nan nan", "1 0 0 NaN 0 0 0 1", "1 0 0 -inf 0 0 0 1",
                             "1 1.0 2.0 3.0 0 0 0 0", "1e0 0 0 0 -0.0 0e+00 0 0"}) {
        const auto pose = parse_pose_line(line);
        ASSERT_TRUE(pose) << line << ": " << pose.error();
        EXPECT_EQ(pose->at.ns, 1'000'000'000) << line;
        EXPECT_FALSE(pose->T_map_camera) << line;
    }
}

TEST(DataSetLines, a_matrix_is_a_pose_row_by_row) {
    const auto pose = parse_pose_matrix(
        " 0.0e+000\t-1 0 1.5\r\n 1 0 0 -2\n 0 0 1 +0.5\n 0 0 0 1\n");  // a quarter turn about z
    ASSERT_TRUE(pose) << pose.error();
    EXPECT_TRUE((**pose * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(-0.5, -1, 3.5), 1e-12));
    EXPECT_FALSE(*parse_pose_matrix("-inf 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"));
    EXPECT_FALSE(*parse_pose_matrix("0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"));
    for (const auto& [text, reason] : std::initializer_list<std::pair<const char*, const char*>>{
             {"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0", "found 15"},
             {"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0", "found more"},
             {"1 0 0 0 0 1 0 0 0 0 1 x 0 0 0 1", "found 'x'"},
             {"1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1", "not a rotation"},
             {"1.1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "not a rotation"},
             {"1 0 0 2e6 0 1 0 0 0 0 1 0 0 0 0 1", "1000 km"},
             {"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2", "last row"}}) {
        const auto bad = parse_pose_matrix(text);
        ASSERT_FALSE(bad) << text;
        EXPECT_THAT(bad.error(), HasSubstr(reason)) << text;
    }
}

TEST(DataSetLines, a_pose_takes_points_of_the_camera_into_the_map) {
    // Half a turn about z by its quaternion x y z w = 0 0 1 0.
    const auto pose = parse_pose_line("1305031102.1758 1.25 -2 0.5 0 0 1 0");
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->at.ns, 1'305'031'102'175'800'000);
    EXPECT_TRUE(
        (*pose->T_map_camera * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(0.25, -4, 3.5), 1e-15));
}

TEST(DataSetLines, a_camera_that_looks_along_x_has_the_quaternion_that_says_so) {
    // Optical frame: z forward, x right, y down; map: x forward, z up.
    const auto pose = parse_pose_line("1 0 0 0 0.5 -0.5 0.5 -0.5");
    ASSERT_TRUE(pose);
    EXPECT_TRUE((*pose->T_map_camera * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));
    EXPECT_TRUE((*pose->T_map_camera * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));
    EXPECT_TRUE((*pose->T_map_camera * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ()));
}

TEST(DataSetLines, a_quaternion_of_four_decimals_becomes_a_rotation) {
    const auto pose = parse_pose_line("1305031098.6659 1.3563 0.6305 1.6380 0.6132 0.5962 -0.3311 -0.3986");
    ASSERT_TRUE(pose);
    const Eigen::Matrix3d R = pose->T_map_camera->linear();
    EXPECT_TRUE((R * R.transpose()).isIdentity(1e-14));
    EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
}

TEST(DataSetLines, what_is_no_image_line_is_refused_with_the_reason) {
    for (const auto& [line, reason] : std::initializer_list<std::pair<const char*, const char*>>{
             {"", "expected a time in seconds, found ''"},
             {"depth/1.png 1", "found 'depth/1.png'"},
             {"-1 a.png", "found '-1'"},
             {"1.5e10 a.png", "found '1.5e10'"},
             {"1.5e a.png", "found '1.5e'"},
             {"1e1.5 a.png", "found '1e1.5'"},
             {"1e-99999 a.png", "found '1e-99999'"},
             {"++1 a.png", "found '++1'"},
             {"+-1 a.png", "found '+-1'"},
             {"0x10 a.png", "found '0x10'"},
             {"1.-5 a.png", "found '1.-5'"},
             {". a.png", "found '.'"},
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
             {"1 0 0 1e999 0 0 0 1", "found '1e999'"},
             {"1 0 0 1000001 0 0 0 1", "found '1000001'"},
             {"1 0 0 1,5 0 0 0 1", "found '1,5'"},
             {"1 0 0 0 0 0 0 0.001", "length is 0.001"},
             {"1 0 0 0 0 0 0 1.02", "length is 1.02"},
             {"1 0 0 0 0 0 0 0.98", "length is 0.98"}}) {
        const auto pose = parse_pose_line(line);
        ASSERT_FALSE(pose) << line;
        EXPECT_THAT(pose.error(), HasSubstr(reason)) << line;
    }
}

}  // namespace
}  // namespace octoskin::tum
