#include "host/core/cross_check/certain_pixels.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octoskin {
namespace {

constexpr double kDifferSigmas = 4.0;
/// A smaller depth step is not visible in the noise that the filter leaves.
constexpr double kStepMaxM = 0.1;
/// A second difference has sqrt(6) times the noise of one value; this is 4.5 of those.
constexpr double kStepSigmas = 11.0;
/// Pixels from the middle of a second difference to its ends.
constexpr std::size_t kReachPx = 1;

std::size_t pixels(double rad, const CameraIntrinsics& camera) {
    return static_cast<std::size_t>(std::lround(rad * std::max(camera.fx, camera.fy)));
}

}  // namespace

CertainPixels::CertainPixels(const CameraIntrinsics& camera, const CertaintyConfig& config)
    : width_(camera.width),
      height_(camera.height),
      surface_margin_px_(pixels(config.surface_margin_rad, camera)),
      clear_margin_px_(pixels(config.clear_margin_rad, camera)),
      differ_max_m_(static_cast<float>(kDifferSigmas * config.camera_sigma_m)),
      step_max_m_(static_cast<float>(
          config.is_filtered ? kStepMaxM : std::max(kStepMaxM, kStepSigmas * config.camera_sigma_m))) {}

void CertainPixels::find(const DepthImage& raw, const DepthImage& filtered,
                         std::vector<Certainty>& certainty) {
    assert(raw.depth_m.size() == width_ * height_ && filtered.depth_m.size() == width_ * height_);
    doubt_values(raw, filtered);
    doubt_edges(filtered);
    certainty.assign(width_ * height_, Certainty::none);
    raise(certainty, surface_margin_px_, Certainty::surface);
    raise(certainty, clear_margin_px_, Certainty::clear);
}

void CertainPixels::doubt_values(const DepthImage& raw, const DepthImage& filtered) {
    is_doubtful_.resize(width_ * height_);
    inverse_depth_.resize(width_ * height_);
    for (std::size_t i = 0; i < is_doubtful_.size(); ++i) {
        const float depth_m = filtered.depth_m[i];
        // False for a NaN, too.
        const bool agrees = std::abs(raw.depth_m[i] - depth_m) <= differ_max_m_;
        is_doubtful_[i] = agrees ? 0 : 1;
        inverse_depth_[i] = 1.0F / depth_m;
    }
}

void CertainPixels::doubt_edges(const DepthImage& filtered) {
    const auto bends = [&](std::size_t i, std::size_t step) {
        const float middle = inverse_depth_[i];
        const float bend = inverse_depth_[i - step] + inverse_depth_[i + step] - 2.0F * middle;
        const float depth_m = filtered.depth_m[i];
        // pixels without a value are doubtful anyway
        return std::abs(bend) * depth_m * depth_m > step_max_m_;
    };
    for (std::size_t v = kReachPx; v + kReachPx < height_; ++v) {
        for (std::size_t u = kReachPx; u + kReachPx < width_; ++u) {
            const std::size_t i = v * width_ + u;
            const bool is_edge = bends(i, kReachPx) || bends(i, kReachPx * width_);
            is_doubtful_[i] = static_cast<std::uint8_t>(is_doubtful_[i] | (is_edge ? 1 : 0));
        }
    }
}

/// Uses a window of (2 margin + 1) squared, by rows and then by columns; beyond the border, all is doubtful.
void CertainPixels::raise(std::vector<Certainty>& certainty, std::size_t margin_px, Certainty to) {
    in_row_.resize(width_ * height_);
    for (std::size_t v = 0; v < height_; ++v) {
        const std::uint8_t* const row = is_doubtful_.data() + v * width_;
        std::size_t count = 0;
        for (std::size_t u = 0; u < std::min(margin_px, width_); ++u) count += row[u];
        for (std::size_t u = 0; u < width_; ++u) {
            const bool is_at_border = u < margin_px || u + margin_px >= width_;
            if (u + margin_px < width_) count += row[u + margin_px];
            in_row_[v * width_ + u] = is_at_border || count > 0 ? 1 : 0;
            if (u >= margin_px) count -= row[u - margin_px];
        }
    }
    above_.assign(width_, 0);
    const auto add = [&](std::size_t v, int sign) {
        const std::uint8_t* const row = in_row_.data() + v * width_;
        for (std::size_t u = 0; u < width_; ++u)
            above_[u] = static_cast<std::uint16_t>(above_[u] + sign * row[u]);
    };
    for (std::size_t v = 0; v < std::min(margin_px, height_); ++v) add(v, 1);
    for (std::size_t v = 0; v < height_; ++v) {
        if (v + margin_px < height_) add(v + margin_px, 1);
        if (v >= margin_px && v + margin_px < height_) {
            for (std::size_t u = 0; u < width_; ++u)
                if (above_[u] == 0) certainty[v * width_ + u] = to;
        }
        if (v >= margin_px) add(v - margin_px, -1);
    }
}

}  // namespace octoskin
