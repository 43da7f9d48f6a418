// The rows of an image in bands, one for each that works on it at a time.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/crew/crew.hpp"
#include "host/core/traversal/placed_image.hpp"

namespace octoskin {

/// A vector of any instruction set holds no more entries.
inline constexpr std::size_t kLanesMax = 64;

/// What placed rows add up to. In a cache line of its own: each band's are written with every vector of
/// pixels.
struct alignas(64) RowSums {
    DepthPixelCounts counts;
    Eigen::Vector3f lowest;  ///< of all ends
    Eigen::Vector3f highest;
    void bound(const Eigen::Vector3f& end) {
        lowest = lowest.cwiseMin(end);
        highest = highest.cwiseMax(end);
    }
};

struct ImageBands {
    std::uint32_t rows = 0;  ///< of each but the last
    std::uint32_t count = 0;
};

/// What is written beyond the end of a row that is no multiple of a vector the next row overwrites: one has
/// to do all of them.
[[nodiscard]] constexpr ImageBands bands_of(std::uint32_t width, std::uint32_t height) noexcept {
    constexpr std::uint32_t kBandRows = 32;
    const std::uint32_t rows = width % kLanesMax == 0 ? kBandRows : std::max(height, 1U);
    return {rows, (height + rows - 1) / rows};
}

/// Calls work(band, first row, row behind the last) for each, by `crew`, if there is one.
template <class Work>
void for_each_band(const ImageBands& bands, std::uint32_t height, Crew* crew, Work&& work) {
    Crew alone(1);
    (crew == nullptr ? alone : *crew).work(bands.count, [&](std::size_t band) {
        const auto begin = static_cast<std::uint32_t>(band) * bands.rows;
        work(band, begin, std::min(begin + bands.rows, height));
    });
}

/// Takes the sums of each band; `placed.origin` is bounded, too.
inline void take_sums(const std::vector<RowSums>& bands, PlacedImage& placed) {
    RowSums all{{}, placed.origin, placed.origin};
    for (const RowSums& band : bands) {
        all.counts += band.counts;
        all.bound(band.lowest);
        all.bound(band.highest);
    }
    placed.counts = all.counts;
    placed.lowest = all.lowest;
    placed.highest = all.highest;
}

}  // namespace octoskin
