#include "host/core/mapping/thin_objects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace octoskin {
namespace {

ThinView view_of(double sigma_m, double voxel_m = 0.04) {
    ThinView view{.focal_px = 365.0, .voxel_m = voxel_m};
    view.denoiser.noise = {.constant_m = sigma_m};
    return view;
}

/// The same by throwing dice: of the voxels with a pixel, those with at least one end in them. `pixels`: of a
/// voxel that the object fills; five of them have one error, of this deviation.
double rolled_share(double sigma_m, double voxel_m, double pixels) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::normal_distribution<double> error(0.0, sigma_m);
    int seen = 0;
    int kept = 0;
    for (int i = 0; i < 200'000; ++i) {
        const double there = share(random) * pixels;
        if (share(random) >= there) continue;
        const double errors = std::max(1.0, there / 5.0);
        // A whole number with that mean.
        const int ends = static_cast<int>(errors) + (share(random) < errors - std::floor(errors) ? 1 : 0);
        const double at_m = share(random) * voxel_m;
        bool is_hit = false;
        for (int end = 0; end < ends; ++end) {
            const double end_m = at_m + error(random);
            is_hit = is_hit || (end_m >= 0.0 && end_m < voxel_m);
        }
        seen += 1;
        kept += is_hit ? 1 : 0;
    }
    return static_cast<double>(kept) / seen;
}

TEST(ThinObjects, keep_the_voxels_in_which_a_pixel_ends) {
    // At 3.65 m a pixel covers 10 mm: 4 rows a voxel of 4 cm, and 1, 2 and 4 columns of objects this thick,
    // of which the denoiser averages as many, 5 at most.
    struct Case {
        double thickness_m, pixels, averaged;
    };
    for (const Case& of : {Case{0.01, 4, 5}, {0.02, 8, 10}, {0.04, 16, 20}, {0.4, 16, 25}}) {
        for (const double images : {1.0, 4.0, 16.0}) {
            const ThinKept kept = thin_kept(view_of(0.08), of.thickness_m, 3.65, images);
            EXPECT_NEAR(kept.of_seen, rolled_share(0.08 / std::sqrt(images * of.averaged), 0.04, of.pixels),
                        0.02)
                << of.thickness_m << " m, " << images << " images";
            EXPECT_EQ(kept.seen, 1.0);
        }
    }
}

/// What `octoskin-lab depth` measures in hw/worlds/rods.scenario.yaml with hw/rigs/rods.yaml, mapping
/// `denoised`, seeds 0 and 1: the occupied share of the seen voxels of rods of 5 to 8 mm and of 10 to 16 mm
/// that are further than standoff_m() before what is behind them. Their mean depth is 1.72 m, their mean
/// thickness 6.15 and 12.3 mm.
struct Measured {
    double voxel_m;
    double sigma_m;
    double images;
    double of_5_8_mm;
    double of_10_16_mm;
};

TEST(ThinObjects, are_kept_as_the_laboratory_measures) {
    for (const Measured& of : {Measured{0.04, 0.03, 1, 0.876, 0.896},
                               {0.04, 0.03, 4, 0.938, 0.931},
                               {0.04, 0.03, 11, 0.963, 0.972},
                               {0.04, 0.03, 51, 0.988, 0.987},
                               {0.04, 0.01, 1, 0.953, 0.965},
                               {0.04, 0.01, 4, 0.984, 0.978},
                               {0.04, 0.01, 11, 0.988, 0.985},
                               {0.04, 0.01, 51, 0.994, 0.991},
                               {0.02, 0.03, 11, 0.902, 0.921},
                               {0.02, 0.03, 51, 0.969, 0.980},
                               {0.02, 0.01, 1, 0.870, 0.905},
                               {0.02, 0.01, 11, 0.980, 0.984},
                               {0.02, 0.01, 51, 0.993, 0.988},
                               {0.01, 0.03, 11, 0.749, 0.757},
                               {0.01, 0.03, 51, 0.892, 0.924},
                               {0.01, 0.01, 1, 0.722, 0.715},
                               {0.01, 0.01, 11, 0.926, 0.930}}) {
        const ThinView view = view_of(of.sigma_m, of.voxel_m);
        EXPECT_NEAR(thin_kept(view, 0.00615, 1.72, of.images).of_seen, of.of_5_8_mm, 0.065);
        EXPECT_NEAR(thin_kept(view, 0.0123, 1.72, of.images).of_seen, of.of_10_16_mm, 0.065);
    }
}

TEST(ThinObjects, thinner_than_a_pixel_are_seen_in_part) {
    EXPECT_DOUBLE_EQ(thin_kept(view_of(0.03), 0.005, 3.65, 10.0).seen, 0.5);
    EXPECT_DOUBLE_EQ(thin_kept(view_of(0.03), 0.010, 3.65, 10.0).seen, 1.0);
    EXPECT_DOUBLE_EQ(thin_kept(view_of(0.03, 0.005), 0.010, 3.65, 10.0).seen, 0.5) << "every other voxel";
}

TEST(ThinObjects, are_kept_from_the_size_of_a_pixel_on_if_the_noise_lets_them) {
    EXPECT_NEAR(thinnest_kept_m(view_of(0.005), 1.0, 1.0).value(), 1.0 / 365.0, 1e-9);
    EXPECT_NEAR(thinnest_kept_m(view_of(0.03), 2.0, 50.0).value(), 2.0 / 365.0, 1e-9);
    EXPECT_FALSE(thinnest_kept_m(view_of(0.03, 0.01), 2.0, 10.0)) << "3 cm of noise, voxels of 1 cm";
    EXPECT_FALSE(thinnest_kept_m(view_of(0.001, 0.005), 2.0, 100.0)) << "a pixel covers 5.5 mm";
    // In between, an object needs as many pixels as make up for the noise.
    const ThinView view = view_of(0.03);
    const double thinnest_m = thinnest_kept_m(view, 2.0, 1.0).value();
    EXPECT_NEAR(thinnest_m, 0.0191, 5e-4);
    EXPECT_GE(thin_kept(view, thinnest_m, 2.0, 1.0).of_seen, kThinKeptShare);
    EXPECT_LT(thin_kept(view, thinnest_m - 0.001, 2.0, 1.0).of_seen, kThinKeptShare);
}

TEST(ThinObjects, that_are_further_noisier_or_in_smaller_voxels_must_be_thicker) {
    const auto thinnest = [](const ThinView& view, double depth_m, double images) {
        return thinnest_kept_m(view, depth_m, images).value_or(1.0);
    };
    for (double depth_m = 0.5; depth_m < 5.0; depth_m += 0.5) {
        for (const double sigma_m : {0.005, 0.02, 0.04, 0.06}) {
            const double one = thinnest(view_of(sigma_m), depth_m, 1.0);
            EXPECT_LE(one, thinnest(view_of(sigma_m), depth_m + 0.5, 1.0));
            EXPECT_LE(one, thinnest(view_of(sigma_m + 0.02), depth_m, 1.0));
            EXPECT_LE(one, thinnest(view_of(sigma_m, 0.02), depth_m, 1.0));
            EXPECT_GE(one, thinnest(view_of(sigma_m), depth_m, 10.0));
        }
    }
}

TEST(ThinObjects, average_as_many_images_as_the_denoiser_does) {
    ThinView view = view_of(0.06);
    view.denoiser.count_max = 4;
    EXPECT_EQ(thin_kept(view, 0.01, 3.65, 100.0).of_seen, thin_kept(view, 0.01, 3.65, 4.0).of_seen);
    EXPECT_NEAR(standoff_m(view, 3.65, 1.0), 0.2205, 1e-4) << "1.2247 * 3 * 6 cm";
    EXPECT_NEAR(standoff_m(view, 3.65, 4.0), 0.1102, 1e-4);
}

}  // namespace
}  // namespace octoskin
