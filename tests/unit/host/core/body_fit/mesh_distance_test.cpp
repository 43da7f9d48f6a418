// Oracle: the distance of a point from fine parts of each triangle, and from all triangles one by one.
#include "host/core/body_fit/mesh_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/unit/host/core/body_fit/shapes.hpp"

namespace octoskin {
namespace {

using Eigen::Vector3d;

TEST(MeshDistance, of_a_triangle_is_that_of_its_nearest_point) {
    constexpr int kSteps = 150;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto any = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
    for (int run = 0; run < 200; ++run) {
        const Vector3d a = any();
        const Vector3d b = run % 10 == 0 ? a : any();  // also without area
        const Vector3d c = run % 20 == 0 ? a : any();
        const Vector3d point = any();
        double nearest = 1e9;
        for (int i = 0; i <= kSteps; ++i)
            for (int j = 0; i + j <= kSteps; ++j)
                nearest = std::min(nearest, (a + (b - a) * i / kSteps + (c - a) * j / kSteps - point).norm());
        const double found = distance_to_triangle(point, a, b, c);
        EXPECT_LE(found, nearest + 1e-12) << "run " << run;
        EXPECT_GE(found, nearest - 3.0 / kSteps) << "run " << run;
    }
}

TEST(MeshDistance, is_the_least_of_all_triangles_up_to_its_limit) {
    const SurfaceMesh mesh = capsule_mesh(0.2, 0.05);
    const MeshDistance distance(mesh);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-0.3, 0.3);
    for (int run = 0; run < 300; ++run) {
        const Vector3d point(uniform(random), uniform(random), uniform(random));
        double nearest = 1e9;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto [a, b, c] = mesh.corners(i);
            nearest = std::min(nearest, distance_to_triangle(point, a, b, c));
        }
        EXPECT_DOUBLE_EQ(distance(point, 10.0), nearest);
        EXPECT_DOUBLE_EQ(distance(point, 0.1), std::min(nearest, 0.1));
    }
}

}  // namespace
}  // namespace octoskin
