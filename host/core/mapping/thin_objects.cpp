#include "host/core/mapping/thin_objects.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace octoskin {
namespace {

double pixel_m(const ThinView& view, double depth_m) {
    return depth_m / view.focal_px;
}

/// Deviation of the mean of a pixel's values.
double mean_sigma_m(const ThinView& view, double depth_m, double images) {
    const double values = std::min(images, static_cast<double>(view.denoiser.count_max));
    return view.denoiser.noise.sigma_m(depth_m) / std::sqrt(values);
}

constexpr int kSteps = 50;  // of each of the two means below

/// For a surface at each of kSteps places between a voxel's front and back: the share of pixels that end
/// outside.
std::array<double, kSteps> shares_outside(double sigma_m, double edge_m) {
    const auto below = [&](double gap_m) {
        return 0.5 * std::erfc(-gap_m / (sigma_m * std::numbers::sqrt2));
    };
    std::array<double, kSteps> shares{};
    for (int i = 0; i < kSteps; ++i) {
        const double place_m = (i + 0.5) / kSteps * edge_m;
        shares[static_cast<std::size_t>(i)] = 2.0 - below(place_m) - below(edge_m - place_m);
    }
    return shares;
}

/// Of the voxels that an object fills.
struct Pixels {
    double filled = 0.0;    ///< their number
    double averaged = 1.0;  ///< over how many of them the denoiser takes a mean
};

/// Share of the seen voxels in which at least one pixel ends. `sigma_m`: of a pixel's mean over time.
double hit_share(const Pixels& pixels, double sigma_m, double voxel_m) {
    const auto outside = shares_outside(sigma_m / std::sqrt(pixels.averaged), voxel_m);
    double hit = 0.0;
    double seen = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double there = (i + 0.5) / kSteps * pixels.filled;
        const double weight = std::min(1.0, there);  // with less than a pixel, it is seen now and then
        const double errors = std::max(1.0, there / kDenoiserSide);
        for (const double share : outside) hit += weight * (1.0 - std::pow(share, errors));
        seen += weight * kSteps;
    }
    return hit / seen;
}

}  // namespace

ThinKept thin_kept(const ThinView& view, double thickness_m, double depth_m, double images) {
    assert(thickness_m > 0.0 && depth_m > 0.0 && images >= 1.0);
    const double pixel = pixel_m(view, depth_m);
    const double across = std::min(thickness_m, view.voxel_m) / pixel;
    const double along = view.voxel_m / pixel;
    constexpr double kWindow = kDenoiserSide;
    const Pixels pixels{.filled = std::max(1.0, across) * std::max(1.0, along),
                        .averaged = kWindow * std::clamp(thickness_m / pixel, 1.0, kWindow)};
    return {.seen = std::min(1.0, thickness_m / pixel) * std::min(1.0, along),
            .of_seen = hit_share(pixels, mean_sigma_m(view, depth_m, images), view.voxel_m)};
}

std::optional<double> thinnest_kept_m(const ThinView& view, double depth_m, double images) {
    const auto is_kept = [&](double thickness_m) {
        return thin_kept(view, thickness_m, depth_m, images).of_seen >= kThinKeptShare;
    };
    const double least_m = pixel_m(view, depth_m);
    if (least_m > view.voxel_m || !is_kept(view.voxel_m)) return std::nullopt;
    if (is_kept(least_m)) return least_m;
    double lost_m = least_m;
    double kept_m = view.voxel_m;
    constexpr double kPrecision_m = 1e-4;
    while (kept_m - lost_m > kPrecision_m) {
        const double middle_m = 0.5 * (lost_m + kept_m);
        (is_kept(middle_m) ? kept_m : lost_m) = middle_m;
    }
    return kept_m;
}

double standoff_m(const ThinView& view, double depth_m, double images) {
    // DepthDenoiser: two opposite pixels of the surface behind agree with the object's between them if twice
    // their distance is within pair_sigmas of its deviation, the root of 1 + 1 + 4 variances.
    const double bend_sigmas = std::sqrt(6.0) * view.denoiser.pair_sigmas;
    return 0.5 * bend_sigmas * mean_sigma_m(view, depth_m, images);
}

}  // namespace octoskin
