// The occupied voxels as coloured cubes for mesh viewers.
#pragma once

#include <string>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// Binary little-endian PLY, metres, map frame: the cubes' outer faces, neighbours in a row merged, coloured
/// by height (dark blue: low, yellow: high) and shaded by side. Equal maps give equal bytes.
[[nodiscard]] std::string encode_ply(const FusedMap& map);

}  // namespace octoskin
