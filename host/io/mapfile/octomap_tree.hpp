// The map as OctoMap's own tree, for code that asks for one. The only header here that needs OctoMap.
#pragma once

#include <octomap/OcTree.h>

#include <memory>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// A copy, pruned, with the map's threshold and clamps. O(voxels).
[[nodiscard]] std::unique_ptr<octomap::OcTree> to_octomap(const FusedMap& map);

}  // namespace octoskin
