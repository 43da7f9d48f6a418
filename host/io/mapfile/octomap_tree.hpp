// The map as OctoMap's own tree. For repeated use see octomap_mirror.hpp.
#pragma once

#include <octomap/OcTree.h>

#include <memory>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// A pruned copy with the map's threshold and clamps. O(voxels).
[[nodiscard]] std::unique_ptr<octomap::OcTree> to_octomap(const FusedMap& map);

/// Gives a tree a map's threshold and clamps, as exactly as OctoMap's setters permit: they take
/// probabilities.
void set_limits(octomap::OcTree& tree, const MapConfig& config);

}  // namespace octoskin
