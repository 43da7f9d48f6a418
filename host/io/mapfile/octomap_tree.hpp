// The map as OctoMap's own tree, for code that asks for one. Again and again: octomap_mirror.hpp.
#pragma once

#include <octomap/OcTree.h>

#include <memory>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// A copy, pruned, with the map's threshold and clamps. O(voxels).
[[nodiscard]] std::unique_ptr<octomap::OcTree> to_octomap(const FusedMap& map);

/// Gives a tree a map's threshold and clamps, as near as OctoMap's setters come: they take probabilities.
void set_limits(octomap::OcTree& tree, const MapConfig& config);

}  // namespace octoskin
