#include "host/core/traversal/range_pyramid.hpp"

namespace octoskin {
namespace {

struct Less {
    float operator()(float a, float b) const noexcept { return b < a ? b : a; }
};
struct More {
    float operator()(float a, float b) const noexcept { return b > a ? b : a; }
};

/// Reduces each block of pixels to one value. `row` is working memory.
template <class Choose>
void take_blocks(const float* pixels, std::uint32_t width, std::uint32_t height, std::vector<float>& row,
                 std::vector<float>& blocks, Choose choose) {
    constexpr std::uint32_t kBlock = RangePyramid::kBlock;
    const std::uint32_t columns = (width + kBlock - 1) / kBlock;
    // If the last block is only half as wide, its column is used twice.
    row.resize(std::size_t{columns} * kBlock);
    blocks.resize(std::size_t{columns} * ((height + kBlock - 1) / kBlock));
    float* out = blocks.data();
    for (std::uint32_t v = 0; v < height; v += kBlock, out += columns) {
        const float* const above = pixels + std::size_t{v} * width;
        const float* const below = v + 1 < height ? above + width : above;
        float* const both = row.data();
        for (std::uint32_t u = 0; u < width; ++u) both[u] = choose(above[u], below[u]);
        row.back() = width % kBlock == 0 ? row.back() : row[width - 1];
        for (std::uint32_t u = 0; u < columns; ++u) out[u] = choose(both[kBlock * u], both[kBlock * u + 1]);
    }
}

/// Builds windows with twice the edge `by`.
template <class Choose>
void widen(const std::vector<float>& in, std::uint32_t columns, std::uint32_t rows, std::uint32_t by,
           std::vector<float>& row, std::vector<float>& out, Choose choose) {
    out.resize(in.size());
    row.resize(columns);
    const std::uint32_t whole = columns > by ? columns - by : 0;
    for (std::uint32_t v = 0; v < rows; ++v) {
        const float* const above = in.data() + std::size_t{v} * columns;
        const float* const below = v + by < rows ? above + std::size_t{by} * columns : above;
        float* const both = row.data();
        float* const to = out.data() + std::size_t{v} * columns;
        for (std::uint32_t u = 0; u < columns; ++u) both[u] = choose(above[u], below[u]);
        for (std::uint32_t u = 0; u < whole; ++u) to[u] = choose(both[u], both[u + by]);
        for (std::uint32_t u = whole; u < columns; ++u) to[u] = both[u];
    }
}

}  // namespace

void RangePyramid::begin(const ProjectedImage& image) noexcept {
    columns_ = (image.width + kBlock - 1) / kBlock;
    rows_ = (image.height + kBlock - 1) / kBlock;
}

SquareOfPixels RangePyramid::square(float half_px) const noexcept {
    static_assert(kBlock == 2);
    // The number of blocks that the square may touch.
    const float blocks = half_px + 2.0F;
    for (std::uint32_t k = 0; k < kLevels; ++k) {
        if (blocks < static_cast<float>((1U << k) + 1)) return {levels_[k].longest.data(), half_px};
    }
    return {};
}

void RangePyramid::take_shortest(const ProjectedImage& image) {
    std::vector<float> row;
    take_blocks(image.passed_m.data(), image.width, image.height, row, levels_[0].shortest, Less());
    for (std::uint32_t k = 1; k < kLevels; ++k)
        widen(levels_[k - 1].shortest, columns_, rows_, 1U << (k - 1), row, levels_[k].shortest, Less());
}

void RangePyramid::take_longest(const ProjectedImage& image) {
    std::vector<float> row;
    take_blocks(image.reach_m.data(), image.width, image.height, row, levels_[0].longest, More());
    for (std::uint32_t k = 1; k < kLevels; ++k)
        widen(levels_[k - 1].longest, columns_, rows_, 1U << (k - 1), row, levels_[k].longest, More());
}

}  // namespace octoskin
