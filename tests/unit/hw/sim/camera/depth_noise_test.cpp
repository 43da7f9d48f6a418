// The models of the depth camera's noise. Oracles: the published laws, worked out by hand for a few depths;
// the moments of the distributions.
#include "hw/sim/camera/depth_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace octoskin::sim {
namespace {

constexpr std::uint32_t kWidth = 512;
constexpr std::uint32_t kHeight = 424;
constexpr double kPixels = 512.0 * 424.0;
constexpr double kNoSurface = std::numeric_limits<double>::infinity();
constexpr DepthLimits kLimits{0.3, 8.0};

using Image = std::vector<std::uint16_t>;
using DepthOfPixel = std::function<double(std::uint32_t u, std::uint32_t v)>;

Image measured(const KinectNoise& kinect, const DepthOfPixel& depth_m, std::uint32_t frame = 0,
               std::uint64_t seed = 7) {
    std::vector<double> truth;
    for (std::uint32_t v = 0; v < kHeight; ++v)
        for (std::uint32_t u = 0; u < kWidth; ++u) truth.push_back(depth_m(u, v));
    return measured_mm({kinect}, {kWidth, kHeight, truth}, kLimits, seed, frame);
}

DepthOfPixel plane(double depth_m) {
    return [depth_m](std::uint32_t, std::uint32_t) { return depth_m; };
}
/// The left half at 1 m, the right half at 2 m: columns 255 and 256 are edges.
double halves(std::uint32_t u, std::uint32_t) {
    return u < 256 ? 1.0 : 2.0;
}
int mm_at(const Image& image, std::uint32_t u, std::uint32_t v) {
    return image[std::size_t{v} * kWidth + u];
}

/// Every part of the noise off; a test turns on its own.
KinectNoise silent() {
    KinectNoise kinect;
    kinect.sigma_min_m = 0.0;
    kinect.sigma_growth_per_m = 0.0;
    kinect.bias_growth_per_m = 0.0;
    kinect.disparity_step_px = 0.0;
    kinect.flying_share = 0.0;
    kinect.missing_share = 0.0;
    return kinect;
}
KinectNoise with_edges(double flying, double missing) {
    KinectNoise kinect = silent();
    kinect.flying_share = flying;
    kinect.missing_share = missing;
    return kinect;
}

TEST(KinectNoise, without_all_its_parts_is_the_true_image) {
    const Image image = measured(silent(), halves);
    for (std::uint32_t v = 0; v < kHeight; ++v)
        for (std::uint32_t u = 0; u < kWidth; ++u) ASSERT_EQ(mm_at(image, u, v), u < 256 ? 1000 : 2000);
}

TEST(KinectNoise, deviates_by_the_published_law_of_depth) {
    KinectNoise kinect = silent();
    kinect.sigma_min_m = 0.0012;
    kinect.sigma_growth_per_m = 0.0019;
    // 1.2 + 1.9 (z - 0.4)^2 mm at 0.4, 1, 2 and 4 m, and the rounding's 1/12 mm^2.
    for (const auto& [depth_m, sigma_mm] :
         {std::pair{0.4, 1.2345}, {1.0, 1.9059}, {2.0, 6.0709}, {4.0, 25.8256}}) {
        double sum = 0.0, squares = 0.0;
        for (const std::uint16_t depth_mm : measured(kinect, plane(depth_m))) {
            const double off_mm = depth_mm - 1e3 * depth_m;
            sum += off_mm;
            squares += off_mm * off_mm;
        }
        EXPECT_NEAR(sum / kPixels, 0.0, 5.0 * sigma_mm / std::sqrt(kPixels)) << depth_m;
        EXPECT_NEAR(std::sqrt(squares / kPixels), sigma_mm, 5.0 * sigma_mm / std::sqrt(2.0 * kPixels))
            << depth_m;
    }
}

TEST(KinectNoise, has_a_bias_that_stays_from_frame_to_frame) {
    KinectNoise kinect = silent();
    kinect.bias_growth_per_m = 0.0015;
    const Image first = measured(kinect, plane(4.0), 0);
    EXPECT_EQ(measured(kinect, plane(4.0), 1), first);
    EXPECT_EQ(measured(kinect, plane(4.0), 4000), first);
    EXPECT_NE(measured(kinect, plane(4.0), 0, 8), first) << "of another seed";
    const auto [least, greatest] = std::minmax_element(first.begin(), first.end());
    EXPECT_GE(*least, 3976);  // 0.0015 * 16 m = 24 mm
    EXPECT_LE(*greatest, 4024);
    EXPECT_LE(*least, 3977);
    EXPECT_GE(*greatest, 4023);
    // A quarter of it at half the depth.
    const Image nearer = measured(kinect, plane(2.0));
    for (std::size_t i = 0; i < first.size(); ++i)
        ASSERT_NEAR(nearer[i] - 2000, (first[i] - 4000) / 4.0, 0.5 + 0.125) << i;
}

TEST(KinectNoise, has_a_bias_that_is_smooth_over_16_pixels_and_independent_beyond) {
    KinectNoise kinect = silent();
    kinect.bias_growth_per_m = 0.05;  // up to 200 mm at 2 m
    const Image image = measured(kinect, plane(2.0));
    double product = 0.0, squares = 0.0;
    for (std::uint32_t v = 0; v + 16 < kHeight; v += 16) {
        for (std::uint32_t u = 0; u + 16 < kWidth; u += 16) {
            const int here = mm_at(image, u, v), right = mm_at(image, u + 16, v),
                      below = mm_at(image, u, v + 16);
            for (std::uint32_t k = 1; k < 16; ++k) {
                ASSERT_NEAR(mm_at(image, u + k, v), here + (right - here) * (k / 16.0), 1.0);
                ASSERT_NEAR(mm_at(image, u, v + k), here + (below - here) * (k / 16.0), 1.0);
            }
            product += (here - 2000.0) * (right - 2000.0) + (here - 2000.0) * (below - 2000.0);
            squares += 2.0 * (here - 2000.0) * (here - 2000.0);
        }
    }
    // 806 squares: a correlation of 0 has a standard error of 0.025.
    EXPECT_NEAR(product / squares, 0.0, 0.125);
    // A uniform draw from -200 to 200 has the variance 200^2 / 3, standard error 3.1 %.
    EXPECT_NEAR(0.5 * squares / 806.0, 13333.0, 0.16 * 13333.0);
}

// At 580 px and 75 mm a depth z has 348 / z steps of 1/8 px.
TEST(KinectNoise, rounds_disparity_to_eighths_of_a_pixel) {
    KinectNoise kinect = silent();
    kinect.disparity_step_px = 0.125;
    for (const auto& [depth_m, depth_mm] : {std::pair{2.004, 2000},  // 173.65: 174
                                            {2.007, 2012},           // 173.39: 173
                                            {1.995, 2000},           // 174.44: 174
                                            {1.993, 1989},           // 174.61: 175
                                            {0.502, 502},            // 693.23: 693, 502.16 mm
                                            {4.016, 4000},           // 86.65: 87
                                            {4.03, 4047}})           // 86.35: 86
        EXPECT_EQ(mm_at(measured(kinect, plane(depth_m)), 30, 40), depth_mm) << depth_m;
    kinect.focal_px = 290.0;                                       // 174 / z steps
    EXPECT_EQ(mm_at(measured(kinect, plane(2.007)), 0, 0), 2000);  // 86.7: 87
    kinect.baseline_m = 0.0375;                                    // 87 / z steps
    EXPECT_EQ(mm_at(measured(kinect, plane(2.04)), 0, 0), 2023);   // 42.6: 43
    kinect.disparity_step_px = 50.0;                               // 0.2175 / z steps
    EXPECT_EQ(mm_at(measured(kinect, plane(2.0)), 0, 0), 0) << "no disparity, no depth";
}

TEST(KinectNoise, lets_shares_of_the_edge_pixels_fly_or_be_missing_in_each_frame_anew) {
    constexpr std::uint32_t kFrames = 60;
    constexpr double kEdgePixels = 2.0 * 424.0 * kFrames;
    int missing = 0, flying = 0, flying_twice = 0;
    double places = 0.0, place_squares = 0.0;
    std::vector<bool> flew(std::size_t{kWidth} * kHeight);
    for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
        const Image image = measured(with_edges(0.3, 0.3), halves, frame);
        for (std::uint32_t v = 0; v < kHeight; ++v) {
            for (std::uint32_t u = 0; u < kWidth; ++u) {
                const int depth_mm = mm_at(image, u, v);
                const int own_mm = u < 256 ? 1000 : 2000;
                if (u != 255 && u != 256) {
                    ASSERT_EQ(depth_mm, own_mm) << u << ", " << v;
                    continue;
                }
                const bool flies = depth_mm != 0 && depth_mm != own_mm;
                missing += depth_mm == 0;
                flying += flies;
                flying_twice += flies && flew[std::size_t{v} * kWidth + u];
                flew[std::size_t{v} * kWidth + u] = flies;
                if (!flies) continue;
                ASSERT_GE(depth_mm, 1000);
                ASSERT_LE(depth_mm, 2000);
                places += depth_mm;
                place_squares += (depth_mm - 1500.0) * (depth_mm - 1500.0);
            }
        }
    }
    EXPECT_NEAR(missing / kEdgePixels, 0.3, 0.0105);  // five standard errors
    EXPECT_NEAR(flying / kEdgePixels, 0.3, 0.0105);
    EXPECT_NEAR(flying_twice / (kEdgePixels * (kFrames - 1) / kFrames), 0.09, 0.0065);
    EXPECT_NEAR(places / flying, 1500.0, 12.0);  // of 289 mm
    EXPECT_NEAR(std::sqrt(place_squares / flying), 288.7, 6.0);
}

TEST(KinectNoise, chooses_the_missing_pixels_without_regard_to_their_noise) {
    KinectNoise kinect = with_edges(0.0, 0.5);
    kinect.sigma_min_m = 0.01;
    int kept = 0;
    double squares = 0.0;
    for (std::uint32_t frame = 0; frame < 20; ++frame) {
        const Image image = measured(kinect, halves, frame);
        for (std::uint32_t v = 0; v < kHeight; ++v) {
            const int depth_mm = mm_at(image, 255, v);
            kept += depth_mm != 0;
            if (depth_mm != 0) squares += (depth_mm - 1000.0) * (depth_mm - 1000.0);
        }
    }
    EXPECT_NEAR(std::sqrt(squares / kept), 10.0, 0.55);  // five standard errors
}

TEST(KinectNoise, calls_a_step_of_more_than_5_cm_to_any_of_four_neighbours_an_edge) {
    // One pixel that stands out.
    const auto bump = [](double by_m) {
        return [by_m](std::uint32_t u, std::uint32_t v) { return u == 100 && v == 200 ? 2.0 + by_m : 2.0; };
    };
    const KinectNoise all_missing = with_edges(0.0, 1.0);
    for (const double by_m : {0.049, -0.049}) {
        const Image image = measured(all_missing, bump(by_m));
        EXPECT_EQ(std::ranges::count(image, 0), 0) << by_m;
    }
    for (const double by_m : {0.051, -0.051}) {
        const Image image = measured(all_missing, bump(by_m));
        EXPECT_EQ(std::ranges::count(image, 0), 5) << by_m;
        for (const auto& [u, v] :
             {std::pair{100u, 200u}, {99u, 200u}, {101u, 200u}, {100u, 199u}, {100u, 201u}})
            EXPECT_EQ(mm_at(image, u, v), 0) << u << ", " << v;
    }
    KinectNoise narrow = all_missing;
    narrow.edge_step_m = 0.048;
    EXPECT_EQ(std::ranges::count(measured(narrow, bump(0.049)), 0), 5);
}

TEST(KinectNoise, lets_a_pixel_fly_towards_the_neighbour_that_differs_most) {
    // Columns at 2, 2.1 and 1 m: the middle one flies between 1 and 2.1 m.
    const auto columns = [](std::uint32_t u, std::uint32_t) { return u < 10 ? 2.0 : u == 10 ? 2.1 : 1.0; };
    int below = 0;
    const Image image = measured(with_edges(1.0, 0.0), columns);
    for (std::uint32_t v = 0; v < kHeight; ++v) {
        ASSERT_GE(mm_at(image, 10, v), 1000);
        ASSERT_LE(mm_at(image, 10, v), 2100);
        below += mm_at(image, 10, v) < 1900;
        ASSERT_GE(mm_at(image, 9, v), 2000);
        ASSERT_LE(mm_at(image, 9, v), 2100);
    }
    EXPECT_GT(below, 424 * 3 / 5);  // 9/11 of them
}

TEST(KinectNoise, has_no_value_where_there_is_no_surface_or_nothing_to_fly_to) {
    const auto left_half = [](std::uint32_t u, std::uint32_t) { return u < 256 ? 1.0 : kNoSurface; };
    const Image image = measured(with_edges(0.3, 0.3), left_half);
    int missing = 0;
    for (std::uint32_t v = 0; v < kHeight; ++v) {
        ASSERT_EQ(mm_at(image, 254, v), 1000);
        ASSERT_EQ(mm_at(image, 256, v), 0);
        missing += mm_at(image, 255, v) == 0;
    }
    EXPECT_NEAR(missing / 424.0, 0.6, 0.12);
    const Image whole = measured(KinectNoise{}, plane(kNoSurface));
    EXPECT_EQ(static_cast<double>(std::ranges::count(whole, 0)), kPixels);
}

TEST(KinectNoise, is_a_function_of_seed_frame_and_pixel) {
    const Image first = measured(KinectNoise{}, halves, 3);
    EXPECT_EQ(measured(KinectNoise{}, halves, 3), first);
    EXPECT_NE(measured(KinectNoise{}, halves, 4), first);
    EXPECT_NE(measured(KinectNoise{}, halves, 3, 8), first);
    // Another depth in some pixels leaves all others but their neighbours.
    const Image changed = measured(
        KinectNoise{}, [](std::uint32_t u, std::uint32_t v) { return u > 400 ? 3.0 : halves(u, v); }, 3);
    for (std::uint32_t v = 0; v < kHeight; ++v)
        for (std::uint32_t u = 0; u < 400; ++u) ASSERT_EQ(mm_at(changed, u, v), mm_at(first, u, v));
}

TEST(KinectNoise, keeps_within_the_limits) {
    KinectNoise kinect = silent();
    kinect.sigma_min_m = 0.02;
    for (const double depth_m : {0.29, 0.31, 7.99, 8.01})
        for (const int depth_mm : measured(kinect, plane(depth_m)))
            ASSERT_TRUE(depth_mm == 0 || (depth_mm >= 300 && depth_mm <= 8000)) << depth_mm;
}

}  // namespace
}  // namespace octoskin::sim
