#include "hw/sim/camera/depth_noise.hpp"

#include <cassert>
#include <cmath>
#include <limits>

#include "hw/sim/noise/noise.hpp"

namespace octoskin::sim {
namespace {

constexpr double kNone_m = std::numeric_limits<double>::infinity();

double squared(double value) noexcept {
    return value * value;
}

double sigma_m(const KinectNoise& kinect, double depth_m) noexcept {
    return kinect.sigma_min_m + kinect.sigma_growth_per_m * squared(depth_m - kinect.sigma_min_at_m);
}

/// The depth of the nearest multiple of the disparity's step; infinity for a disparity of 0.
double quantised_m(const KinectNoise& kinect, double depth_m) noexcept {
    if (!(kinect.disparity_step_px > 0.0)) return depth_m;
    const double depth_of_a_step_m = kinect.focal_px * kinect.baseline_m / kinect.disparity_step_px;
    return depth_of_a_step_m / std::round(depth_of_a_step_m / depth_m);
}

/// One frame of a camera with Gaussian noise.
struct GaussianFrame {
    const GaussianNoise& gaussian;
    const TrueDepth& truth;
    Noise noise;

    [[nodiscard]] double measured_m(std::uint32_t u, std::uint32_t v) const {
        const double depth_m = truth.at(u, v);
        return gaussian.sigma_m > 0.0
                   ? depth_m + gaussian.sigma_m * noise.gaussian(std::size_t{v} * truth.width + u)
                   : depth_m;
    }
};

/// Of one square of the pattern of bias: its row and column, and the place in it from 0 to 1.
struct PlaceInSquare {
    std::uint32_t index;
    double part;

    PlaceInSquare(std::uint32_t pixel, std::uint32_t spacing)
        : index(pixel / spacing), part(static_cast<double>(pixel % spacing) / spacing) {}
};

/// One frame of a Kinect.
struct KinectFrame {
    const KinectNoise& kinect;
    const TrueDepth& truth;
    Noise noise;
    Noise edge;
    Noise bias;  ///< of all frames

    [[nodiscard]] double measured_m(std::uint32_t u, std::uint32_t v) const {
        const std::size_t pixel = std::size_t{v} * truth.width + u;
        const double depth_m = depth_at_edges_m(u, v, pixel);
        if (!std::isfinite(depth_m)) return kNone_m;
        const double biased_m = depth_m + kinect.bias_growth_per_m * squared(depth_m) * pattern(u, v);
        const double noisy_m = biased_m + sigma_m(kinect, depth_m) * noise.gaussian(pixel);
        return noisy_m > 0.0 ? quantised_m(kinect, noisy_m) : kNone_m;
    }

  private:
    /// The true depth, or what an edge makes of it. One draw decides, and its place within the share of
    /// flying pixels is the place between the surfaces.
    [[nodiscard]] double depth_at_edges_m(std::uint32_t u, std::uint32_t v, std::size_t pixel) const {
        const double depth_m = truth.at(u, v);
        const double other_m = most_different_neighbour_m(u, v);
        if (!(std::abs(other_m - depth_m) > kinect.edge_step_m)) return depth_m;
        const double draw = edge.uniform(pixel);
        if (draw < kinect.missing_share) return kNone_m;
        const double of_flying = draw - kinect.missing_share;
        if (of_flying >= kinect.flying_share) return depth_m;
        return depth_m + of_flying / kinect.flying_share * (other_m - depth_m);
    }

    /// The pixel's own depth at least, which differs by nothing.
    [[nodiscard]] double most_different_neighbour_m(std::uint32_t u, std::uint32_t v) const {
        const double depth_m = truth.at(u, v);
        if (!std::isfinite(depth_m)) return depth_m;
        double other_m = depth_m;
        const auto consider = [&](double neighbour_m) {
            if (std::abs(neighbour_m - depth_m) > std::abs(other_m - depth_m)) other_m = neighbour_m;
        };
        if (u > 0) consider(truth.at(u - 1, v));
        if (u + 1 < truth.width) consider(truth.at(u + 1, v));
        if (v > 0) consider(truth.at(u, v - 1));
        if (v + 1 < truth.height) consider(truth.at(u, v + 1));
        return other_m;
    }

    /// Value noise in [-1, 1]: draws at the corners of squares, bilinear between them.
    [[nodiscard]] double pattern(std::uint32_t u, std::uint32_t v) const {
        const PlaceInSquare column(u, kinect.bias_spacing_px);
        const PlaceInSquare row(v, kinect.bias_spacing_px);
        const auto across = [&](std::uint32_t row_index) {
            const Noise draws = bias.of(row_index);
            return std::lerp(draws.uniform(column.index), draws.uniform(column.index + 1), column.part);
        };
        return 2.0 * std::lerp(across(row.index), across(row.index + 1), row.part) - 1.0;
    }
};

std::uint16_t millimetres(double measured_m, const DepthLimits& limits) {
    if (!std::isfinite(measured_m) || measured_m < limits.min_m || measured_m > limits.max_m) return 0;
    return static_cast<std::uint16_t>(std::lround(measured_m * 1e3));
}

std::vector<std::uint16_t> image_of(const auto& frame, const TrueDepth& truth, const DepthLimits& limits) {
    std::vector<std::uint16_t> image(truth.depth_m.size());
    std::size_t pixel = 0;
    for (std::uint32_t v = 0; v < truth.height; ++v)
        for (std::uint32_t u = 0; u < truth.width; ++u)
            image[pixel++] = millimetres(frame.measured_m(u, v), limits);
    return image;
}

}  // namespace

double noise_margin_m(const DepthNoise& noise, double limit_m) noexcept {
    if (const auto* gaussian = std::get_if<GaussianNoise>(&noise.model)) return 10.0 * gaussian->sigma_m;
    const auto& kinect = std::get<KinectNoise>(noise.model);
    const double half_step_m =
        0.5 * kinect.disparity_step_px * squared(limit_m) / (kinect.focal_px * kinect.baseline_m);
    return 10.0 * sigma_m(kinect, limit_m) + kinect.bias_growth_per_m * squared(limit_m) + half_step_m;
}

std::vector<std::uint16_t> measured_mm(const DepthNoise& noise, const TrueDepth& truth,
                                       const DepthLimits& limits, std::uint64_t seed,
                                       std::uint32_t frame_index) {
    assert(truth.depth_m.size() == std::size_t{truth.width} * truth.height);
    const Noise of_frame = Noise(seed, NoiseSource::depth).of(frame_index);
    if (const auto* gaussian = std::get_if<GaussianNoise>(&noise.model))
        return image_of(GaussianFrame{*gaussian, truth, of_frame}, truth, limits);
    return image_of(KinectFrame{std::get<KinectNoise>(noise.model), truth, of_frame,
                                Noise(seed, NoiseSource::depth_edge).of(frame_index),
                                Noise(seed, NoiseSource::depth_bias)},
                    truth, limits);
}

}  // namespace octoskin::sim
