#include "host/lab/evaluation/clean_view.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/lab/evaluation/survey.hpp"
#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::evaluation {
namespace {

/// At the origin, looks along +x; 101 pixels over 90 degrees, one along the axis.
rig::Camera wide_camera() {
    rig::Camera camera{.width = 101, .height = 101, .fx = 50.5, .fy = 50.5, .cx = 50.5, .cy = 50.5};
    camera.depth_min_m = 0.2;
    camera.depth_max_m = 3.0;
    camera.T_link_camera = T_base_camera_of({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
    return camera;
}

/// Its face is at x = 2.
sim::Solid wall() {
    return box("wall", {2.0, -5.0, -5.0}, {2.5, 5.0, 5.0});
}

TEST(CleanView, sees_one_point_a_pixel_within_its_depth_limits) {
    EXPECT_EQ(CleanView(sim::World({wall()}), wide_camera()).points().size(), 101U * 101U);
    const sim::World too_far({box("wall", {3.01, -5.0, -5.0}, {3.5, 5.0, 5.0})});
    EXPECT_TRUE(CleanView(too_far, wide_camera()).points().empty());
    const sim::World at_the_limit({box("wall", {2.99, -5.0, -5.0}, {3.5, 5.0, 5.0})});
    EXPECT_EQ(CleanView(at_the_limit, wide_camera()).points().size(), 101U * 101U)
        << "the limit is a depth, no range";
    const sim::World too_near({box("wall", {0.19, -5.0, -5.0}, {0.5, 5.0, 5.0})});
    EXPECT_TRUE(CleanView(too_near, wide_camera()).points().empty());
}

TEST(CleanView, gives_place_normal_solid_and_depth) {
    const sim::World world({box("crate", {1.0, -0.1, -0.1}, {1.2, 0.1, 0.1}), wall()});
    const auto points = CleanView(world, wide_camera()).points();
    const ViewPoint& middle = points[50 * 101 + 50];
    EXPECT_NEAR((middle.p_base - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 0.0, 1e-6);
    EXPECT_NEAR((middle.normal_base - Eigen::Vector3d(-1.0, 0.0, 0.0)).norm(), 0.0, 1e-6);
    EXPECT_EQ(middle.solid, 0U);
    EXPECT_NEAR(middle.depth_m, 1.0, 1e-6);
    EXPECT_EQ(points.front().solid, 1U);
    EXPECT_NEAR(points.front().p_base.x(), 2.0, 1e-6);
    EXPECT_NEAR(points.front().depth_m, 2.0, 1e-6);
}

TEST(CleanView, sees_both_sides_of_a_plane) {
    auto mesh = sim::plane_mesh({1.0, 0.0, 0.0}, {4.0, 4.0});  // its front looks away
    for (auto& vertex : mesh.vertices) vertex.x() += 1.0;
    const sim::World world({sim::Solid{"plane", "plane", mesh.vertices, mesh.triangles, false}});
    EXPECT_NEAR(CleanView(world, wide_camera()).points().front().normal_base.x(), -1.0, 1e-6);
}

TEST(CleanView, is_clear_up_to_the_wall) {
    const sim::World world({wall()});
    const CleanView view(world, wide_camera());
    EXPECT_TRUE(view.is_clear({1.89, 0.0, 0.0}, 0.1));
    EXPECT_FALSE(view.is_clear({1.91, 0.0, 0.0}, 0.1)) << "touches the wall";
    EXPECT_FALSE(view.is_clear({2.8, 0.0, 0.0}, 0.1)) << "behind it";
    EXPECT_FALSE(view.is_clear({-1.0, 0.0, 0.0}, 0.1)) << "behind the camera";
    EXPECT_FALSE(view.is_clear({0.05, 0.0, 0.0}, 0.1)) << "round the camera";
}

TEST(CleanView, is_clear_only_within_the_image) {
    const sim::World world({wall()});
    const CleanView view(world, wide_camera());
    // The image ends where y = x: a ball of 0.1 m at x = 1 reaches it from y = 1 - 0.1 * sqrt(2) on.
    EXPECT_TRUE(view.is_clear({1.0, 0.75, 0.0}, 0.1));
    EXPECT_TRUE(view.is_clear({1.0, 0.0, -0.75}, 0.1));
    EXPECT_FALSE(view.is_clear({1.0, 0.9, 0.0}, 0.1));
    EXPECT_FALSE(view.is_clear({1.0, -0.9, 0.0}, 0.1));
    EXPECT_FALSE(view.is_clear({1.0, 0.0, 0.9}, 0.1));
    EXPECT_FALSE(view.is_clear({1.0, 0.0, -0.9}, 0.1));
}

TEST(CleanView, a_ray_without_a_point_shows_nothing_clear) {
    const sim::World beyond({box("wall", {4.0, -9.0, -9.0}, {4.5, 9.0, 9.0})});
    EXPECT_FALSE(CleanView(beyond, wide_camera()).is_clear({1.0, 0.0, 0.0}, 0.1));
}

TEST(CleanView, a_thin_rod_before_a_ball_hides_a_part_of_it) {
    // One column of pixels sees the rod, which is 0.5 m before the ball and covers a part of it.
    const sim::World world({box("rod", {0.5, 0.0, -2.0}, {0.51, 0.01, 2.0}), wall()});
    const CleanView view(world, wide_camera());
    EXPECT_FALSE(view.is_clear({1.0, 0.0, 0.0}, 0.1));
    EXPECT_FALSE(view.is_clear({1.0, 0.1, 0.0}, 0.1));
    EXPECT_TRUE(view.is_clear({1.0, 0.2, 0.0}, 0.1));
    EXPECT_TRUE(view.is_clear({0.35, 0.0, 0.0}, 0.1)) << "before the rod";
}

/// Independent of the image: whether each of many points of the ball is seen, ray by ray.
bool is_seen_point_by_point(const sim::World& world, const Eigen::Vector3d& p_base, double radius_m) {
    for (int i = 0; i < 200; ++i) {
        const double z = 1.0 - 2.0 * (i + 0.5) / 200.0;
        const double turn = 2.399963 * i;
        const double across = std::sqrt(1.0 - z * z);
        const Eigen::Vector3d p =
            p_base + radius_m * Eigen::Vector3d(across * std::cos(turn), across * std::sin(turn), z);
        if (world.cast(Eigen::Vector3d::Zero(), p.normalized(), p.norm())) return false;
    }
    return true;
}

TEST(CleanView, agrees_with_rays_to_points_of_the_ball_with_and_without_a_lens) {
    rig::Camera fine = wide_camera();
    fine.width = fine.height = 404;
    fine.fx = fine.fy = fine.cx = fine.cy = 202.0;
    rig::Camera bent = fine;
    bent.lens.k1 = -0.04;
    const sim::World world({box("crate", {0.9, -0.2, -0.3}, {1.2, 0.1, 0.15}), wall()});
    for (const rig::Camera& tested : {fine, bent}) {
        const CleanView view(world, tested);
        int clear = 0;
        for (int i = 0; i < 600; ++i) {
            const Eigen::Vector3d p_base(0.4 + 0.002 * i, -0.35 + 0.07 * (i % 11), -0.3 + 0.05 * (i % 13));
            // Of two sizes, since neither pixels nor points are everywhere.
            if (view.is_clear(p_base, 0.08)) {
                EXPECT_TRUE(is_seen_point_by_point(world, p_base, 0.075)) << i;
            }
            clear += view.is_clear(p_base, 0.08) ? 1 : 0;
            const bool is_in_image = std::abs(p_base.y()) + 0.13 < 0.8 * (p_base.x() - 0.08) &&
                                     std::abs(p_base.z()) + 0.13 < 0.8 * (p_base.x() - 0.08);
            if (is_in_image && is_seen_point_by_point(world, p_base, 0.09)) {
                EXPECT_TRUE(view.is_clear(p_base, 0.08)) << i;
            }
        }
        EXPECT_GT(clear, 100);
        EXPECT_LT(clear, 500);
    }
}

}  // namespace
}  // namespace octoskin::evaluation
