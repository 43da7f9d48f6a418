// A map's occupied, free and unknown voxels as OctoMap's binary octree, of which only changed bricks are
// encoded.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/core/bricks/brick_tree.hpp"

namespace octoskin::bridge {

class BinaryOctree {
  public:
    /// Makes it equal to a map: voxels are occupied from `occupied_from` on. O(bricks written since the tree
    /// of the last call, of which `log_odds` is a changed copy, and the octree's bytes); of another tree, or
    /// with another threshold, O(voxels). Throws std::bad_alloc.
    void update(const BrickTree& log_odds, float occupied_from);
    /// OctoMap's .bt behind its header, pruned on every level: the same bytes as of `encode_bt`. Empty for an
    /// empty map.
    [[nodiscard]] const std::vector<std::int8_t>& data() const noexcept { return data_; }

  private:
    /// A node of .bt: two bits for each child, a NodeState.
    using Children = std::uint16_t;
    static constexpr std::size_t kNodesMax = 1 + 8 + 64;
    struct Brick {
        MortonCode code = 0;
        Children root = 0;
        std::uint8_t count = 0;                   ///< of nodes
        std::array<Children, kNodesMax> nodes{};  ///< its inner nodes, depth first
    };
    [[nodiscard]] static Brick encoded(MortonCode code, const BrickView& view, float occupied_from);
    void merge(std::vector<Brick> changed);
    void write();
    [[nodiscard]] unsigned append(std::size_t& next, unsigned height);
    [[nodiscard]] unsigned append_brick(const Brick& brick);

    BrickTree log_odds_;
    float occupied_from_ = 0.0F;
    std::vector<Brick> bricks_;  ///< by code
    std::vector<std::int8_t> data_;
};

}  // namespace octoskin::bridge
