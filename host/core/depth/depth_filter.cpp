#include "host/core/depth/depth_filter.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>

namespace octoskin {

DepthFilter::DepthFilter(const DepthFilterConfig& config)
    : window_{.side = config.window,
              .gate_m = static_cast<float>(config.gate_sigmas * config.sigma_m),
              .mean_gate_m = static_cast<float>(config.mean_sigmas * config.sigma_m),
              .min_support = static_cast<float>(config.min_support)} {
    assert(config.window % 2 == 1 && config.window <= 7);
}

void DepthFilter::filter(DepthImage& image) {
    assert(image.depth_m.size() == std::size_t{image.width} * image.height);
    const std::size_t stride = image.width + window_.side + kFilterLanesMax;
    frame(image, stride);
    for (std::size_t v = 0; v < image.height; ++v) {
        filter_row(window_, {framed_m_.data() + v * stride, stride, image.width},
                   image.depth_m.data() + v * image.width);
    }
}

void DepthFilter::frame(const DepthImage& image, std::size_t stride) {
    const std::size_t margin = window_.side / 2;
    framed_m_.assign((image.height + 2 * margin) * stride, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t v = 0; v < image.height; ++v) {
        std::copy_n(image.depth_m.data() + v * image.width, image.width,
                    framed_m_.data() + (v + margin) * stride + margin);
    }
}

}  // namespace octoskin
