#include "host/core/self_filter/robot_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/cases.hpp"

namespace octoskin {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr CameraIntrinsics kCamera{.width = 64, .height = 53, .fx = 45.0, .fy = 46.0, .cx = 31.0, .cy = 27.5};
const PixelRays kRays(kCamera);

CameraIntrinsics with_lens(const LensDistortion& lens) {
    CameraIntrinsics camera = kCamera;
    camera.lens = lens;
    return camera;
}

DepthImage flat_image(float depth_m) {
    return {.width = 64, .height = 53, .depth_m = std::vector<float>(64 * 53, depth_m)};
}

/// Distance from a point to a segment by search along it: the oracle knows no projection of a point on a
/// line.
double searched_distance(const PosedCapsule& capsule, const Eigen::Vector3d& point) {
    double low = 0.0;
    double high = 1.0;
    const auto distance = [&](double t) {
        return (capsule.p_a + t * (capsule.p_b - capsule.p_a) - point).norm();
    };
    for (int i = 0; i < 60; ++i) {
        const double third = (high - low) / 3.0;
        if (distance(low + third) < distance(high - third)) {
            high -= third;
        } else {
            low += third;
        }
    }
    return distance(0.5 * (low + high));
}

TEST(RobotFilter, removes_a_sphere_and_its_margin_from_a_wall_behind) {
    // At depth 2 m one pixel is 44 mm wide. Sphere of 20 cm and 9 cm of margin about the wall's middle.
    DepthImage image = flat_image(2.0F);
    const PosedCapsule sphere{.p_a = {0.0, 0.0, 2.0}, .p_b = {0.0, 0.0, 2.0}, .radius_m = 0.2};
    const std::size_t removed = remove_robot(image, kRays, std::vector{sphere}, 0.09);
    // Area of a disc of 29 cm in pixels of 44.4 x 43.5 mm: 136.7.
    EXPECT_NEAR(static_cast<double>(removed), 136.7, 8.0);
    EXPECT_TRUE(std::isnan(image.depth_m[27 * 64 + 31]));
    EXPECT_EQ(image.depth_m[27 * 64 + 31 + 8], 2.0F);
}

TEST(RobotFilter, keeps_what_lies_in_front_of_and_behind_the_robot) {
    const PosedCapsule capsule{.p_a = {-0.3, 0.0, 2.0}, .p_b = {0.3, 0.0, 2.0}, .radius_m = 0.1};
    for (const float depth_m : {1.5F, 1.8F, 2.2F, 3.0F}) {
        DepthImage image = flat_image(depth_m);
        EXPECT_EQ(remove_robot(image, kRays, std::vector{capsule}, 0.09), 0U) << depth_m;
        EXPECT_EQ(image.depth_m, flat_image(depth_m).depth_m);
    }
}

TEST(RobotFilter, does_nothing_without_capsules_and_counts_no_pixel_twice) {
    DepthImage image = flat_image(2.0F);
    EXPECT_EQ(remove_robot(image, kRays, {}, 0.09), 0U);
    const PosedCapsule sphere{.p_a = {0.0, 0.0, 2.0}, .p_b = {0.0, 0.0, 2.0}, .radius_m = 0.2};
    const std::size_t once = remove_robot(image, kRays, std::vector{sphere}, 0.09);
    DepthImage again = flat_image(2.0F);
    EXPECT_EQ(remove_robot(again, kRays, std::vector{sphere, sphere}, 0.09), once);
}

TEST(RobotFilter, removes_everything_if_it_does_not_know_where_the_robot_is) {
    PosedCapsule lost{.p_a = {0.0, kNan, 2.0}, .p_b = {0.0, 0.0, 2.0}, .radius_m = 0.2};
    DepthImage image = flat_image(1.0F);
    image.depth_m[5] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(remove_robot(image, kRays, std::vector{lost}, 0.09), 64U * 53U - 1U);
    EXPECT_TRUE(
        std::all_of(image.depth_m.begin(), image.depth_m.end(), [](float z) { return std::isnan(z); }));
    image = flat_image(1.0F);
    EXPECT_EQ(remove_robot(image, kRays, {}, kNan), 64U * 53U);
}

// Oracle: every pixel against every capsule, distances by search; capsules before, around and behind the
// camera. Every third camera has a lens that bends the picture by up to two pixels.
TEST(RobotFilter, equals_testing_every_pixel_against_every_capsule) {
    const PixelRays bent(with_lens({.k1 = 0.1, .k2 = -0.05, .p1 = 0.004, .p2 = -0.006, .k3 = 0.02}));
    for (unsigned seed = 0; seed < testing_support::cases(36); ++seed) {
        const PixelRays& rays = seed % 3 == 2 ? bent : kRays;
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> side(-1.5, 1.5);
        std::uniform_real_distribution<double> ahead(-0.5, 3.0);
        std::uniform_real_distribution<double> size(0.0, 0.3);
        std::vector<PosedCapsule> body(2);
        for (PosedCapsule& capsule : body) {
            capsule.p_a = {side(random), side(random), ahead(random)};
            capsule.p_b = capsule.p_a + Eigen::Vector3d(side(random), side(random), side(random)) * 0.5;
            capsule.radius_m = size(random);
        }
        std::uniform_real_distribution<float> depth(0.1F, 3.0F);
        DepthImage image = flat_image(1.0F);
        for (std::size_t i = 0; i < image.depth_m.size(); ++i) {
            // Every other image lies where its rays pass nearest to one end: the outline itself is tested.
            const RaySlope slope = rays.at(i % 64, static_cast<std::uint32_t>(i / 64));
            const Eigen::Vector3d ray(slope.x, slope.y, 1.0);
            const double nearest_m = body[0].p_a.dot(ray) / ray.squaredNorm();
            image.depth_m[i] = seed % 2 == 0 ? depth(random) : static_cast<float>(std::max(0.01, nearest_m));
        }
        const DepthImage before = image;
        const std::size_t removed = remove_robot(image, rays, body, 0.09);
        std::size_t expected_removed = 0;
        for (std::uint32_t v = 0; v < 53; ++v) {
            for (std::uint32_t u = 0; u < 64; ++u) {
                const auto z = static_cast<double>(before.depth_m[v * 64 + u]);
                const Eigen::Vector3d point(rays.at(u, v).x * z, rays.at(u, v).y * z, z);
                const bool is_robot = std::any_of(body.begin(), body.end(), [&](const PosedCapsule& capsule) {
                    return searched_distance(capsule, point) <= capsule.radius_m + 0.09;
                });
                expected_removed += is_robot ? 1U : 0U;
                ASSERT_EQ(std::isnan(image.depth_m[v * 64 + u]), is_robot)
                    << "seed " << seed << " at " << u << "," << v;
            }
        }
        EXPECT_EQ(removed, expected_removed);
    }
}

}  // namespace
}  // namespace octoskin
