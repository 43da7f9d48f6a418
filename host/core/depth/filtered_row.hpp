// What the depth filter makes of one row of an image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace octoskin {

/// See DepthFilterConfig. A camera tells whole millimetres: differences of them fit 16 bits, so that twice as
/// many pixels are filtered side by side as with floats.
struct FilterWindow {
    static constexpr std::int16_t kGateMaxMm = 2000;
    std::uint32_t side = 0;          ///< pixels: 1, 3, 5 or 7
    std::int16_t gate_mm = 0;        ///< at most kGateMaxMm
    std::int16_t mean_gate_mm2 = 0;  ///< in half millimetres, as medians are; at most 2 * kGateMaxMm
    float min_support = 0.0F;
};

/// A depth as the windows hold it. None is as low as can be, and further below any other than a gate.
using CodedDepth = std::int16_t;
inline constexpr CodedDepth kNoDepth = std::numeric_limits<CodedDepth>::min();
/// That of 0 mm, which no pixel has.
[[nodiscard]] constexpr int zero_depth(const FilterWindow& window) {
    return kNoDepth + window.gate_mm;
}
[[nodiscard]] constexpr int depth_max_mm(const FilterWindow& window) {
    return std::numeric_limits<CodedDepth>::max() - zero_depth(window);
}

/// Where the windows of a row's pixels are: the first pixel's begins at `corner`, its next row is `stride`
/// values further. Beyond the last window `kFilterLanesMax` more values of each of its rows may be read.
struct WindowedRow {
    const CodedDepth* corner = nullptr;
    std::size_t stride = 0;
    std::size_t width = 0;  ///< pixels
};

inline constexpr std::size_t kFilterLanesMax = 64;

/// Writes `row.width` depths in metres to `filtered`, NaN for none. Bit for bit the same on every processor:
/// the best of its instruction sets is chosen at run time. About 2 us for 512 pixels with a window of 5.
void filter_row(const FilterWindow& window, const WindowedRow& row, float* filtered);

}  // namespace octoskin
