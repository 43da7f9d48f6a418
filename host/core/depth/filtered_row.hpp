// What the depth filter makes of one row of an image.
#pragma once

#include <cstddef>
#include <cstdint>

namespace octoskin {

/// See DepthFilterConfig.
struct FilterWindow {
    std::uint32_t side = 0;  ///< pixels: 1, 3, 5 or 7
    float gate_m = 0.0F;
    float mean_gate_m = 0.0F;
    float min_support = 0.0F;
};

/// Where the windows of a row's pixels are: the first pixel's begins at `corner`, its next row is `stride`
/// values further. NaN is no value. Beyond the last window `kFilterLanesMax` more values of each of its rows
/// may be read.
struct WindowedRow {
    const float* corner = nullptr;
    std::size_t stride = 0;
    std::size_t width = 0;  ///< pixels
};

inline constexpr std::size_t kFilterLanesMax = 64;

/// Writes `row.width` values to `filtered`, which must lie apart from what is read. Bit for bit the same on
/// every processor: the best of its instruction sets is chosen at run time. About 4 us for 512 pixels with a
/// window of 5.
void filter_row(const FilterWindow& window, const WindowedRow& row, float* filtered);

}  // namespace octoskin
