// Rays against capsules. Oracles: hand-solved cases, and the distance of a point to a segment (the definition
// of a capsule) at and just before the point found.
#include "hw/sim/arm/body.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "hw/sim/world/shapes.hpp"

namespace octoskin::sim {
namespace {

const BodyCapsule kUpright = {{0, 0, 0}, {0, 0, 1}, 0.1};

double gap(const BodyCapsule& capsule, const Eigen::Vector3d& p) {
    const Eigen::Vector3d ab = capsule.p_base_b - capsule.p_base_a;
    const double part =
        std::clamp((p - capsule.p_base_a).dot(ab) / std::max(ab.squaredNorm(), 1e-300), 0.0, 1.0);
    return (p - capsule.p_base_a - part * ab).norm() - capsule.radius_m;
}

TEST(CastCapsule, meets_wall_and_ends_where_geometry_says) {
    EXPECT_NEAR(*cast_capsule(kUpright, {-1, 0, 0.5}, {1, 0, 0}), 0.9, 1e-14);
    EXPECT_NEAR(*cast_capsule(kUpright, {0, 0, 3}, {0, 0, -1}), 1.9, 1e-14);
    EXPECT_NEAR(*cast_capsule(kUpright, {0, 0, -3}, {0, 0, 1}), 2.9, 1e-14);
    EXPECT_NEAR(*cast_capsule(kUpright, {-1, 0, 1.06}, {1, 0, 0}), 1 - 0.08, 1e-14);  // 6-8-10 triangle
    EXPECT_NEAR(*cast_capsule(kUpright, {-1, 0.06, 0.5}, {1, 0, 0}), 1 - 0.08, 1e-14);
    EXPECT_FALSE(cast_capsule(kUpright, {-1, 0.11, 0.5}, {1, 0, 0}));
    EXPECT_FALSE(cast_capsule(kUpright, {-1, 0, 1.11}, {1, 0, 0}));
    EXPECT_FALSE(cast_capsule(kUpright, {-1, 0, 0.5}, {-1, 0, 0})) << "behind the ray";
}

TEST(CastCapsule, is_zero_from_inside) {
    EXPECT_EQ(cast_capsule(kUpright, {0.05, 0, 0.5}, {1, 0, 0}), 0.0);
    EXPECT_EQ(cast_capsule(kUpright, {0, 0, -0.05}, {0, 1, 0}), 0.0);
}

TEST(CastCapsule, counts_in_lengths_of_the_direction) {
    EXPECT_NEAR(*cast_capsule(kUpright, {-1, 0, 0.5}, {0.5, 0, 0}), 1.8, 1e-14);
    EXPECT_NEAR(*cast_capsule(kUpright, {0, 0, 3}, {0, 0, -4}), 0.475, 1e-14);
}

TEST(CastCapsule, treats_equal_ends_as_a_sphere) {
    const BodyCapsule sphere = {{1, 1, 1}, {1, 1, 1}, 0.5};
    EXPECT_NEAR(*cast_capsule(sphere, {1, 1, 5}, {0, 0, -1}), 3.5, 1e-14);
    EXPECT_FALSE(cast_capsule(sphere, {1.51, 1, 5}, {0, 0, -1}));
}

TEST(OutwardNormal, points_away_from_the_axis_and_from_the_ends) {
    EXPECT_TRUE(outward_normal(kUpright, {0.1, 0.0, 0.5}).isApprox(Eigen::Vector3d(1, 0, 0), 1e-14));
    EXPECT_TRUE(outward_normal(kUpright, {0.06, 0.0, 1.08}).isApprox(Eigen::Vector3d(0.6, 0, 0.8), 1e-14));
    EXPECT_TRUE(outward_normal(kUpright, {0.0, 0.0, -0.1}).isApprox(Eigen::Vector3d(0, 0, -1), 1e-14));
}

TEST(CastCapsule, finds_the_first_surface_point_of_random_capsules) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> place(-1.0, 1.0), radius(0.02, 0.3);
    const auto point = [&] { return Eigen::Vector3d(place(random), place(random), place(random)); };
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const BodyCapsule capsule = {point(), point(), radius(random)};
        const Eigen::Vector3d origin = 3.0 * point();
        const Eigen::Vector3d direction = (point() - origin).normalized();
        const auto t = cast_capsule(capsule, origin, direction);
        double least_gap = gap(capsule, origin);
        for (double s = 0.0; s < (t ? *t - 1e-6 : 8.0); s += 0.05) {
            least_gap = std::min(least_gap, gap(capsule, origin + s * direction));
        }
        if (t && *t > 0.0) {
            ++hits;
            EXPECT_NEAR(gap(capsule, origin + *t * direction), 0.0, 1e-9);
            EXPECT_GT(least_gap, 0.0) << "the ray was inside before the point found";
        } else {
            EXPECT_EQ(least_gap <= 0.0, t.has_value()) << "seed 3, case " << i;
        }
    }
    EXPECT_GT(hits, 2000);
}

TEST(CastRobot, meets_a_mesh_where_its_planes_are) {
    const Eigen::Isometry3d T_base_link =
        Eigen::Translation3d(2, 0, 0) * Eigen::AngleAxisd(0.5, Eigen::Vector3d(3, 1, 2).normalized());
    const Body body({{"link", {0.5, 0, 0}, {0.5, 0, 0}, 0.1}}, {{"link", box_mesh({0.2, 0.4, 0.6})}});
    const PosedBody posed = body.at({{"link", T_base_link}});
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    const auto draw = [&] {
        const double x = number(random);
        const double y = number(random);
        return Eigen::Vector3d(x, y, number(random));
    };
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector3d origin = draw();
        const Eigen::Vector3d direction = (T_base_link * (0.5 * draw()) - origin).normalized();
        // The slabs of the box, in its own frame.
        const Eigen::Vector3d o = T_base_link.inverse() * origin;
        const Eigen::Vector3d d = T_base_link.linear().transpose() * direction;
        double enters = 0.0, leaves = 9.0;
        for (int axis = 0; axis < 3; ++axis) {
            const double half = std::array{0.1, 0.2, 0.3}[static_cast<std::size_t>(axis)];
            const double a = (-half - o[axis]) / d[axis], b = (half - o[axis]) / d[axis];
            enters = std::max(enters, std::min(a, b));
            leaves = std::min(leaves, std::max(a, b));
        }
        if (std::abs(enters - leaves) < 1e-4) continue;  // along an edge
        std::optional<double> expected = enters < leaves ? std::optional(enters) : std::nullopt;
        const auto ball = cast_capsule(posed.capsules[0], origin, direction);
        if (ball && (!expected || *ball < *expected)) expected = ball;
        const auto found = posed.cast(origin, direction, 9.0);
        ASSERT_EQ(found.has_value(), expected.has_value()) << "seed 7, case " << i;
        if (!found) continue;
        ++hits;
        EXPECT_NEAR(*found, *expected, 1e-6) << "seed 7, case " << i;
        EXPECT_FALSE(posed.cast(origin, direction, *expected - 1e-3)) << "seed 7, case " << i;
    }
    EXPECT_GT(hits, 500);
}

TEST(CastRobot, takes_the_nearest_link_that_is_not_ignored) {
    const Body body({{"near", {0, 0, -1}, {0, 0, 1}, 0.1}, {"far", {0, 0, -1}, {0, 0, 1}, 0.2}});
    Arm::LinkPoses poses = {{"near", Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0))},
                            {"far", Eigen::Isometry3d(Eigen::Translation3d(2, 0, 0))}};
    EXPECT_NEAR(*body.at(poses).cast({0, 0, 0}, {1, 0, 0}, 9), 0.9, 1e-14);
    EXPECT_NEAR(*body.at(poses, {"near"}).cast({0, 0, 0}, {1, 0, 0}, 9), 1.8, 1e-14);
    EXPECT_FALSE(body.at(poses, {"near", "far"}).cast({0, 0, 0}, {1, 0, 0}, 9));
    EXPECT_FALSE(body.at(poses).cast({0, 0, 0}, {0, 1, 0}, 9));
}

}  // namespace
}  // namespace octoskin::sim
