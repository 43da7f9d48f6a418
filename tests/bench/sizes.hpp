// How large a map is, OctoMap's or ours, for a row's figures.
#pragma once

#include <octomap/octomap.h>

#include "host/core/mapping/fused_map.hpp"
#include "host/io/mapfile/octree.hpp"
#include "tests/bench/figures.hpp"

namespace octoskin::bench {

/// Known voxels are those of the finest level: a pruned leaf counts as often as it is large.
inline void tell_size(const octomap::OcTree& tree, Figures& figures) {
    figures.heap_bytes = tree.memoryUsage();
    figures.leaves = tree.getNumLeafNodes();
    for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
        figures.voxels += std::size_t{1} << (3 * (tree.getTreeDepth() - leaf.getDepth()));
    }
}

/// Leaves are those that a pruned octree of the map has.
inline void tell_size(const FusedMap& map, Figures& figures) {
    figures.heap_bytes = map.heap_bytes();
    figures.voxels = map.known_voxels();
    PrunedOctree(map, LeafValues::exact).for_each([&](std::span<const OctreeNode> nodes) {
        for (const OctreeNode& node : nodes) figures.leaves += node.state == NodeState::inner ? 0 : 1;
        return true;
    });
}

}  // namespace octoskin::bench
