// An octree with dense leaves that are shared until they are written: a copy costs nothing, and what is
// changed after it costs what is changed.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "host/core/bricks/brick.hpp"

namespace octoskin {

/// Bricks by the Morton code of their first voxel. Two levels of an octree are one node, with 64 places; a
/// brick whose voxels are alike takes its place and nothing more.
///
/// Copies share all that they have in common, and each may be used by a thread of its own. One of them is not
/// safe for use by two threads at once, unless all of them only read.
class BrickTree {
    struct Node;
    struct Dense;

  public:
    /// What a node and a dense brick take of the heap.
    static constexpr std::size_t kNodeBytes = 528;
    static constexpr std::size_t kBrickBytes = 2064;

    BrickTree() noexcept = default;
    /// O(1).
    BrickTree(const BrickTree& other) noexcept;
    BrickTree(BrickTree&& other) noexcept;
    BrickTree& operator=(BrickTree other) noexcept;
    ~BrickTree();

    [[nodiscard]] BrickView find(MortonCode brick) const noexcept;
    /// Nodes that must be made before the brick has a place.
    [[nodiscard]] std::size_t nodes_missing(MortonCode brick) const noexcept;

    /// The brick's values, if they have a place each that is this tree's alone; null if `open` would have
    /// something to do first. They may be written until the tree is copied or the brick given one value;
    /// opening another brick moves none.
    [[nodiscard]] BrickValues* own(MortonCode brick) noexcept;
    /// `own` of bricks that lie together: most cost one step down the tree instead of seven. To be used until
    /// the tree is copied or given a brick.
    class OwnBricks {
      public:
        explicit OwnBricks(BrickTree& tree) noexcept : tree_(&tree) {}
        [[nodiscard]] BrickValues* find(MortonCode brick) noexcept;

      private:
        BrickTree* tree_;
        const Node* lowest_ = nullptr;  ///< the node below which `prefix_` is, if it is the tree's alone
        MortonCode prefix_ = 0;
    };
    /// Gives all voxels of a brick one value. Throws std::bad_alloc, and then nothing is changed.
    void set_all(MortonCode brick, float value);
    /// The brick's values, to be written until this tree is used again; those that were alike are so still.
    /// Throws std::bad_alloc, and then nothing is changed.
    [[nodiscard]] BrickValues& open(MortonCode brick);

    /// Visits each brick that has a known voxel, in Morton order. O(bricks).
    void for_each(const std::function<void(MortonCode brick, const BrickView&)>& visit) const;
    /// Visits, in Morton order, each brick that is another one here than in `before`, known or not; what they
    /// share is passed over, so that it costs what was written since one was the other's copy.
    void for_each_difference(const BrickTree& before,
                             const std::function<void(MortonCode brick)>& visit) const;

    [[nodiscard]] std::size_t nodes() const noexcept { return nodes_; }
    /// Those with a value for each voxel.
    [[nodiscard]] std::size_t dense_bricks() const noexcept { return dense_; }
    /// All that were ever given a value.
    [[nodiscard]] std::size_t bricks() const noexcept { return bricks_; }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return nodes_ * kNodeBytes + dense_ * kBrickBytes;
    }

  private:
    /// Of a node: 0, or the node below. Of a lowest node: 0, a dense brick, or, marked by the lowest bit, in
    /// the upper half the value of all voxels.
    using Place = std::uint64_t;

    /// A brick's place, in nodes that are this tree's alone. Throws std::bad_alloc: then no node is empty.
    [[nodiscard]] Place& place_of(MortonCode brick);
    void release(Place place, unsigned level) noexcept;
    static void share(Place place, unsigned level) noexcept;

    Node* root_ = nullptr;
    std::size_t nodes_ = 0;
    std::size_t dense_ = 0;
    std::size_t bricks_ = 0;
};

}  // namespace octoskin
