// Removes the camera's noise: a gated median window, then a mean of what lies close to the median.
#pragma once

#include <cstdint>

#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

/// Window around each pixel: values within `gate_sigmas` of the centre, their median, then the mean of those
/// within `mean_sigmas` of it; no pixel if no more than `min_support` remain in that mean.
struct DepthFilterConfig {
    bool is_enabled = false;
    std::uint32_t window = 5;  ///< odd, 1 to 7
    double sigma_m = 0.03;     ///< the camera's own noise
    double gate_sigmas = 4.0;
    double mean_sigmas = 2.5;
    std::uint32_t min_support = 5;
    friend bool operator==(const DepthFilterConfig&, const DepthFilterConfig&) = default;
};

/// The filtered image, of the same size. The window is cut off at the image's border; a pixel without a value
/// stays without. The median of an even number of values is the mean of the middle two. `is_enabled` is the
/// caller's business. About 25 ms for 512 x 424.
[[nodiscard]] DepthImage filter_depth(const DepthImage& image, const DepthFilterConfig& config);

}  // namespace octoskin
