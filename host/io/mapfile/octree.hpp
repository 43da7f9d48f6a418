// A map as the pruned octree of OctoMap, the form in which it is saved to files.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// Levels below the root.
inline constexpr unsigned kOctreeDepth = 16;

/// The content of a place in an octree, numbered as in a .bt.
enum class NodeState : std::uint8_t { none, free_leaf, occupied_leaf, inner };

struct OctreeNode {
    float log_odds = 0.0F;       ///< for an inner node: the maximum of its children
    std::uint16_t children = 0;  ///< bits 2 i and 2 i + 1: child i's state (x lowest, then y, then z)
    NodeState state = NodeState::none;
    friend bool operator==(const OctreeNode&, const OctreeNode&) = default;
};

enum class LeafValues : std::uint8_t {
    exact,
    max_likelihood,  ///< the upper clamp for occupied, the lower one for free: all that a .bt stores
};

/// Eight equal leaves are replaced by one leaf of their parent, on every level. Equal maps give equal nodes.
/// The levels below a brick of the map are computed whenever they are needed. Memory: 30 bytes for a brick
/// among others, 170 for an isolated one; none for each voxel.
class PrunedOctree {
  public:
    /// The map must not change while this object is used. O(voxels).
    PrunedOctree(const FusedMap& map, LeafValues values);

    /// The number of nodes; 0 for an empty map.
    [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
    /// Passes on the nodes depth first, each before its children, some thousand at a time, until `put`
    /// returns false. Returns the last result of `put`. O(voxels).
    bool for_each(const std::function<bool(std::span<const OctreeNode> nodes)>& put) const;

  private:
    /// A node above the bricks, or the root of a brick.
    struct UpperNode {
        OctreeNode node;
        std::uint32_t brick = 0;  ///< which brick, if the node is an inner node of one
    };
    static constexpr std::uint32_t kNoBrick = 0xFFFF'FFFF;

    [[nodiscard]] OctreeNode append(std::size_t begin, std::size_t end, unsigned height);
    void append_brick(std::size_t at);

    MapConfig config_;
    LeafValues values_;
    std::vector<MapBrick> bricks_;
    std::vector<UpperNode> upper_;  ///< depth first
    std::uint64_t size_ = 0;
};

}  // namespace octoskin
