// A map as the pruned octree that OctoMap would hold: the form in which it goes to files.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// Levels below the root.
inline constexpr unsigned kOctreeDepth = 16;

/// What an octree has in a place, numbered as in a .bt.
enum class NodeState : std::uint8_t { none, free_leaf, occupied_leaf, inner };

struct OctreeNode {
    float log_odds = 0.0F;       ///< of an inner node: the largest of its children's
    std::uint16_t children = 0;  ///< bits 2 i and 2 i + 1: child i's state (x lowest, then y, then z)
    NodeState state = NodeState::none;
    friend bool operator==(const OctreeNode&, const OctreeNode&) = default;
};

enum class LeafValues : std::uint8_t {
    exact,
    max_likelihood,  ///< the upper clamp for occupied, the lower for free: all that a .bt keeps
};

/// Eight leaves of one value are one leaf of their parent, on every level. Equal maps give equal nodes.
/// The levels below a brick of the map are worked out whenever they are asked for, so that it takes memory
/// for each brick (30 bytes if bricks come together, 170 for one that is alone), and none for each voxel.
class PrunedOctree {
  public:
    /// The map must stay as it is for as long as this is used. O(voxels).
    PrunedOctree(const FusedMap& map, LeafValues values);

    /// How many nodes there are; 0 for an empty map.
    [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
    /// Hands out the nodes depth first, each before its children, some thousand at a time, until `put` says
    /// false; the answer is the last of `put`. O(voxels).
    bool for_each(const std::function<bool(std::span<const OctreeNode> nodes)>& put) const;

  private:
    /// A node above the bricks, or a brick's uppermost.
    struct UpperNode {
        OctreeNode node;
        std::uint32_t brick = 0;  ///< which one, if the node is an inner one of a brick
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
