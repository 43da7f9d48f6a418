// A map as the pruned octree that OctoMap would hold: the form in which it goes to files.
#pragma once

#include <cstdint>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// Levels below the root.
inline constexpr unsigned kOctreeDepth = 16;

struct OctreeNode {
    float log_odds = 0.0F;      ///< of an inner node: the largest of its children's
    std::uint8_t children = 0;  ///< bit i: child i exists (x lowest, then y, then z); 0: a leaf
    friend bool operator==(const OctreeNode&, const OctreeNode&) = default;
};

enum class LeafValues : std::uint8_t {
    exact,
    max_likelihood,  ///< the upper clamp for occupied, the lower for free: all that a .bt keeps
};

/// The nodes depth first, each before its children; empty for an empty map. Eight leaves of one value are one
/// leaf of their parent, on every level. Equal maps give equal nodes. O(voxels * depth).
[[nodiscard]] std::vector<OctreeNode> pruned_octree(const FusedMap& map, LeafValues values);

}  // namespace octoskin
