#include "host/core/traversal/sliding_minimum.hpp"

#include <algorithm>
#include <cstddef>

namespace octoskin {
namespace {

/// The minimum of each value and the values `by` to its left and right; at the border, of the existing ones.
void spread_along_row(const float* in, float* out, std::uint32_t width, std::uint32_t by) {
    const std::uint32_t edge = std::min(by, width);
    for (std::uint32_t u = 0; u < edge; ++u)
        out[u] = std::min({in[0], in[u], in[std::min(u + by, width - 1)]});
    for (std::uint32_t u = edge; u + by < width; ++u)
        out[u] = std::min(in[u], std::min(in[u - by], in[u + by]));
    for (std::uint32_t u = std::max(edge, width - edge); u < width; ++u) {
        out[u] = std::min({in[u - by], in[u], in[width - 1]});
    }
}

}  // namespace

void spread_minimum(std::vector<float>& values, std::vector<float>& work, const Raster& raster,
                    std::uint32_t had, std::uint32_t radius) {
    work.resize(values.size());
    while (had < radius) {
        const std::uint32_t by = std::min(radius - had, 2 * had + 1);
        for (std::uint32_t v = 0; v < raster.height; ++v) {
            const std::size_t row = std::size_t{v} * raster.width;
            spread_along_row(values.data() + row, work.data() + row, raster.width, by);
        }
        for (std::uint32_t v = 0; v < raster.height; ++v) {
            const float* const above = work.data() + std::size_t{v < by ? 0 : v - by} * raster.width;
            const float* const here = work.data() + std::size_t{v} * raster.width;
            const float* const below =
                work.data() + std::size_t{std::min(v + by, raster.height - 1)} * raster.width;
            float* const out = values.data() + std::size_t{v} * raster.width;
            for (std::uint32_t u = 0; u < raster.width; ++u) {
                out[u] = std::min(here[u], std::min(above[u], below[u]));
            }
        }
        had += by;
    }
}

}  // namespace octoskin
