#include "host/core/depth/depth_image.hpp"

#include <limits>

namespace octoskin {

Result<DepthImage, DepthFrameFault> to_depth_image(const DepthFrame& frame, const DepthRange& range) {
    if (frame.width == 0 || frame.height == 0) return unexpected(DepthFrameFault::empty);
    if (frame.depth_mm.size() != std::size_t{frame.width} * frame.height) {
        return unexpected(DepthFrameFault::size_differs);
    }
    DepthImage image{.width = frame.width, .height = frame.height, .depth_m = {}};
    image.depth_m.reserve(frame.depth_mm.size());
    for (const std::uint16_t depth_mm : frame.depth_mm) {
        const double depth_m = depth_mm / 1000.0;
        const bool is_measured = depth_mm != 0 && depth_m >= range.min_m && depth_m <= range.max_m;
        image.depth_m.push_back(is_measured ? static_cast<float>(depth_m)
                                            : std::numeric_limits<float>::quiet_NaN());
    }
    return image;
}

}  // namespace octoskin
