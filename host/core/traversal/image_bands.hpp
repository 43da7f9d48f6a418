// The rows of an image in bands, one for each that works on it at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "host/core/crew/crew.hpp"

namespace octoskin {

/// A vector of any instruction set holds no more entries.
inline constexpr std::size_t kLanesMax = 64;

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

}  // namespace octoskin
