// Noise of a depth camera: from the true depth image to measured millimetres.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace octoskin::sim {

/// The same deviation in every pixel, independent from pixel to pixel and from frame to frame.
struct GaussianNoise {
    double sigma_m = 0.0;
};

/// A camera that triangulates a pattern of light, as the first Kinect.
struct KinectNoise {
    /// Deviation at depth z: sigma_min_m + sigma_growth_per_m (z - sigma_min_at_m)^2. The growth with the
    /// square of depth: Khoshelham and Elberink 2012. The numbers: Nguyen, Izadi and Lovell 2012, of walls
    /// that face the camera.
    double sigma_min_m = 0.0012;
    double sigma_min_at_m = 0.4;
    double sigma_growth_per_m = 0.0019;
    /// An error that stays from frame to frame: up to bias_growth_per_m z^2, drawn at the corners of squares
    /// of this size and interpolated between them. Its size is an assumption: Khoshelham and Elberink 2012
    /// find such errors of imperfect calibration, and give no pattern.
    double bias_growth_per_m = 0.0015;
    std::uint32_t bias_spacing_px = 16;
    /// Depth is focal_px baseline_m / disparity, and disparity is a multiple of the step (0: any number).
    /// Konolige and Mihelich 2010, "Technical description of Kinect calibration".
    double disparity_step_px = 0.125;
    double baseline_m = 0.075;
    double focal_px = 580.0;
    /// A pixel is at an edge if the depth of one of its four neighbours differs by more than this. Size and
    /// shares are assumptions.
    double edge_step_m = 0.05;
    double flying_share = 0.3;   ///< of edge pixels: between the two surfaces, in each frame elsewhere
    double missing_share = 0.3;  ///< of edge pixels: no value; at most 1 - flying_share
};

struct DepthNoise {
    std::variant<GaussianNoise, KinectNoise> model;  ///< by default none: a deviation of 0
};

[[nodiscard]] inline DepthNoise gaussian_noise(double sigma_m) noexcept {
    return {GaussianNoise{sigma_m}};
}

/// Depths along the optical axis without noise, height x width row-major; infinity where there is no surface.
struct TrueDepth {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::span<const double> depth_m;

    [[nodiscard]] double at(std::uint32_t u, std::uint32_t v) const noexcept {
        return depth_m[std::size_t{v} * width + u];
    }
};

/// Nothing else is measured. At most 65.535 m.
struct DepthLimits {
    double min_m = 0.0;
    double max_m = 0.0;
};

/// How far beyond a limit a surface may lie that noise brings back to it, metres: 10 deviations.
[[nodiscard]] double noise_margin_m(const DepthNoise& noise, double limit_m) noexcept;

/// The measured image in millimetres, shaped as `truth` (asserted to be complete); 0 without a value within
/// the limits. A function of (seed, frame index, pixel) and the true depths of the pixel and its neighbours.
/// A flying pixel beside a pixel without a surface has no value.
/// For 512 x 424: Gaussian about 5 ms, Kinect about 12 ms.
[[nodiscard]] std::vector<std::uint16_t> measured_mm(const DepthNoise& noise, const TrueDepth& truth,
                                                     const DepthLimits& limits, std::uint64_t seed,
                                                     std::uint32_t frame_index);

}  // namespace octoskin::sim
