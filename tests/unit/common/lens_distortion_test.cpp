// The lens. Oracle: OpenCV's published formula, on calibrations that the TUM RGB-D benchmark publishes.
#include "common/lens/lens_distortion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/lens/published_lens.hpp"

namespace octoskin {
namespace {

using testing_support::kInvertibleTumCameras;
using testing_support::kTumCameras;
using testing_support::project;
using testing_support::PublishedCamera;

LensDistortion lens_of(const PublishedCamera& camera) {
    const auto& [k1, k2, p1, p2, k3] = camera.distortion;
    return {.k1 = k1, .k2 = k2, .p1 = p1, .p2 = p2, .k3 = k3};
}

RaySlope slope_of(const PublishedCamera& camera, double u, double v) {
    return {(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy};
}

TEST(LensDistortion, bends_rays_as_the_published_formula_does) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> slope(-0.8, 0.8);
    for (const PublishedCamera& camera : kTumCameras) {
        for (int draw = 0; draw < 1'000; ++draw) {
            const RaySlope ray{slope(random), slope(random)};
            const RaySlope seen = distorted(lens_of(camera), ray);
            const auto [u, v] = project(camera, ray.x, ray.y);
            ASSERT_NEAR(camera.fx * seen.x + camera.cx, u, 1e-9) << camera.name;
            ASSERT_NEAR(camera.fy * seen.y + camera.cy, v, 1e-9) << camera.name;
        }
    }
}

// Every pixel of them: pixel_rays_test.
TEST(LensInverse, comes_back_to_the_pixels_of_every_published_camera) {
    for (std::size_t i = 0; i < kInvertibleTumCameras; ++i) {
        const PublishedCamera& camera = kTumCameras.at(i);
        const LensInverse inverse(lens_of(camera));
        double error_px_max = 0.0;
        for (int v = 0; v < 480; v += 5) {
            for (int u = 0; u < 640; u += 5) {
                const auto ray = inverse.ray_of(slope_of(camera, u, v));
                ASSERT_TRUE(ray) << camera.name << ' ' << u << ' ' << v;
                ASSERT_LE(std::hypot(ray->x, ray->y), inverse.radius());
                const auto [u_again, v_again] = project(camera, ray->x, ray->y);
                error_px_max = std::max(error_px_max, std::hypot(u_again - u, v_again - v));
            }
        }
        EXPECT_LT(error_px_max, 1e-6) << camera.name;  // a thousandth of a pixel is asked for
    }
}

// 1 - 0.6891 s + 7.383 s^2 - 23.936 s^3, s = r^2, is 0 at s = 0.4501: r = 0.671. With the tangential part's
// allowance, 6 * 0.0075 r, a little earlier.
TEST(LensInverse, knows_where_a_polynomial_turns_back) {
    const PublishedCamera& infrared2 = kTumCameras.at(5);
    const LensInverse inverse(lens_of(infrared2));
    EXPECT_GT(inverse.radius(), 0.655);
    EXPECT_LT(inverse.radius(), 0.672);
    EXPECT_FALSE(inverse.ray_of(slope_of(infrared2, 0, 0)));
    EXPECT_FALSE(inverse.ray_of(slope_of(infrared2, 639, 479)));
    EXPECT_TRUE(inverse.ray_of(slope_of(infrared2, 320, 0)));
    // k1 = -1/3 alone: r - r^3 / 3 has its greatest value, 2/3, at r = 1.
    const LensInverse barrel({.k1 = -1.0 / 3.0});
    EXPECT_NEAR(barrel.radius(), 0.999, 1e-9);
    EXPECT_NEAR(barrel.ray_of({0.0, 0.5 - 0.125 / 3.0})->y, 0.5, 1e-12);
    EXPECT_TRUE(barrel.ray_of({0.66, 0.0}));
    EXPECT_FALSE(barrel.ray_of({0.67, 0.0}));
    EXPECT_FALSE(barrel.ray_of({1e6, -1e6}));
}

TEST(LensInverse, never_gives_one_picture_two_rays) {
    std::mt19937 random(9);
    std::normal_distribution<double> normal;
    int found = 0;
    for (int draw = 0; draw < 3'000; ++draw) {
        const LensDistortion lens{.k1 = 0.5 * normal(random),
                                  .k2 = normal(random),
                                  .p1 = 0.02 * normal(random),
                                  .p2 = 0.02 * normal(random),
                                  .k3 = normal(random)};
        const LensInverse inverse(lens);
        const double angle = 3.0 * normal(random);
        const double r = inverse.radius() * std::abs(std::sin(normal(random)));
        const RaySlope ray{r * std::cos(angle), r * std::sin(angle)};
        const auto again = inverse.ray_of(distorted(lens, ray));
        if (!again) continue;  // close to the rim the way there may leave the disc: refused, not wrong
        ++found;
        ASSERT_NEAR(again->x, ray.x, 1e-6) << describe(lens) << " r " << r << " of " << inverse.radius();
        ASSERT_NEAR(again->y, ray.y, 1e-6) << describe(lens) << " r " << r << " of " << inverse.radius();
    }
    EXPECT_GT(found, 2'900);
}

TEST(LensDistortion, is_told_by_its_coefficients) {
    EXPECT_EQ(describe({.k1 = -0.25, .k2 = 0.125, .p1 = 0.001, .p2 = -0.002, .k3 = 1e-9}),
              "k1 -0.25, k2 0.125, p1 0.001, p2 -0.002, k3 1e-09");
}

TEST(LensDistortion, a_pixel_is_where_its_centre_is) {
    struct {
        double fx = 500.0, fy = 400.0, cx = 320.0, cy = 240.0;
    } const camera;
    EXPECT_DOUBLE_EQ(picture_of(camera, 0, 0).x, -0.639);
    EXPECT_DOUBLE_EQ(picture_of(camera, 0, 0).y, -0.59875);
    EXPECT_DOUBLE_EQ(picture_of(camera, 419, 279).x, 0.199);
    EXPECT_DOUBLE_EQ(picture_of(camera, 419, 279).y, 0.09875);
}

TEST(LensInverse, gives_each_pixel_its_ray_row_by_row) {
    struct {
        std::uint32_t width = 5, height = 4;
        double fx = 5.0, fy = 4.0, cx = 2.5, cy = 2.0;
        LensDistortion lens;
    } camera;
    for (const LensDistortion& lens : {LensDistortion{}, LensDistortion{.k1 = 0.1, .p2 = 0.01}}) {
        camera.lens = lens;
        std::uint32_t pixel = 0;
        for_each_pixel_ray(camera, [&](std::uint32_t u, std::uint32_t v, const RaySlope& ray) {
            EXPECT_EQ(v * camera.width + u, pixel++);
            const RaySlope seen = distorted(lens, ray);
            EXPECT_NEAR(seen.x, picture_of(camera, u, v).x, 1e-12);
            EXPECT_NEAR(seen.y, picture_of(camera, u, v).y, 1e-12);
        });
        EXPECT_EQ(pixel, 20U);
    }
}

TEST(LensInverse, of_no_lens_is_the_picture_to_the_last_bit) {
    const LensInverse none(LensDistortion{});
    EXPECT_EQ(none.radius(), 4.0);
    const auto ray = none.ray_of({0.1 + 0.2, -7.0});
    EXPECT_EQ(ray->x, 0.1 + 0.2);
    EXPECT_EQ(ray->y, -7.0);
}

TEST(LensInverse, of_no_numbers_ends_and_finds_nothing) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(LensInverse({.k1 = kNan}).radius(), 0.0);
    EXPECT_FALSE(LensInverse({.k1 = kNan}).ray_of({0.1, 0.1}));
    EXPECT_FALSE(LensInverse({.k1 = 0.1}).ray_of({kNan, 0.1}));
    EXPECT_FALSE(LensInverse({.p1 = 1.0, .k3 = -1000.0}).ray_of({0.5, 0.5}));
}

}  // namespace
}  // namespace octoskin
