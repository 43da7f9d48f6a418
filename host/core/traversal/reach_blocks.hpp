// How far the rays of rectangles of pixels go.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/core/traversal/placed_image.hpp"

namespace octoskin {

/// Columns and rows of an image, both ends inside.
struct PixelBox {
    std::uint32_t u_first = 0;
    std::uint32_t u_last = 0;
    std::uint32_t v_first = 0;
    std::uint32_t v_last = 0;
};

/// Kept by blocks of pixels: the answer is that of a box of whole blocks, a little larger than what was
/// asked.
class ReachBlocks {
  public:
    struct Span {
        /// Every ray passes what it is in before this depth, or ends in it; see PlacedImage::passed_m.
        float shortest = std::numeric_limits<float>::infinity();
        float longest = -std::numeric_limits<float>::infinity();
        void include(const Span& other) noexcept {
            shortest = std::min(shortest, other.shortest);
            longest = std::max(longest, other.longest);
        }
    };

    /// A pixel without a ray counts as a negative reach.
    explicit ReachBlocks(const PlacedImage& image)
        : columns_((image.width + kBlock - 1) / kBlock),
          blocks_(std::size_t{columns_} * ((image.height + kBlock - 1) / kBlock)) {
        for (std::uint32_t v = 0; v < image.height; ++v) {
            const float* const row = image.reach_m.data() + std::size_t{v} * image.width;
            const float* const passed = image.passed_m.data() + std::size_t{v} * image.width;
            Span* const out = blocks_.data() + std::size_t{v / kBlock} * columns_;
            for (std::uint32_t u = 0; u < image.width; ++u) out[u / kBlock].include({passed[u], row[u]});
        }
    }

    [[nodiscard]] Span of(const PixelBox& box) const noexcept {
        Span span;
        for (std::uint32_t v = box.v_first / kBlock; v <= box.v_last / kBlock; ++v) {
            for (std::uint32_t u = box.u_first / kBlock; u <= box.u_last / kBlock; ++u) {
                span.include(blocks_[std::size_t{v} * columns_ + u]);
            }
        }
        return span;
    }

  private:
    static constexpr std::uint32_t kBlock = 8;
    std::uint32_t columns_;
    std::vector<Span> blocks_;
};

}  // namespace octoskin
