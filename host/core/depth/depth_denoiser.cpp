#include "host/core/depth/depth_denoiser.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace octoskin {
namespace {

/// Steepest surface whose pixels are averaged, seen 80 degrees off its normal; a single neighbour counts as
/// support up to 63 degrees.
constexpr double kPairTangent = 5.7;
constexpr double kMemberTangent = 2.0;

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
            .pair_slope = single(kPairTangent * pixel),
            .member_slope = single(kMemberTangent * pixel),
            .support_min = static_cast<float>(config.support_min)};
}

}  // namespace

DepthDenoiser::DepthDenoiser(const DepthDenoiserConfig& config, const CameraIntrinsics& camera)
    : rule_(rule_of(config, camera)),
      width_(camera.width),
      height_(camera.height),
      stride_(camera.width + 2 * kDenoiserHalf + kDenoiserLanesMax) {
    assert(config.noise.constant_m >= 1e-4 && config.noise.quadratic_per_m >= 0.0);
    assert(config.count_max > 0);
    assert(std::min({config.gate_sigmas, config.step_sigmas, config.drift_sigmas, config.pair_sigmas}) > 0.0);
    const std::size_t size = stride_ * height_;
    for (PixelMemory* const memory : {&memory_, &next_}) {
        memory->mean_m.assign(size, 0.0F);
        memory->count.assign(size, 0.0F);
        memory->drift.assign(size, 0.0F);
    }
    nothing_.assign(stride_, 0.0F);
    depth_m_.assign(size, 0.0F);
    innovations_.assign(stride_, 0.0F);
    known_.assign(stride_, 0.0F);
    pooled_.assign(size, 0.0F);
    pooled_known_.assign(size, 0.0F);
    const std::size_t padded_size = stride_ * (height_ + 2 * kDenoiserHalf);
    inverse_.assign(padded_size, std::numeric_limits<float>::quiet_NaN());
    variance_.assign(padded_size, 0.0F);
    weight_.assign(padded_size, 0.0F);
    restarted_row_.assign(stride_, 0);
    restarted_.assign(std::size_t{width_} * height_, 0);
}

PixelMemoryRow DepthDenoiser::row_of(PixelMemory& memory, std::size_t begin) noexcept {
    return {memory.mean_m.data() + begin, memory.count.data() + begin, memory.drift.data() + begin};
}

PixelMemoryRow DepthDenoiser::remembered(Memory memory, std::size_t begin) noexcept {
    if (memory == Memory::used) return row_of(memory_, begin);
    return {nothing_.data(), nothing_.data(), nothing_.data()};
}

void DepthDenoiser::denoise(DepthImage& image, Memory memory) {
    assert(image.width == width_ && image.height == height_);
    assert(image.depth_m.size() == std::size_t{width_} * height_);
    frame(image);
    pool(memory);
    take(memory);
    for (std::size_t v = 0; v < height_; ++v) {
        PosteriorRows rows;
        for (std::size_t i = 0; i < kDenoiserSide; ++i) {
            const std::size_t begin = (v + i) * stride_;
            rows.inverse[i] = inverse_.data() + begin;
            rows.variance[i] = variance_.data() + begin;
            rows.weight[i] = weight_.data() + begin;
        }
        float* const depth_m = depth_m_.data() + begin_of(v);
        denoise_row(rule_, rows, next_.count.data() + begin_of(v), width_, depth_m);
        std::copy_n(depth_m, width_, image.depth_m.data() + v * width_);
    }
}

void DepthDenoiser::frame(const DepthImage& image) {
    for (std::size_t v = 0; v < height_; ++v)
        std::copy_n(image.depth_m.data() + v * width_, width_, depth_m_.data() + begin_of(v));
}

void DepthDenoiser::pool(Memory memory) {
    for (std::size_t v = 0; v < height_; ++v) {
        const std::size_t begin = begin_of(v);
        find_innovations(rule_, depth_m_.data() + begin, remembered(memory, begin), width_,
                         innovations_.data() + kDenoiserHalf, known_.data() + kDenoiserHalf);
        // What was computed behind the last pixel is of no pixel.
        std::fill_n(innovations_.data() + kDenoiserHalf + width_, kDenoiserHalf, 0.0F);
        std::fill_n(known_.data() + kDenoiserHalf + width_, kDenoiserHalf, 0.0F);
        sum_fives(innovations_.data(), width_, pooled_.data() + begin);
        sum_fives(known_.data(), width_, pooled_known_.data() + begin);
    }
}

void DepthDenoiser::take(Memory memory) {
    for (std::size_t v = 0; v < height_; ++v) {
        PooledRows pooled;
        for (std::size_t i = 0; i < kDenoiserSide; ++i) {
            if (v + i < kDenoiserHalf || v + i >= height_ + kDenoiserHalf) continue;
            pooled.innovations[i] = pooled_.data() + begin_of(v + i - kDenoiserHalf);
            pooled.known[i] = pooled_known_.data() + begin_of(v + i - kDenoiserHalf);
        }
        const std::size_t begin = begin_of(v);
        const std::size_t framed = (v + kDenoiserHalf) * stride_ + kDenoiserHalf;
        take_row(rule_, depth_m_.data() + begin, pooled, remembered(memory, begin), row_of(next_, begin),
                 {inverse_.data() + framed, variance_.data() + framed, weight_.data() + framed}, width_,
                 restarted_row_.data());
        std::fill_n(inverse_.data() + framed + width_, kDenoiserHalf,
                    std::numeric_limits<float>::quiet_NaN());
        std::copy_n(restarted_row_.data(), width_, restarted_.data() + v * width_);
    }
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
