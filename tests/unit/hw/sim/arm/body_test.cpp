// Rays against capsules. Oracles: hand-solved cases, and the distance of a point to a segment (the definition
// of a capsule) at and just before the point found.
#include "hw/sim/arm/body.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

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

TEST(CastRobot, takes_the_nearest_link_that_is_not_ignored) {
    const std::vector<rig::Capsule> capsules = {{"near", {0, 0, -1}, {0, 0, 1}, 0.1},
                                                {"far", {0, 0, -1}, {0, 0, 1}, 0.2}};
    Arm::LinkPoses poses = {{"near", Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0))},
                            {"far", Eigen::Isometry3d(Eigen::Translation3d(2, 0, 0))}};
    EXPECT_NEAR(*cast_robot(capsules, poses, {0, 0, 0}, {1, 0, 0}), 0.9, 1e-14);
    EXPECT_NEAR(*cast_robot(capsules, poses, {0, 0, 0}, {1, 0, 0}, {"near"}), 1.8, 1e-14);
    EXPECT_FALSE(cast_robot(capsules, poses, {0, 0, 0}, {1, 0, 0}, {"near", "far"}));
    EXPECT_FALSE(cast_robot(capsules, poses, {0, 0, 0}, {0, 1, 0}));
}

}  // namespace
}  // namespace octoskin::sim
