#include "host/core/body_fit/convex_hull.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/unit/host/core/body_fit/shapes.hpp"

namespace octoskin {
namespace {

using Eigen::Vector3d;

TEST(ConvexHull, has_the_volume_of_a_box_with_many_points_on_its_faces_and_within) {
    std::vector<Vector3d> points;
    for (int x = 0; x <= 10; ++x)
        for (int y = 0; y <= 10; ++y)
            for (int z = 0; z <= 10; ++z) points.emplace_back(0.02 * x, 0.03 * y, 0.04 * z);
    const auto hull = ConvexHull::around(points);
    ASSERT_TRUE(hull);
    EXPECT_NEAR(hull->volume_m3(), 0.2 * 0.3 * 0.4, 2e-6);
}

TEST(ConvexHull, has_the_volume_of_a_capsule) {
    const SurfaceMesh mesh = capsule_mesh(0.3, 0.1, 160, 40);
    const auto hull = ConvexHull::around(mesh.vertices);
    ASSERT_TRUE(hull);
    const double exact = std::numbers::pi * 0.01 * (0.3 + 0.4 / 3.0);
    EXPECT_NEAR(hull->volume_m3() / exact, 1.0, 0.002);
}

TEST(ConvexHull, fills_the_notch_of_an_angle) {
    const auto hull = ConvexHull::around(angle_mesh().vertices);
    ASSERT_TRUE(hull);
    // The profile is an L with corners (-.04, -.04), (.26, -.04), (.26, .04), (.04, .3), (-.04, .3):
    // shoelace.
    EXPECT_NEAR(hull->volume_m3(), 0.08 * (0.30 * 0.34 - 0.5 * 0.22 * 0.26), 1e-6);
    EXPECT_TRUE(hull->contains({0.1, 0.0, 0.1}));
    EXPECT_FALSE(hull->contains({0.2, 0.0, 0.2}));
}

/// A point is in the hull of random points if it is their weighted mean, and out if a plane parts them.
TEST(ConvexHull, contains_means_and_no_point_beyond_the_farthest_of_any_direction) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const auto any = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
    for (int run = 0; run < 30; ++run) {
        std::vector<Vector3d> points;
        for (int i = 0; i < 14 + 10 * run; ++i) points.push_back(0.1 * any());
        const auto hull = ConvexHull::around(points);
        ASSERT_TRUE(hull);
        for (int i = 0; i < 50; ++i) {
            Vector3d mean = Vector3d::Zero();
            double sum = 0.0;
            for (const Vector3d& point : points) {
                const double weight = std::pow(std::abs(normal(random)), 4.0);
                mean += weight * point;
                sum += weight;
            }
            EXPECT_TRUE(hull->contains(mean / sum)) << "run " << run;
            const Vector3d direction = any().normalized();
            Vector3d farthest = points.front();
            for (const Vector3d& point : points)
                if (direction.dot(point) > direction.dot(farthest)) farthest = point;
            EXPECT_FALSE(hull->contains(farthest + 1e-4 * direction)) << "run " << run;
            EXPECT_TRUE(hull->contains(farthest - 1e-4 * (farthest - mean / sum).normalized()))
                << "run " << run;
        }
    }
}

TEST(ConvexHull, cuts_a_row_where_its_points_enter_and_leave) {
    const auto hull = ConvexHull::around(angle_mesh().vertices);
    ASSERT_TRUE(hull);
    for (double y = -0.05; y <= 0.05; y += 0.007) {
        for (double z = -0.0505; z <= 0.31; z += 0.007) {
            const RowInterval row = hull->row(y, z);
            for (double x = -0.06; x <= 0.28; x += 0.0031) {
                const bool is_near_end = std::abs(x - row.from) < 1e-5 || std::abs(x - row.to) < 1e-5;
                if (is_near_end) continue;
                EXPECT_EQ(x > row.from && x < row.to, hull->contains({x, y, z}));
            }
        }
    }
}

TEST(ConvexHull, has_none_of_points_in_a_plane_on_a_line_or_at_one_place) {
    for (int dimensions = 0; dimensions < 3; ++dimensions) {
        std::vector<Vector3d> points;
        for (int i = 0; i < 100; ++i) {
            points.emplace_back(0.1, 0.2, 0.3);
            for (int axis = 0; axis < dimensions; ++axis)
                points.back()[axis] += 0.01 * ((i * (axis + 3)) % 17);
        }
        EXPECT_FALSE(ConvexHull::around(points)) << dimensions;
    }
    EXPECT_FALSE(ConvexHull::around({}));
}

}  // namespace
}  // namespace octoskin
