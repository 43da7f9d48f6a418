#include "host/core/depth/depth_filter.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace octoskin {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kGatedOut = std::numeric_limits<float>::infinity();  // sorts behind every depth

/// So many neighbouring pixels are filtered side by side: every inner loop runs over them and becomes a few
/// vector instructions.
constexpr std::size_t kLanes = 8;
using Lanes = std::array<float, kLanes>;

/// The comparisons of Batcher's merge exchange (Knuth, The Art of Computer Programming 3, 5.2.2, algorithm
/// M). They sort any `count` values whatever these are, which is what lets lanes sort side by side.
std::vector<std::pair<std::size_t, std::size_t>> sorting_network(std::size_t count) {
    std::vector<std::pair<std::size_t, std::size_t>> exchanges;
    std::size_t top = 1;
    while (2 * top < count) top *= 2;
    for (std::size_t p = top; p > 0 && count > 1; p /= 2) {
        std::size_t distance = p;
        std::size_t phase = 0;
        for (std::size_t q = top; q >= p; q /= 2) {
            for (std::size_t i = 0; i + distance < count; ++i) {
                if ((i & p) == phase) exchanges.emplace_back(i, i + distance);
            }
            distance = q - p;
            phase = p;
        }
    }
    return exchanges;
}

/// The image with a frame of "none" around it, so that a window needs no border case.
struct PaddedImage {
    std::size_t stride = 0;
    std::vector<float> depth_m;

    PaddedImage(const DepthImage& image, std::size_t margin)
        : stride(image.width + 2 * margin + kLanes), depth_m(stride * (image.height + 2 * margin), kNone) {
        for (std::size_t v = 0; v < image.height; ++v) {
            const auto row = image.depth_m.begin() + static_cast<std::ptrdiff_t>(v * image.width);
            std::copy_n(row, image.width,
                        depth_m.begin() + static_cast<std::ptrdiff_t>((v + margin) * stride + margin));
        }
    }
};

class WindowFilter {
  public:
    explicit WindowFilter(const DepthFilterConfig& config)
        : window_(config.window),
          gate_m_(static_cast<float>(config.gate_sigmas * config.sigma_m)),
          mean_gate_m_(static_cast<float>(config.mean_sigmas * config.sigma_m)),
          min_support_(static_cast<float>(config.min_support)),
          exchanges_(sorting_network(window_ * window_)),
          sorted_(window_ * window_) {}

    /// The filtered values of the pixels whose windows begin at corner, corner + 1, ...
    Lanes filter(const float* corner, std::size_t stride) {
        const float* const centre = corner + (window_ / 2) * stride + window_ / 2;
        const Lanes count = gather(corner, stride, centre);
        sort();
        Lanes result;
        const Lanes median = medians(count);
        Lanes offset_sum{};
        Lanes support{};
        for (const Lanes& values : sorted_) {
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const float offset = values[lane] - median[lane];
                const bool is_near = std::fabs(offset) <= mean_gate_m_;
                offset_sum[lane] += is_near ? offset : 0.0F;
                support[lane] += is_near ? 1.0F : 0.0F;
            }
        }
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const bool is_supported = support[lane] > min_support_;
            result[lane] = is_supported ? median[lane] + offset_sum[lane] / support[lane] : kNone;
        }
        return result;
    }

  private:
    /// Fills `sorted_` (not yet sorted) with the values near the centre; returns how many there are.
    Lanes gather(const float* corner, std::size_t stride, const float* centre) {
        Lanes count{};
        for (std::size_t row = 0, index = 0; row < window_; ++row) {
            for (std::size_t column = 0; column < window_; ++column, ++index) {
                const float* const values = corner + row * stride + column;
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    // False if either is a NaN.
                    const bool is_near = std::fabs(values[lane] - centre[lane]) <= gate_m_;
                    sorted_[index][lane] = is_near ? values[lane] : kGatedOut;
                    count[lane] += is_near ? 1.0F : 0.0F;
                }
            }
        }
        return count;
    }

    void sort() {
        for (const auto& [low, high] : exchanges_) {
            Lanes& lower = sorted_[low];
            Lanes& upper = sorted_[high];
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const float left = lower[lane];
                const float right = upper[lane];
                lower[lane] = std::min(left, right);
                upper[lane] = std::max(left, right);
            }
        }
    }

    [[nodiscard]] Lanes medians(const Lanes& count) const {
        Lanes median;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const auto values = static_cast<std::size_t>(count[lane]);
            median[lane] =
                values == 0 ? kNone : 0.5F * (sorted_[(values - 1) / 2][lane] + sorted_[values / 2][lane]);
        }
        return median;
    }

    std::size_t window_;
    float gate_m_;
    float mean_gate_m_;
    float min_support_;
    std::vector<std::pair<std::size_t, std::size_t>> exchanges_;
    std::vector<Lanes> sorted_;
};

}  // namespace

DepthImage filter_depth(const DepthImage& image, const DepthFilterConfig& config) {
    assert(config.window % 2 == 1 && config.window <= 7);
    assert(image.depth_m.size() == std::size_t{image.width} * image.height);
    const PaddedImage padded(image, config.window / 2);
    WindowFilter window(config);
    DepthImage filtered{.width = image.width, .height = image.height, .depth_m = {}};
    filtered.depth_m.resize(image.depth_m.size());
    for (std::size_t v = 0; v < image.height; ++v) {
        for (std::size_t u = 0; u < image.width; u += kLanes) {
            const Lanes values = window.filter(padded.depth_m.data() + v * padded.stride + u, padded.stride);
            std::copy_n(values.begin(), std::min<std::size_t>(kLanes, image.width - u),
                        filtered.depth_m.begin() + static_cast<std::ptrdiff_t>(v * image.width + u));
        }
    }
    return filtered;
}

}  // namespace octoskin
