// Range pyramid (min/max): the shortest and longest reach of the rays in a rectangle of pixels.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/core/traversal/projected_image.hpp"

namespace octoskin {

/// Columns and rows of an image, both ends included.
struct PixelBox {
    std::uint32_t u_first = 0;
    std::uint32_t u_last = 0;
    std::uint32_t v_first = 0;
    std::uint32_t v_last = 0;
};

/// Longest reaches in squares of pixels at any position.
struct SquareOfPixels {
    /// Indexed by the block that contains the square's first pixel: the longest reach in a window that
    /// contains the square. Null if no window is large enough.
    const float* longest_m = nullptr;
    float half_px = 0.0F;
};

/// A two-dimensional sparse table (Bender & Farach-Colton, LATIN 2000). For each power of two, a window with
/// an edge of that many blocks begins at every block. A box is covered by overlapping windows, four if it is
/// nearly square. The result is that of a box of whole blocks, at most a pixel larger on each side. A pixel
/// without a ray has a negative reach. Reuses its memory for the next image.
class RangePyramid {
  public:
    static constexpr std::uint32_t kBlock = 2;  ///< pixels along each edge
    static constexpr std::uint32_t kLevels = 5;

    struct Span {
        /// Before this depth, each ray passes the voxels that it is in, or ends in them; see
        /// ProjectedImage::passed_m.
        float shortest = std::numeric_limits<float>::infinity();
        float longest = -std::numeric_limits<float>::infinity();
    };
    /// Windows with an edge of 2^k blocks, indexed by the block in their first corner; cut off at the image's
    /// border.
    struct Level {
        std::vector<float> shortest;
        std::vector<float> longest;
    };

    /// O(pixels); about 0.3 ms for 512 x 424. Throws std::bad_alloc.
    void take(const ProjectedImage& image) {
        begin(image);
        take_shortest(image);
        take_longest(image);
    }
    /// The same in parts: after `begin`, two threads may each run one of the other two.
    void begin(const ProjectedImage& image) noexcept;
    void take_shortest(const ProjectedImage& image);
    void take_longest(const ProjectedImage& image);

    /// O(1), except for boxes larger than 64 pixels or much longer than wide.
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

    /// Level of the largest windows that are no larger than `blocks`.
    [[nodiscard]] static constexpr std::uint32_t level_of(std::uint32_t blocks) noexcept {
        return static_cast<std::uint32_t>(std::bit_width(blocks)) - 1U;
    }
    /// For squares with `half_px` pixels on each side of a point; the pixels may lie outside the image.
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
