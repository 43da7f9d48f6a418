#include "host/core/depth/depth_filter.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace octoskin {
namespace {

constexpr double kMmPerM = 1000.0;

/// Rounds down: a value further away, by however little, is outside the gate. The rounding error of 4 * 0.03
/// is allowed for.
std::int16_t whole(double units) {
    constexpr double kRounding = 1e-6;
    assert(units >= 0.0);
    return static_cast<std::int16_t>(std::floor(units + kRounding));
}

}  // namespace

DepthFilter::DepthFilter(const DepthFilterConfig& config)
    : window_{.side = config.window,
              .gate_mm = whole(kMmPerM * config.gate_m()),
              .mean_gate_mm2 = whole(2.0 * kMmPerM * config.mean_gate_m()),
              .min_support = static_cast<float>(config.min_support)} {
    assert(config.window % 2 == 1 && config.window <= 7);
    assert(std::max(config.gate_m(), config.mean_gate_m()) <= DepthFilterConfig::kGateMax_m);
}

void DepthFilter::filter(DepthImage& image) {
    assert(image.depth_m.size() == std::size_t{image.width} * image.height);
    const std::size_t stride = image.width + window_.side + kFilterLanesMax;
    frame(image, stride);
    for (std::size_t v = 0; v < image.height; ++v) {
        filter_row(window_, {framed_.data() + v * stride, stride, image.width},
                   image.depth_m.data() + v * image.width);
    }
}

void DepthFilter::frame(const DepthImage& image, std::size_t stride) {
    const std::size_t margin = window_.side / 2;
    framed_.assign((image.height + 2 * margin) * stride, kNoDepth);
    const auto most_mm = static_cast<float>(depth_max_mm(window_));
    const int zero = zero_depth(window_);
    for (std::size_t v = 0; v < image.height; ++v) {
        const float* const depth_m = image.depth_m.data() + v * image.width;
        CodedDepth* const framed = framed_.data() + (v + margin) * stride + margin;
        for (std::size_t u = 0; u < image.width; ++u) {
            const float rounded_mm = static_cast<float>(kMmPerM) * depth_m[u] + 0.5F;
            const bool is_depth = rounded_mm >= 1.0F && rounded_mm < most_mm + 1.0F;  // false for a NaN
            const int depth_mm = static_cast<int>(is_depth ? rounded_mm : 0.0F);
            framed[u] = static_cast<CodedDepth>(is_depth ? zero + depth_mm : int{kNoDepth});
        }
    }
}

}  // namespace octoskin
