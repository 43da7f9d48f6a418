#include "host/core/depth/pixel_rays.hpp"

#include <algorithm>
#include <limits>

namespace octoskin {

PixelRays::PixelRays(const CameraIntrinsics& camera) : camera_(camera) {
    columns_.reserve(camera.width);
    rows_.reserve(camera.height);
    for (std::uint32_t u = 0; u < camera.width; ++u) {
        const double x = picture_of(camera, u, 0).x;
        columns_.push_back({x, x});
    }
    for (std::uint32_t v = 0; v < camera.height; ++v) {
        const double y = picture_of(camera, 0, v).y;
        rows_.push_back({y, y});
    }
    if (!camera.lens.is_none()) take_lens_out();
}

void PixelRays::take_lens_out() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::fill(columns_.begin(), columns_.end(), Extent{kInfinity, -kInfinity});
    std::fill(rows_.begin(), rows_.end(), Extent{kInfinity, -kInfinity});
    rays_.reserve(std::size_t{camera_.width} * camera_.height);
    for_each_pixel_ray(camera_, [&](std::uint32_t u, std::uint32_t v, const RaySlope& ray) {
        rays_.push_back(ray);
        columns_[u] = {std::min(columns_[u].low, ray.x), std::max(columns_[u].high, ray.x)};
        rows_[v] = {std::min(rows_[v].low, ray.y), std::max(rows_[v].high, ray.y)};
    });
}

PixelSpan PixelRays::span_of(const std::vector<Extent>& extents, double low, double high) noexcept {
    PixelSpan span;
    for (std::uint32_t i = 0; i < extents.size(); ++i) {
        if (!(extents[i].high >= low && extents[i].low <= high)) continue;
        if (span.end == 0) span.begin = i;
        span.end = i + 1;
    }
    return span;
}

PixelSpan PixelRays::columns(double low, double high) const noexcept {
    return span_of(columns_, low, high);
}

PixelSpan PixelRays::rows(double low, double high) const noexcept {
    return span_of(rows_, low, high);
}

}  // namespace octoskin
