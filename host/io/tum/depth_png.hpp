// Depth images as 16-bit PNG files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::tum {

struct DepthPng {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint16_t> values;  ///< row-major, as stored in the file: no gamma correction is applied
};

/// Errors contain the fault without the file's name: cannot be opened, not a PNG, cut off or damaged, not
/// grey with 16 bits, over 4096 x 4096. About 4 ms for 640 x 480.
[[nodiscard]] Result<DepthPng, std::string> read_depth_png(const FilePlace& file);

}  // namespace octoskin::tum
