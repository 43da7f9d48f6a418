// How far the rays of rectangles of pixels go.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
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

/// Of squares of pixels, wherever they lie.
struct SquareOfPixels {
    /// By the block that holds the square's first pixel: of a window that holds the square. Null if there is
    /// none.
    const float* longest_m = nullptr;
    float half_px = 0.0F;
};

/// A sparse table (Bender & Farach-Colton, LATIN 2000), two-dimensional: for each power of two a window of so
/// many blocks' edge at every block. A box is covered by windows that overlap, four if it is nearly square,
/// so the answer is that of a box of whole blocks: at most a pixel larger on each side. A pixel without a ray
/// counts as a negative reach. Its memory stays for the next image.
class ReachWindows {
  public:
    static constexpr std::uint32_t kBlock = 2;  ///< pixels along each edge
    static constexpr std::uint32_t kLevels = 5;

    struct Span {
        /// Every ray passes what it is in before this depth, or ends in it; see PlacedImage::passed_m.
        float shortest = std::numeric_limits<float>::infinity();
        float longest = -std::numeric_limits<float>::infinity();
    };
    /// Windows of 2^k blocks' edge, by the block in their first corner; cut off at the image's end.
    struct Level {
        std::vector<float> shortest;
        std::vector<float> longest;
    };

    /// O(pixels); about 0.3 ms for 512 x 424. Throws std::bad_alloc.
    void take(const PlacedImage& image) {
        begin(image);
        take_shortest(image);
        take_longest(image);
    }
    /// The same in parts: after `begin` two threads may each do one of the others.
    void begin(const PlacedImage& image) noexcept;
    void take_shortest(const PlacedImage& image);
    void take_longest(const PlacedImage& image);

    /// O(1) but for boxes larger than 64 pixels, or much longer than wide.
    [[nodiscard]] Span of(const PixelBox& box) const noexcept {
        const std::uint32_t u_last = box.u_last / kBlock;
        const std::uint32_t v_last = box.v_last / kBlock;
        const std::uint32_t u_size = u_last - box.u_first / kBlock + 1;
        const std::uint32_t v_size = v_last - box.v_first / kBlock + 1;
        const std::uint32_t k = std::min(level_of(std::min(u_size, v_size)), kLevels - 1);
        const Level& level = levels_[k];
        const std::uint32_t edge = 1U << k;
        Span span;
        for (std::uint32_t v = box.v_first / kBlock;; v = std::min(v + edge, v_last + 1 - edge)) {
            for (std::uint32_t u = box.u_first / kBlock;; u = std::min(u + edge, u_last + 1 - edge)) {
                const std::size_t at = std::size_t{v} * columns_ + u;
                span.shortest = std::min(span.shortest, level.shortest[at]);
                span.longest = std::max(span.longest, level.longest[at]);
                if (u + edge > u_last) break;
            }
            if (v + edge > v_last) break;
        }
        return span;
    }

    /// That of the largest windows that are no larger than so many blocks.
    [[nodiscard]] static constexpr std::uint32_t level_of(std::uint32_t blocks) noexcept {
        return static_cast<std::uint32_t>(std::bit_width(blocks)) - 1U;
    }
    /// So many pixels to each side of a point; they may be none of the image's.
    [[nodiscard]] SquareOfPixels square(float half_px) const noexcept;
    [[nodiscard]] const Level& level(std::uint32_t k) const noexcept { return levels_[k]; }
    [[nodiscard]] std::uint32_t columns() const noexcept { return columns_; }
    [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }

  private:
    std::uint32_t columns_ = 0;  ///< blocks
    std::uint32_t rows_ = 0;
    std::array<Level, kLevels> levels_;
};

}  // namespace octoskin
