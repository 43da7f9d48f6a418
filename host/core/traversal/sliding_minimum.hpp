// The least value around each place of a raster.
#pragma once

#include <cstdint>
#include <vector>

namespace octoskin {

/// Values of an image, or of its blocks, row by row.
struct Raster {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
};

/// Each value becomes the least of the square `radius` to each side of it, at the edge of what is there of
/// it; it is already that of `had`. `work`: memory to keep. O(values * log(radius / had)).
void spread_minimum(std::vector<float>& values, std::vector<float>& work, const Raster& raster,
                    std::uint32_t had, std::uint32_t radius);

}  // namespace octoskin
