#include "host/core/depth/depth_denoiser.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace octoskin {
namespace {

/// Steepest surface whose pixels are averaged however small the noise, seen 63 degrees off its normal.
constexpr double kSlopeTangent = 2.0;

/// A surface of which a stationary camera has fewer values may just have come there. It marks all that it may
/// be in.
constexpr float kDoubtfulFrom = 10.0F;

DenoiserRule rule_of(const DepthDenoiserConfig& config, const CameraIntrinsics& camera) {
    const auto single = [](double value) { return static_cast<float>(value); };
    const double pixel = 2.0 / (camera.fx + camera.fy);  // size of a pixel at 1 m
    return {.sigma_m = single(config.noise.constant_m),
            .sigma_per_m = single(config.noise.quadratic_per_m),
            .sigma_from_m = single(config.noise.from_m),
            .gate_sigmas = single(config.gate_sigmas),
            .step_sigmas = single(config.step_sigmas),
            .drift_sigmas = single(config.drift_sigmas),
            .drift_memory = single(config.drift_memory),
            .count_max = static_cast<float>(config.count_max),
            .pair_sigmas = single(config.pair_sigmas),
            .slope = single(kSlopeTangent * pixel),
            .support_min = static_cast<float>(config.support_min),
            .doubt_sigmas = single(config.doubt_sigmas),
            .bias_variance = single(config.noise.bias_per_m * config.noise.bias_per_m)};
}

// How many rows later than `pool` each part comes, which needs rows below its own.
constexpr std::ptrdiff_t kTaken = kDenoiserHalf;
constexpr std::ptrdiff_t kSupported = kTaken + kDenoiserHalf;
constexpr std::ptrdiff_t kWritten = kSupported + kAveragedSteps[1] + kAveragedSteps[2];
/// At least the rows of anything that are needed at once.
constexpr std::size_t kRows = 24;
static_assert(kRows > 2 * kAveragedSteps.back() && kRows > kWritten);

}  // namespace

DepthDenoiser::Rows::Rows(std::size_t rows, std::size_t width, float outside)
    : rows_(rows),
      width_(width),
      stride_(width + 2 * kDenoiserMargin + kDenoiserLanesMax),
      outside_(outside),
      values_(rows * stride_, outside) {}

void DepthDenoiser::Rows::limit(Row v) noexcept {
    std::fill_n(at(v) + width_, kDenoiserMargin, outside_);
}

DepthDenoiser::PosteriorRows::PosteriorRows(std::size_t rows, std::size_t width)
    : inverse(rows, width, std::numeric_limits<float>::quiet_NaN()),
      variance(rows, width, 0.0F),
      weight(rows, width, 0.0F) {}

DepthDenoiser::DepthDenoiser(const DepthDenoiserConfig& config, const CameraIntrinsics& camera)
    : rule_(rule_of(config, camera)),
      width_(camera.width),
      height_(camera.height),
      stride_(camera.width + kDenoiserLanesMax),
      nothing_(stride_, 0.0F),
      depth_m_(kRows, width_, 0.0F),
      innovations_(1, width_, 0.0F),
      known_(1, width_, 0.0F),
      pooled_(kRows, width_, 0.0F),
      pooled_known_(kRows, width_, 0.0F),
      agreed_(1, width_, 0.0F),
      posteriors_(kAveragedSteps.size() + 1, PosteriorRows(kRows, width_)),
      outside_(1, width_),
      changes_row_(stride_, 0),
      changes_(std::size_t{width_} * height_, 0),
      doubts_m_(std::size_t{width_} * height_ + kDenoiserLanesMax, 0.0F) {
    assert(config.noise.constant_m >= 1e-4 && config.noise.quadratic_per_m >= 0.0);
    assert(config.count_max > 0);
    assert(std::min({config.gate_sigmas, config.step_sigmas, config.drift_sigmas, config.pair_sigmas}) > 0.0);
    for (PixelMemory* const memory : {&memory_, &next_}) {
        memory->mean_m.assign(stride_ * height_, 0.0F);
        memory->count.assign(stride_ * height_, 0.0F);
        memory->drift.assign(stride_ * height_, 0.0F);
    }
}

PixelMemoryRow DepthDenoiser::row_of(PixelMemory& memory, std::size_t begin) noexcept {
    return {memory.mean_m.data() + begin, memory.count.data() + begin, memory.drift.data() + begin};
}

PixelMemoryRow DepthDenoiser::remembered(Memory memory, Row v) noexcept {
    if (memory == Memory::used) return row_of(memory_, begin_of(static_cast<std::size_t>(v)));
    return {nothing_.data(), nothing_.data(), nothing_.data()};
}

/// Each row goes through all parts as soon as the rows that they need are there, while these are in the
/// cache.
void DepthDenoiser::denoise(DepthImage& image, Memory memory) {
    assert(image.width == width_ && image.height == height_);
    assert(image.depth_m.size() == std::size_t{width_} * height_);
    for (Row v = 0; v < static_cast<Row>(height_) + kWritten; ++v) {
        pool(v, image, memory);
        take(v - kTaken, memory);
        Row averaged = v - kSupported;
        for (std::size_t level = 0; level < kAveragedSteps.size(); ++level) {
            if (level > 0) averaged -= static_cast<Row>(kAveragedSteps[level]);
            average(level, averaged);
            if (level == 0) support(averaged);
        }
        write(averaged, image, memory);
    }
}

void DepthDenoiser::pool(Row v, const DepthImage& image, Memory memory) {
    if (!has(v)) return;
    std::copy_n(image.depth_m.data() + static_cast<std::size_t>(v) * width_, width_, depth_m_.at(v));
    if (memory == Memory::of_other_place) return;  // there is nothing to compare the image with
    find_innovations(rule_, depth_m_.at(v), remembered(memory, v), width_, innovations_.at(0), known_.at(0));
    innovations_.limit(0);
    known_.limit(0);
    sum_fives(innovations_.at(0) - kDenoiserHalf, width_, pooled_.at(v));
    sum_fives(known_.at(0) - kDenoiserHalf, width_, pooled_known_.at(v));
}

void DepthDenoiser::take(Row v, Memory memory) {
    if (!has(v)) return;
    PooledRows pooled;
    for (std::size_t i = 0; i < kDenoiserSide; ++i) {
        const Row row = v + static_cast<Row>(i) - static_cast<Row>(kDenoiserHalf);
        if (!has(row) || memory == Memory::of_other_place) continue;
        pooled.innovations[i] = pooled_.at(row);
        pooled.known[i] = pooled_known_.at(row);
    }
    take_row(rule_, depth_m_.at(v), pooled, remembered(memory, v),
             row_of(next_, begin_of(static_cast<std::size_t>(v))), posteriors_.front().at(v), width_,
             changes_row_.data());
    posteriors_.front().inverse.limit(v);
    std::copy_n(changes_row_.data(), width_, changes_.data() + static_cast<std::size_t>(v) * width_);
}

void DepthDenoiser::average(std::size_t level, Row v) {
    if (!has(v)) return;
    const auto step = static_cast<Row>(kAveragedSteps[level]);
    average_row(rule_, {averaged_at(level, v - step), averaged_at(level, v), averaged_at(level, v + step)},
                kAveragedSteps[level], width_, posteriors_[level + 1].at(v),
                level == 0 ? agreed_.at(0) : nullptr);
    posteriors_[level + 1].inverse.limit(v);
}

void DepthDenoiser::support(Row v) {
    if (!has(v)) return;
    WindowRows rows;
    for (std::size_t i = 0; i < kDenoiserSide; ++i) {
        const PosteriorRow row = averaged_at(0, v + static_cast<Row>(i) - static_cast<Row>(kDenoiserHalf));
        rows.inverse[i] = row.inverse;
        rows.variance[i] = row.variance;
    }
    drop_unsupported(rule_, rows, agreed_.at(0), next_.count.data() + begin_of(static_cast<std::size_t>(v)),
                     width_, depth_m_.at(v));
}

void DepthDenoiser::write(Row v, DepthImage& image, Memory memory) {
    if (!has(v)) return;
    const PosteriorRow posterior = posteriors_.back().at(v);
    const float count_min = memory == Memory::used ? kDoubtfulFrom : 0.0F;
    find_doubts(rule_, posterior, next_.count.data() + begin_of(static_cast<std::size_t>(v)), count_min,
                width_, doubts_m_.data() + static_cast<std::size_t>(v) * width_);
    replace_depths(posterior.inverse, width_, depth_m_.at(v));
    std::copy_n(depth_m_.at(v), width_, image.depth_m.data() + static_cast<std::size_t>(v) * width_);
}

DepthDenoiser::Pixel DepthDenoiser::pixel(std::uint32_t u, std::uint32_t v) const noexcept {
    const std::size_t at = begin_of(v) + u;
    return {memory_.mean_m[at], memory_.count[at], memory_.drift[at]};
}

void DepthDenoiser::set_pixel(std::uint32_t u, std::uint32_t v, const Pixel& pixel) noexcept {
    const std::size_t at = begin_of(v) + u;
    memory_.mean_m[at] = pixel.mean_m;
    memory_.count[at] = pixel.count;
    memory_.drift[at] = pixel.drift;
}

}  // namespace octoskin
