// An octree with dense leaves that are shared until they are written: a copy costs nothing, and what is
// changed after it costs what is changed.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Bricks by the Morton code of their first voxel. Two levels of an octree are one node, with 64 places; a
/// brick whose voxels are alike takes its place and nothing more.
///
/// Copies share all that they have in common, and each may be used by a thread of its own. One of them is not
/// safe for use by two threads at once, unless all of them only read. Of the values in UnknownValue.
template <class Value>
class BrickTreeOf {
    using View = BrickViewOf<Value>;
    using Values = BrickValuesOf<Value>;
    struct Node;
    struct Dense;
    /// Of a node: 0, or the node below. Of a lowest node: 0, a dense brick, or, marked by the lowest bit, in
    /// the upper half the value of all voxels.
    using Place = std::uint64_t;

  public:
    /// What a node and a dense brick take of the heap.
    static constexpr std::size_t kNodeBytes = 544;
    static constexpr std::size_t kBrickBytes = kBrickVoxels * sizeof(Value) + 16;

    BrickTreeOf() noexcept = default;
    /// O(1).
    BrickTreeOf(const BrickTreeOf& other) noexcept;
    BrickTreeOf(BrickTreeOf&& other) noexcept;
    BrickTreeOf& operator=(BrickTreeOf other) noexcept;
    ~BrickTreeOf();

    [[nodiscard]] View find(MortonCode brick) const noexcept;
    /// Nodes that must be made before the brick has a place.
    [[nodiscard]] std::size_t nodes_missing(MortonCode brick) const noexcept;

    /// The brick's values, if they have a place each that is this tree's alone; null if `open` would have
    /// something to do first. They may be written until the tree is copied or the brick given one value;
    /// opening another brick moves none.
    [[nodiscard]] Values* own(MortonCode brick) noexcept;
    /// `own` of bricks that lie together: most cost one step down the tree instead of seven. To be used until
    /// the tree is copied or given a brick.
    class OwnBricks {
      public:
        explicit OwnBricks(BrickTreeOf& tree) noexcept : tree_(&tree) {}
        [[nodiscard]] Values* find(MortonCode brick) noexcept;

      private:
        BrickTreeOf* tree_;
        Node* lowest_ = nullptr;  ///< the node below which `prefix_` is, if it is the tree's alone
        MortonCode prefix_ = 0;
    };
    /// Gives all voxels of a brick one value. Throws std::bad_alloc, and then nothing is changed.
    void set_all(MortonCode brick, Value value);
    /// Makes all voxels of a brick unknown, and takes nothing for it from then on. Throws std::bad_alloc if a
    /// copy holds it, too, and there is no memory for others; then nothing is changed.
    void forget(MortonCode brick);
    /// The brick's values, to be written until this tree is used again; those that were alike are so still.
    /// Throws std::bad_alloc, and then nothing is changed.
    [[nodiscard]] Values& open(MortonCode brick);

    /// What the tree holds in a cube of space, to be followed from the whole octree down to a brick, for as
    /// long as the tree is unchanged.
    class Space {
      public:
        /// If the root's has parts, it is twice as wide as the octree: only the first eight of them are
        /// space.
        [[nodiscard]] const VoxelCube& cube() const noexcept { return cube_; }
        /// It is more than a brick, and not all of it unknown.
        [[nodiscard]] bool has_parts() const noexcept { return cube_.height > kBrickHeight && place_ != 0; }
        /// One of its 64 parts, in Morton order. For space that has parts.
        [[nodiscard]] Space part(std::size_t index) const noexcept;
        /// What all bricks of it hold, of which it has more than one only if they are unknown. For space that
        /// has no parts.
        [[nodiscard]] View bricks() const noexcept;

      private:
        friend class BrickTreeOf;
        Space(Place place, const VoxelCube& cube) noexcept : place_(place), cube_(cube) {}
        Place place_;
        VoxelCube cube_;
    };
    [[nodiscard]] Space space() const noexcept;

    /// Visits each brick that has a known voxel, in Morton order. O(bricks).
    void for_each(const std::function<void(MortonCode brick, const View&)>& visit) const;
    /// Visits, in Morton order, each brick that is another one here than in `before`, known or not; what they
    /// share is passed over, so that it costs what was written since one was the other's copy.
    void for_each_difference(const BrickTreeOf& before,
                             const std::function<void(MortonCode brick)>& visit) const;

    [[nodiscard]] std::size_t nodes() const noexcept { return nodes_; }
    /// Those with a value for each voxel.
    [[nodiscard]] std::size_t dense_bricks() const noexcept { return dense_; }
    /// All that have a place.
    [[nodiscard]] std::size_t bricks() const noexcept { return bricks_; }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return nodes_ * kNodeBytes + dense_ * kBrickBytes;
    }

  private:
    /// A brick's place, in nodes that are this tree's alone. Throws std::bad_alloc: then no node is empty.
    [[nodiscard]] Place& place_of(MortonCode brick);
    [[nodiscard]] static View brick_in(Place place) noexcept;
    void release(Place place, unsigned level) noexcept;
    static void share(Place place, unsigned level) noexcept;

    Node* root_ = nullptr;
    std::size_t nodes_ = 0;
    std::size_t dense_ = 0;
    std::size_t bricks_ = 0;
};

extern template class BrickTreeOf<float>;
extern template class BrickTreeOf<std::uint16_t>;

using BrickTree = BrickTreeOf<float>;

}  // namespace octoskin
