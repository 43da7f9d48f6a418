// The minimum around each place of a raster.
#pragma once

#include <cstdint>
#include <vector>

namespace octoskin {

/// Size of an image, or of its blocks, stored row by row.
struct Raster {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
};

/// Replaces each value by the minimum of the square with `radius` values on each side, cut off at the border.
/// On entry the values are already minima with the radius `had`. `work`: memory to keep. O(values *
/// log(radius / had)).
void spread_minimum(std::vector<float>& values, std::vector<float>& work, const Raster& raster,
                    std::uint32_t had, std::uint32_t radius);

}  // namespace octoskin
