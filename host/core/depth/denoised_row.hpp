// The arithmetic of DepthDenoiser for one row of an image.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace octoskin {

/// DenoiserConfig and DepthNoiseLaw in single precision.
struct DenoiserRule {
    float sigma_m = 0.0F;
    float sigma_per_m = 0.0F;  ///< of the squared distance from `sigma_from_m`
    float sigma_from_m = 0.0F;
    float gate_sigmas = 0.0F;
    float step_sigmas = 0.0F;
    float drift_sigmas = 0.0F;
    float drift_memory = 0.0F;
    float count_max = 0.0F;
    float pair_sigmas = 0.0F;
    float slope = 0.0F;  ///< largest change of depth from pixel to pixel, as a share of the depth
    float support_min = 0.0F;
    float doubt_sigmas = 0.0F;
    float bias_variance = 0.0F;  ///< of the inverse depth
};

/// Pixels on each side of the centre of the window that is pooled and that supports a value.
inline constexpr std::size_t kDenoiserHalf = 2;
inline constexpr std::size_t kDenoiserSide = 2 * kDenoiserHalf + 1;
/// Distances in pixels of the eight neighbours that are averaged, one after the other: each time the values
/// to be averaged are means of other pixels, and so independent.
inline constexpr std::array<std::size_t, 3> kAveragedSteps{1, 3, 9};
/// Values without a pixel on each side of a row.
inline constexpr std::size_t kDenoiserMargin = kAveragedSteps.back();
/// Upper limit of the values read or written behind a row's last pixel and the margin.
inline constexpr std::size_t kDenoiserLanesMax = 64;

/// The surface that a pixel saw has changed: its earlier values are dropped, the new one may yet be wrong.
inline constexpr std::uint8_t kChangeFound = 1;
/// A second value agrees with the first one of a mean.
inline constexpr std::uint8_t kChangeConfirmed = 2;

/// What is remembered of the pixels of a row. A count of 0: no value yet. A negative count: the pixel's last
/// value was outside the gate and is held back; the number of values is the absolute value.
struct PixelMemoryRow {
    float* mean_m = nullptr;
    float* count = nullptr;
    float* drift = nullptr;
};

/// The difference of each new value from the pixel's mean, in sigmas and limited to the gate; 0 for a pixel
/// without both. `depth_m`: NaN or 0 for none. `known` is 1 for a pixel with both, else 0. Like all functions
/// here: the same bits for every instruction set.
void find_innovations(const DenoiserRule& rule, const float* depth_m, const PixelMemoryRow& memory,
                      std::size_t width, float* innovations, float* known);

/// Sums of five neighbours in a row. `values` begins two values before the first pixel.
void sum_fives(const float* values, std::size_t width, float* sums);

/// Row sums of innovations of the five rows around a row; null for a row outside the image.
struct PooledRows {
    const float* innovations[kDenoiserSide] = {};
    const float* known[kDenoiserSide] = {};
};

/// Inverse depths, 1 / m, their variances and the reciprocals of those; NaN, 0 and 0 for a pixel without a
/// value that counts.
struct PosteriorRow {
    float* inverse = nullptr;
    float* variance = nullptr;
    float* weight = nullptr;
};

/// Takes the new values into the memory, and writes the pixels' posterior, also of pixels without a new
/// value. A value that is held back becomes 0 in `depth_m`. `changes`: of each pixel kChangeFound,
/// kChangeConfirmed or 0. `next` is other memory.
void take_row(const DenoiserRule& rule, float* depth_m, const PooledRows& pooled,
              const PixelMemoryRow& memory, const PixelMemoryRow& next, const PosteriorRow& posterior,
              std::size_t width, std::uint8_t* changes);

/// A row and those a step above and below it.
struct AveragedRows {
    PosteriorRow above;
    PosteriorRow centre;
    PosteriorRow below;
};

/// The weighted mean of each pixel and of those opposite pairs of its eight neighbours at the distance `step`
/// that agree with it, with its variance. A pixel without a value stays so. `agreed`: how many neighbours do;
/// may be null. About 2 us for 512 pixels.
void average_row(const DenoiserRule& rule, const AveragedRows& rows, std::size_t step, std::size_t width,
                 const PosteriorRow& averaged, float* agreed);

/// The rows around a row.
struct WindowRows {
    const float* inverse[kDenoiserSide] = {};
    const float* variance[kDenoiserSide] = {};
};

/// Makes NaN of each depth, metres, without enough support. `agreed`: of average_row() with a step of 1.
/// `count`: of the pixel's values, after take_row().
void drop_unsupported(const DenoiserRule& rule, const WindowRows& rows, const float* agreed,
                      const float* count, std::size_t width, float* depth_m);

/// Of each pixel with a value `doubt_sigmas` sigmas of its depth, metres: of its posterior, and of what no
/// mean removes. 0 for a pixel with less than `count_min` values; `count`: after take_row().
void find_doubts(const DenoiserRule& rule, const PosteriorRow& posterior, const float* count, float count_min,
                 std::size_t width, float* doubts_m);

/// Replaces each depth above 0 by the reciprocal of `inverse`, any other by NaN.
void replace_depths(const float* inverse, std::size_t width, float* depth_m);

}  // namespace octoskin
