#include "host/lab/evaluation/survey.hpp"

#include <gtest/gtest.h>

#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::evaluation {
namespace {

TEST(Survey, of_the_experiment_has_72_places_around_28_in_front_and_6_above) {
    const auto viewpoints = viewpoints_of(SurveyPattern{});
    ASSERT_EQ(viewpoints.size(), 106U);
    for (std::size_t i = 0; i < 72; ++i) {
        const Eigen::Vector2d from_centre = viewpoints[i].p_base_camera.head<2>() - Eigen::Vector2d(0.6, 0.0);
        EXPECT_NEAR(from_centre.norm(), 1.9, 1e-12);
    }
    EXPECT_EQ(viewpoints[0].p_base_camera.z(), 0.25);
    EXPECT_EQ(viewpoints[71].p_base_camera.z(), 1.7);
    EXPECT_EQ(viewpoints[72].p_base_camera, Eigen::Vector3d(-0.4, -0.9, 0.25));
    EXPECT_EQ(viewpoints[99].p_base_camera, Eigen::Vector3d(0.05, 0.9, 0.75));
    EXPECT_EQ(viewpoints[105].p_base_camera, Eigen::Vector3d(1.2, 0.5, 2.4));
}

TEST(Survey, every_camera_looks_at_its_point_with_the_image_upright) {
    for (const auto& viewpoint : viewpoints_of(SurveyPattern{})) {
        const Eigen::Isometry3d T_base_camera = T_base_camera_of(viewpoint);
        const Eigen::Matrix3d R = T_base_camera.linear();
        ASSERT_TRUE((R.transpose() * R).isIdentity(1e-12));
        ASSERT_NEAR(R.determinant(), 1.0, 1e-12);
        const Eigen::Vector3d p_camera = T_base_camera.inverse() * viewpoint.p_base_look_at;
        ASSERT_NEAR(p_camera.head<2>().norm(), 0.0, 1e-12);
        ASSERT_GT(p_camera.z(), 0.0);
        ASSERT_LE(R.col(1).z(), 1e-12) << "the optical frame's y axis points down";
    }
}

TEST(Survey, fitted_to_the_experiments_region_is_the_experiments_tour) {
    const auto fitted = viewpoints_of(SurveyPattern::around({-0.6, -1.2, -0.02}, {1.4, 1.2, 1.4}));
    const auto given = viewpoints_of(SurveyPattern{});
    ASSERT_EQ(fitted.size(), given.size());
    for (std::size_t i = 0; i < given.size(); ++i) {
        EXPECT_LT((fitted[i].p_base_camera - given[i].p_base_camera).norm(), 0.001) << i;
        EXPECT_LT((fitted[i].p_base_look_at - given[i].p_base_look_at).norm(), 0.021) << i;
    }
}

TEST(Survey, fitted_to_another_region_stands_around_it_and_above_it) {
    const Eigen::Vector3d min(10.0, -1.0, 0.0);
    const Eigen::Vector3d max(12.0, 1.0, 1.0);
    const auto viewpoints = viewpoints_of(SurveyPattern::around(min, max));
    ASSERT_EQ(viewpoints.size(), 106U);
    const Eigen::AlignedBox2d footprint(min.head<2>(), max.head<2>());
    for (std::size_t i = 0; i < 72; ++i) {
        EXPECT_FALSE(footprint.contains(viewpoints[i].p_base_camera.head<2>()));
    }
    for (std::size_t i = 72; i < 100; ++i) {
        EXPECT_TRUE(Eigen::AlignedBox3d(min, max).contains(viewpoints[i].p_base_camera));
    }
    for (std::size_t i = 100; i < 106; ++i) {
        EXPECT_DOUBLE_EQ(viewpoints[i].p_base_camera.z(), 2.0);
    }
}

TEST(Survey, does_not_look_out_of_a_solid) {
    const sim::World world({box("block", {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0})});
    SurveyConfig config;
    config.viewpoints = {{{0.5, 0.5, 0.5}, {5.0, 0.5, 0.5}}, {{2.0, 0.5, 0.5}, {0.5, 0.5, 0.5}}};
    const Survey survey = render_survey(world, config);
    ASSERT_EQ(survey.views.size(), 1U);
    EXPECT_EQ(survey.views[0].p_base_camera.x(), 2.0);
}

TEST(RenderView, puts_each_pixel_on_the_surface_it_sees) {
    const sim::World world({box("wall", {1.0, -5.0, -5.0}, {1.1, 5.0, 5.0})});
    const rig::Camera camera{.width = 4, .height = 2, .fx = 2.0, .fy = 2.0, .cx = 2.0, .cy = 1.0};
    const auto T_base_camera = T_base_camera_of({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
    const DepthView view = render_view(world, camera, T_base_camera, 1);
    ASSERT_EQ(view.p_base_points.size(), 8U);
    // Pixel (0, 0): ((0 + 0.5 - 2) / 2, (0 + 0.5 - 1) / 2, 1) in the optical frame, left and up.
    EXPECT_TRUE(view.p_base_points[0].isApprox(Eigen::Vector3f(1.0F, 0.75F, 0.25F), 1e-6F));
    // Pixel (3, 1): right and down.
    EXPECT_TRUE(view.p_base_points[7].isApprox(Eigen::Vector3f(1.0F, -0.75F, -0.25F), 1e-6F));
}

TEST(RenderView, leaves_out_what_is_nearer_or_further_than_the_camera_sees) {
    const sim::World world({box("wall", {1.0, -5.0, -5.0}, {1.1, 5.0, 5.0})});
    const auto T_base_camera = T_base_camera_of({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
    rig::Camera camera{.width = 2, .height = 2, .fx = 2.0, .fy = 2.0, .cx = 1.0, .cy = 1.0};
    camera.depth_min_m = 1.01;
    EXPECT_TRUE(render_view(world, camera, T_base_camera, 1).p_base_points.empty());
    camera.depth_min_m = 0.5;
    camera.depth_max_m = 0.99;
    EXPECT_TRUE(render_view(world, camera, T_base_camera, 1).p_base_points.empty());
    camera.depth_max_m = 4.5;
    EXPECT_EQ(render_view(world, camera, T_base_camera, 1).p_base_points.size(), 4U);
}

TEST(RenderView, strides_over_pixels_in_both_directions) {
    const sim::World world({box("wall", {1.0, -5.0, -5.0}, {1.1, 5.0, 5.0})});
    const rig::Camera camera{.width = 5, .height = 3, .fx = 2.0, .fy = 2.0, .cx = 2.5, .cy = 1.5};
    const auto T_base_camera = T_base_camera_of({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
    EXPECT_EQ(render_view(world, camera, T_base_camera, 2).p_base_points.size(), 6U);
}

}  // namespace
}  // namespace octoskin::evaluation
