// The depth filter for one row of an image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace octoskin {

/// See DepthFilterConfig. A camera reports whole millimetres. Their differences fit 16 bits, so twice as many
/// pixels are filtered side by side as with floats.
struct FilterWindow {
    static constexpr std::int16_t kGateMaxMm = 2000;
    std::uint32_t side = 0;          ///< pixels: 1, 3, 5 or 7
    std::int16_t gate_mm = 0;        ///< at most kGateMaxMm
    std::int16_t mean_gate_mm2 = 0;  ///< in half millimetres, as medians are; at most 2 * kGateMaxMm
    float min_support = 0.0F;
};

/// A depth as stored in the windows. "No value" is the lowest number, and further below any depth than a
/// gate.
using CodedDepth = std::int16_t;
inline constexpr CodedDepth kNoDepth = std::numeric_limits<CodedDepth>::min();
/// The code of 0 mm, which no pixel has.
[[nodiscard]] constexpr int zero_depth(const FilterWindow& window) {
    return kNoDepth + window.gate_mm;
}
[[nodiscard]] constexpr int depth_max_mm(const FilterWindow& window) {
    return std::numeric_limits<CodedDepth>::max() - zero_depth(window);
}

/// The windows of a row's pixels: the window of the first pixel begins at `corner`, and its next row is
/// `stride` values further. Up to `kFilterLanesMax` values behind the last window of each row may be read.
struct WindowedRow {
    const CodedDepth* corner = nullptr;
    std::size_t stride = 0;
    std::size_t width = 0;  ///< pixels
};

inline constexpr std::size_t kFilterLanesMax = 64;

/// Writes `row.width` depths in metres to `filtered`, NaN for no value. The best instruction set is selected
/// at run time; the result is the same, bit for bit, on every processor. About 2 us for 512 pixels with a
/// window of 5.
void filter_row(const FilterWindow& window, const WindowedRow& row, float* filtered);

}  // namespace octoskin
