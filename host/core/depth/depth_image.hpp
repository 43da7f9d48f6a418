// Converts a frame to the image that filters use: metres, and NaN for pixels without a measurement.
#pragma once

#include <cstdint>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

/// Range of depths along the optical axis that count as measured, both ends included, metres.
struct DepthRange {
    double min_m = 0.5;
    double max_m = 4.5;
};

enum class DepthFrameFault : std::uint8_t {
    empty,         ///< width or height is 0
    size_differs,  ///< not width * height values
};

/// Values outside `range` become NaN, as does 0 (the camera's own mark for "none").
[[nodiscard]] Result<DepthImage, DepthFrameFault> to_depth_image(const DepthFrame& frame,
                                                                 const DepthRange& range);

}  // namespace octoskin
