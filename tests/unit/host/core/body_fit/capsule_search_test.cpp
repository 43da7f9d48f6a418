#include "host/core/body_fit/capsule_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "host/core/body_fit/row_cut.hpp"
#include "host/core/body_fit/spread_points.hpp"
#include "tests/unit/host/core/body_fit/shapes.hpp"

namespace octoskin {
namespace {

using Eigen::Vector3d;

TEST(CapsuleSearch, finds_the_capsule_that_points_were_taken_from_in_any_pose) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    for (int run = 0; run < 10; ++run) {
        Eigen::Affine3d T_mesh_part = Eigen::Affine3d::Identity();
        T_mesh_part.linear() =
            Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                .normalized()
                .toRotationMatrix();
        T_mesh_part.translation() << normal(random), normal(random), normal(random);
        SurfaceMesh mesh;
        append(capsule_mesh(0.25, 0.06), T_mesh_part, mesh);
        const MeshDistance distance(mesh);
        const auto hull = ConvexHull::around(mesh.vertices);
        const ExcessField field(mesh, distance, &*hull);
        const PosedCapsule found = capsule_around(spread_points(mesh, 0.006), field, 30).capsule;
        EXPECT_NEAR(found.radius_m, 0.06 - kSlack_m, 0.002) << "run " << run;
        EXPECT_NEAR((found.p_b - found.p_a).norm(), 0.25, 0.006) << "run " << run;
    }
}

TEST(CapsuleSearch, covers_all_points_that_it_gets) {
    const SurfaceMesh mesh = angle_mesh();
    const MeshDistance distance(mesh);
    const auto hull = ConvexHull::around(mesh.vertices);
    const ExcessField field(mesh, distance, &*hull);
    const auto points = spread_points(mesh, 0.01);
    const PosedCapsule capsule = capsule_around(points, field, 10).capsule;
    for (const Vector3d& point : points) EXPECT_LE(distance_to_surface(capsule, point), kSlack_m + 1e-9);
}

TEST(CapsuleSearch, keeps_the_farthest_points_of_each_axis) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<Vector3d> points;
    for (int i = 0; i < 5000; ++i) points.emplace_back(uniform(random), uniform(random), uniform(random));
    const auto extremes = extreme_points(points);
    EXPECT_LE(extremes.size(), 240U);
    for (int axis = 0; axis < 3; ++axis) {
        const auto along = [axis](const Vector3d& point) { return point[axis]; };
        EXPECT_LT(std::ranges::max(points, {}, along)[axis] - std::ranges::max(extremes, {}, along)[axis],
                  0.05);
    }
}

/// Oracle: distance_to_surface at points of the row.
TEST(RowCut, has_the_points_of_a_row_that_are_in_the_capsule) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int run = 0; run < 300; ++run) {
        PosedCapsule capsule{{uniform(random), uniform(random), uniform(random)},
                             {uniform(random), uniform(random), uniform(random)},
                             0.5 * std::abs(uniform(random))};
        if (run % 7 == 0) capsule.p_b = capsule.p_a;
        if (run % 7 == 1) capsule.p_b.x() = capsule.p_a.x();
        if (run % 7 == 2) capsule.p_b.tail<2>() = capsule.p_a.tail<2>();  // along the row
        const RowCut cut(capsule);
        for (int i = 0; i < 30; ++i) {
            const double y = uniform(random);
            const double z = uniform(random);
            const RowInterval row = cut(y, z);
            for (double x = -1.6; x < 1.6; x += 0.05) {
                const double distance_m = distance_to_surface(capsule, {x, y, z});
                if (std::abs(distance_m) < 1e-6) continue;
                EXPECT_EQ(!row.is_empty() && x > row.from && x < row.to, distance_m < 0.0) << "run " << run;
            }
        }
    }
}

}  // namespace
}  // namespace octoskin
