// An octomap::OcTree that is kept up to date with a map, for code that needs one repeatedly.
#pragma once

#include <octomap/OcTree.h>

#include <cstddef>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// Holds a copy of the map that its tree shows. The copy costs what any copy costs: each brick that the map
/// then changes exists twice. For a map that another thread writes, give update() a copy. Several threads may
/// read the tree, but not during an update.
class OctomapMirror {
  public:
    /// Begins with an empty map.
    explicit OctomapMirror(const MapConfig& config);

    /// Makes the tree equal to to_octomap(now): the same pruned nodes, inner nodes with the maximum of their
    /// children, the same threshold and clamps. `now` may be any map of the same resolution (asserted), also
    /// an older or a loaded one.
    /// Returns the number of examined bricks: all that were written since the last update; for an unrelated
    /// map, all bricks of both. O(those bricks, and the tree's nodes with a changed voxel); nodes that
    /// neither change nor are above a change stay at their address.
    /// Throws std::bad_alloc if OctoMap gets no memory: then the tree is empty, and the next update fills it.
    std::size_t update(const FusedMap& now);

    /// Always the same object; the next update may delete any of its nodes.
    [[nodiscard]] const octomap::OcTree& tree() const noexcept { return tree_; }

  private:
    FusedMap shown_;
    octomap::OcTree tree_;
};

}  // namespace octoskin
