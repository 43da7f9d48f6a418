// Capsule geometry. Oracle: numeric search that knows only "all points within a radius of a segment".
#include "host/core/kinematics/capsule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/cases.hpp"

namespace octoskin {
namespace {

using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Distance to the segment by ternary search: |point - p(s)| is convex in s.
double searched_distance(const PosedCapsule& capsule, const Vector3d& point) {
    const auto distance_at = [&](double s) {
        return (point - ((1.0 - s) * capsule.p_a + s * capsule.p_b)).norm();
    };
    double low = 0.0;
    double high = 1.0;
    for (int step = 0; step < 90; ++step) {
        const double left = low + (high - low) / 3.0;
        const double right = high - (high - low) / 3.0;
        (distance_at(left) < distance_at(right) ? high : low) =
            distance_at(left) < distance_at(right) ? right : left;
    }
    return std::min({distance_at(low), distance_at(0.0), distance_at(1.0)}) - capsule.radius_m;
}

/// Walks along the ray by the distance that is certainly free, until it touches or has gone 20 m.
std::optional<double> walked_entry(const PosedCapsule& capsule, const Vector3d& origin,
                                   const Vector3d& direction) {
    double range_m = 0.0;
    for (int step = 0; step < 4000 && range_m < 20.0; ++step) {
        const double free_m = searched_distance(capsule, origin + range_m * direction);
        if (free_m < 1e-7) return range_m;
        range_m += free_m;
    }
    return std::nullopt;
}

/// How deep the ray goes at its deepest, by ternary search: the distance to a convex body is convex along a
/// line.
double deepest_distance(const PosedCapsule& capsule, const Vector3d& origin, const Vector3d& direction) {
    double low = 0.0;
    double high = 20.0;
    for (int step = 0; step < 120; ++step) {
        const double left = low + (high - low) / 3.0;
        const double right = high - (high - low) / 3.0;
        const bool is_left_nearer = searched_distance(capsule, origin + left * direction) <
                                    searched_distance(capsule, origin + right * direction);
        (is_left_nearer ? high : low) = is_left_nearer ? right : left;
    }
    return searched_distance(capsule, origin + low * direction);
}

class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine_); }
    Vector3d vector(double size) {
        return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
    }
    PosedCapsule capsule() { return {vector(0.5), vector(0.5), uniform(0.02, 0.3), 0}; }

  private:
    std::mt19937 engine_;
};

TEST(Capsule, distance_equals_numeric_search) {
    Random random(1);
    for (unsigned i = 0; i < testing_support::cases(5000); ++i) {
        const PosedCapsule capsule = random.capsule();
        const Vector3d point = random.vector(1.5);
        ASSERT_NEAR(distance_to_surface(capsule, point), searched_distance(capsule, point), 1e-8)
            << "draw " << i;
    }
}

TEST(Capsule, distance_to_literal_points) {
    const PosedCapsule capsule{{0, 0, 0}, {0, 0, 1}, 0.25, 3};
    EXPECT_DOUBLE_EQ(distance_to_surface(capsule, {1, 0, 0.5}), 0.75);
    EXPECT_DOUBLE_EQ(distance_to_surface(capsule, {0, 0, 2}), 0.75);
    EXPECT_DOUBLE_EQ(distance_to_surface(capsule, {0, 0, -1}), 0.75);
    EXPECT_DOUBLE_EQ(distance_to_surface(capsule, {0, 0, 0.5}), -0.25);
}

TEST(Capsule, equal_ends_are_a_sphere) {
    const PosedCapsule sphere{{1, 2, 3}, {1, 2, 3}, 0.5, 0};
    EXPECT_DOUBLE_EQ(distance_to_surface(sphere, {1, 2, 5}), 1.5);
    EXPECT_DOUBLE_EQ(ray_entry(sphere, {1, 2, 5}, {0, 0, -1}).value(), 1.5);
    EXPECT_FALSE(ray_entry(sphere, {1, 2, 5}, {0, 0, 1}));
}

TEST(Capsule, ray_entry_equals_numeric_walk) {
    Random random(2);
    unsigned hits = 0;
    for (unsigned i = 0; i < testing_support::cases(4000); ++i) {
        const PosedCapsule capsule = random.capsule();
        const Vector3d origin = random.vector(1.5);
        // Half of the rays are aimed near the capsule, so that hits and misses are both common.
        const Vector3d aim =
            i % 2 == 0 ? Vector3d(capsule.p_a + random.vector(0.4) - origin) : random.vector(1.0);
        const Vector3d direction = aim.normalized();
        const auto expected = walked_entry(capsule, origin, direction);
        const auto entry = ray_entry(capsule, origin, direction);
        if (expected.has_value() != entry.has_value()) {
            // Only a ray that grazes within the walk's own tolerance may be called either way.
            EXPECT_NEAR(deepest_distance(capsule, origin, direction), 0.0, 1e-6) << "draw " << i;
            continue;
        }
        if (!entry) continue;
        ++hits;
        // The walk stops 1e-7 m off the surface; along a grazing ray that is further back.
        ASSERT_NEAR(searched_distance(capsule, origin + *entry * direction),
                    std::min(0.0, searched_distance(capsule, origin)), 1e-8)
            << "draw " << i;
        ASSERT_NEAR(*entry, *expected, 1e-3) << "draw " << i;
    }
    EXPECT_GT(hits, testing_support::cases(500));
}

TEST(Capsule, ray_that_starts_inside_enters_at_zero) {
    const PosedCapsule capsule{{0, 0, 0}, {0, 0, 1}, 0.25, 0};
    EXPECT_EQ(ray_entry(capsule, {0.1, 0, 0.5}, {1, 0, 0}).value(), 0.0);
    EXPECT_EQ(ray_entry(capsule, {0, 0, 1.2}, {0, 0, 1}).value(), 0.0);
}

TEST(Capsule, ray_along_the_axis_enters_through_an_end) {
    const PosedCapsule capsule{{0, 0, 0}, {0, 0, 1}, 0.25, 0};
    EXPECT_DOUBLE_EQ(ray_entry(capsule, {0, 0, 3}, {0, 0, -1}).value(), 1.75);
    EXPECT_DOUBLE_EQ(ray_entry(capsule, {0, 0, -2}, {0, 0, 1}).value(), 1.75);
    EXPECT_DOUBLE_EQ(ray_entry(capsule, {0.15, 0, 3}, {0, 0, -1}).value(), 1.8);
    EXPECT_FALSE(ray_entry(capsule, {0.26, 0, 3}, {0, 0, -1}));
}

TEST(Capsule, ray_across_the_axis_meets_the_wall) {
    const PosedCapsule capsule{{0, 0, 0}, {0, 0, 1}, 0.25, 0};
    EXPECT_DOUBLE_EQ(ray_entry(capsule, {2, 0, 0.5}, {-1, 0, 0}).value(), 1.75);
    EXPECT_FALSE(ray_entry(capsule, {2, 0, 1.3}, {-1, 0, 0}));
    EXPECT_FALSE(ray_entry(capsule, {2, 0, 0.5}, {1, 0, 0}));
}

TEST(Capsule, distant_ray_keeps_its_accuracy) {
    const PosedCapsule capsule{{0, 0, 0}, {0, 0, 1}, 0.25, 0};
    EXPECT_NEAR(ray_entry(capsule, {10.0, 0.15, 0.5}, {-1, 0, 0}).value(), 9.8, 1e-12);
}

TEST(Capsule, not_a_number_is_no_entry) {
    const PosedCapsule capsule{{0, 0, 0}, {0, 0, 1}, 0.25, 0};
    EXPECT_TRUE(std::isnan(distance_to_surface(capsule, {kNaN, 0, 0})));
    for (int axis = 0; axis < 3; ++axis) {
        Vector3d origin(2, 0, 0.5);
        Vector3d direction(-1, 0, 0);
        origin[axis] = kNaN;
        EXPECT_FALSE(ray_entry(capsule, origin, direction)) << "origin, axis " << axis;
        origin = {2, 0, 0.5};
        direction[axis] = kNaN;
        EXPECT_FALSE(ray_entry(capsule, origin, direction)) << "direction, axis " << axis;
    }
    PosedCapsule broken = capsule;
    broken.p_b.z() = kNaN;
    EXPECT_FALSE(ray_entry(broken, {2, 0, 0.5}, {-1, 0, 0}));
}

}  // namespace
}  // namespace octoskin
