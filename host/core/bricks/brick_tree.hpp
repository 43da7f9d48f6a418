// An octree with dense leaves that copies share until they are written. A copy is O(1); later changes cost
// only the changed parts.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Maps the Morton code of a brick's first voxel to the brick. One node covers two levels of an octree and
/// has 64 places. A brick whose voxels all have the same value takes no memory beyond its place.
///
/// Copies share all common parts, and each copy may be used by its own thread. Two threads must not use the
/// same tree, unless both only read. `Value`: a type of UnknownValue.
template <class Value>
class BrickTreeOf {
    using View = BrickViewOf<Value>;
    using Values = BrickValuesOf<Value>;
    struct Node;
    struct Dense;
    /// In a node above the lowest level: 0, or the node below. In a lowest node: 0, a dense brick, or a value
    /// of all voxels in the upper half, marked by the lowest bit.
    using Place = std::uint64_t;

  public:
    /// Heap memory of a node and of a dense brick.
    static constexpr std::size_t kNodeBytes = 544;
    static constexpr std::size_t kBrickBytes = kBrickVoxels * sizeof(Value) + 16;

    BrickTreeOf() noexcept = default;
    /// O(1).
    BrickTreeOf(const BrickTreeOf& other) noexcept;
    BrickTreeOf(BrickTreeOf&& other) noexcept;
    BrickTreeOf& operator=(BrickTreeOf other) noexcept;
    ~BrickTreeOf();

    [[nodiscard]] View find(MortonCode brick) const noexcept;
    /// Number of nodes that must be allocated before the brick has a place.
    [[nodiscard]] std::size_t nodes_missing(MortonCode brick) const noexcept;

    /// The brick's values if it is dense and belongs to this tree alone; null if `open` must allocate or copy
    /// first. The values may be written until the tree is copied or the brick is given one value. Opening
    /// another brick does not move them.
    [[nodiscard]] Values* own(MortonCode brick) noexcept;
    /// `own` for neighbouring bricks: most calls take one step down the tree instead of seven. Valid until
    /// the tree is copied or receives a brick.
    class OwnBricks {
      public:
        explicit OwnBricks(BrickTreeOf& tree) noexcept : tree_(&tree) {}
        [[nodiscard]] Values* find(MortonCode brick) noexcept;

      private:
        BrickTreeOf* tree_;
        Node* lowest_ = nullptr;  ///< the lowest node of `prefix_`, if this tree alone owns it
        MortonCode prefix_ = 0;
    };
    /// Assigns one value to all voxels of a brick. Throws std::bad_alloc; the tree is then unchanged.
    void set_all(MortonCode brick, Value value);
    /// Makes all voxels of a brick unknown and frees its memory. Throws std::bad_alloc if a copy also owns
    /// the brick and there is no memory for new nodes; the tree is then unchanged.
    void forget(MortonCode brick);
    /// The brick as a dense brick, to be written until this tree is used again. A brick with one value keeps
    /// it in all voxels. Throws std::bad_alloc; the tree is then unchanged.
    [[nodiscard]] Values& open(MortonCode brick);

    /// The content of a cube of space. It can be followed from the whole octree down to a brick, as long as
    /// the tree is unchanged.
    class Space {
      public:
        /// If the root's space has parts, its cube is twice as wide as the octree: only the first eight parts
        /// are inside.
        [[nodiscard]] const VoxelCube& cube() const noexcept { return cube_; }
        /// True if it is larger than a brick and not completely unknown.
        [[nodiscard]] bool has_parts() const noexcept { return cube_.height > kBrickHeight && place_ != 0; }
        /// One of its 64 parts, in Morton order. Only for a space with parts.
        [[nodiscard]] Space part(std::size_t index) const noexcept;
        /// The content of its bricks. It has several bricks only if all are unknown. Only for a space without
        /// parts.
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
    /// Visits, in Morton order, each brick that differs from `before`, known or not. Shared parts are
    /// skipped, so the cost is that of the bricks written since one tree was a copy of the other.
    void for_each_difference(const BrickTreeOf& before,
                             const std::function<void(MortonCode brick)>& visit) const;

    [[nodiscard]] std::size_t nodes() const noexcept { return nodes_; }
    /// Number of bricks with a value for each voxel.
    [[nodiscard]] std::size_t dense_bricks() const noexcept { return dense_; }
    /// Number of bricks with a known voxel.
    [[nodiscard]] std::size_t bricks() const noexcept { return bricks_; }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return nodes_ * kNodeBytes + dense_ * kBrickBytes;
    }

  private:
    /// A brick's place in nodes that this tree alone owns. Throws std::bad_alloc; no empty node remains then.
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
