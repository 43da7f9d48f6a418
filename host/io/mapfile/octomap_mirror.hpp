// The map as an octomap::OcTree that follows it, for code that asks for one again and again.
#pragma once

#include <octomap/OcTree.h>

#include <cstddef>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// Holds a copy of the map that its tree shows, which costs what any copy does: while the map goes on, each
/// brick that it writes is there twice. To show a map that another thread writes, give update() a copy of it.
/// The tree may be read by several threads, but by none while it is updated.
class OctomapMirror {
  public:
    /// Shows a map with nothing in it.
    explicit OctomapMirror(const MapConfig& config);

    /// Makes the tree what to_octomap(now) would give: the same nodes, pruned, inner ones as likely as their
    /// likeliest child, the same threshold and clamps. `now` may be any map of the same resolution
    /// (asserted), an older one or one that was loaded, too. Returns how many bricks it looked at: all that
    /// were written since the last update; of a map that has nothing in common with the last, all of both.
    /// O(those bricks), and the tree's nodes in which a voxel changed; nodes that are neither changed nor
    /// above a change stay where they are. Throws std::bad_alloc if OctoMap gets no memory: then the tree is
    /// empty, and the next update fills it.
    std::size_t update(const FusedMap& now);

    /// The same object always; the next update may delete any of its nodes.
    [[nodiscard]] const octomap::OcTree& tree() const noexcept { return tree_; }

  private:
    FusedMap shown_;
    octomap::OcTree tree_;
};

}  // namespace octoskin
