// Divides the rows of an image into bands that are processed in parallel.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/parallel/thread_pool.hpp"
#include "host/core/traversal/projected_image.hpp"

namespace octoskin {

/// Upper limit of the lanes of any instruction set.
inline constexpr std::size_t kLanesMax = 64;

/// Sums over the projected rows of a band. Each has its own cache line, because it is written with every
/// vector of pixels.
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
    std::uint32_t rows = 0;  ///< of all bands but the last
    std::uint32_t count = 0;
};

/// If the width is not a multiple of a vector, writes reach beyond the end of a row, and the next row
/// overwrites that part. One band must then contain all rows.
[[nodiscard]] constexpr ImageBands bands_of(std::uint32_t width, std::uint32_t height) noexcept {
    constexpr std::uint32_t kBandRows = 32;
    const std::uint32_t rows = width % kLanesMax == 0 ? kBandRows : std::max(height, 1U);
    return {rows, (height + rows - 1) / rows};
}

/// Calls work(band, first row, row behind the last) for each band, on the thread pool `pool` if there is one.
template <class Work>
void for_each_band(const ImageBands& bands, std::uint32_t height, ThreadPool* pool, Work&& work) {
    ThreadPool alone(1);
    (pool == nullptr ? alone : *pool).work(bands.count, [&](std::size_t band) {
        const auto begin = static_cast<std::uint32_t>(band) * bands.rows;
        work(band, begin, std::min(begin + bands.rows, height));
    });
}

/// Combines the sums of all bands; the bounds also include `placed.origin`.
inline void take_sums(const std::vector<RowSums>& bands, ProjectedImage& placed) {
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
