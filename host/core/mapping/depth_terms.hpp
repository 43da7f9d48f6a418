// The terms of one depth image: what it adds to which voxel.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_sets.hpp"
#include "host/core/voxels/voxel_update.hpp"

namespace octoskin {

/// How many updates from the first on are of one brick.
[[nodiscard]] inline std::size_t length_of_first_run(std::span<const VoxelUpdate> updates) noexcept {
    std::size_t length = 0;
    while (length < updates.size() && are_of_one_brick(updates[length].key, updates.front().key)) ++length;
    return length;
}

/// Calls visit(brick, voxels) for each run of updates in one brick, with those that have a finite term other
/// than 0; not for a run of none.
template <class Visit>
void for_each_run(std::span<const VoxelUpdate> updates, const Visit& visit) {
    while (!updates.empty()) {
        const VoxelKey first = updates.front().key;
        BrickMask voxels{};
        bool has_any = false;
        std::size_t done = 0;
        for (; done < updates.size() && are_of_one_brick(updates[done].key, first); ++done) {
            const float term = updates[done].log_odds;
            if (!std::isfinite(term) || term == 0.0F) continue;
            put_in(voxels, cell_of(updates[done].key));
            has_any = true;
        }
        if (has_any) visit(brick_of(first), voxels);
        updates = updates.subspan(done);
    }
}

/// A term of its own for a voxel of a brick.
struct CellTerm {
    std::uint16_t cell = 0;
    float log_odds = 0.0F;
    friend bool operator==(const CellTerm&, const CellTerm&) = default;
};

/// All that an image says about one brick.
struct BrickTerms {
    MortonCode first = 0;          ///< of its voxels
    BrickMask passed{};            ///< voxels that get `DepthTerms::miss`
    std::uint32_t hits_begin = 0;  ///< of `DepthTerms::hits`; none of them is among `passed`
    std::uint32_t hits_end = 0;
    friend bool operator==(const BrickTerms&, const BrickTerms&) = default;
};

/// Each brick once, in Morton order; each voxel once at most; no term of 0.
struct DepthTerms {
    float miss = 0.0F;
    std::vector<BrickTerms> bricks;
    std::vector<CellTerm> hits;  ///< by brick, in ascending order of cells

    /// Adds a brick, later in Morton order than all before; nothing if no voxel of it was passed. A miss of 0
    /// is none.
    void add(MortonCode brick, const BrickMask& passed);
    /// Adds a hit in the brick that comes next or came last, in ascending order; a term of 0 is none.
    void add_hit(MortonCode brick, CellTerm hit);
    /// Adds another image part's terms of the same miss, all later in Morton order.
    void append(const DepthTerms& later);
    /// Takes voxels in any order, each once, in place of what is here. A term equal to `miss` is a miss.
    void take(std::vector<VoxelUpdate> updates);

    [[nodiscard]] std::span<const CellTerm> hits_of(const BrickTerms& brick) const noexcept {
        return std::span(hits).subspan(brick.hits_begin, brick.hits_end - brick.hits_begin);
    }
    /// What a voxel gets; 0: nothing.
    [[nodiscard]] float of(VoxelKey key) const noexcept;
    [[nodiscard]] bool empty() const noexcept { return bricks.empty(); }
    /// How many voxels get a term. O(bricks).
    [[nodiscard]] std::size_t size() const noexcept;
    /// Calls visit(VoxelUpdate) for each voxel: by brick, those passed before those with a term of their own.
    template <class Visit>
    void for_each(Visit&& visit) const {
        for (const BrickTerms& brick : bricks) {
            for (std::size_t word = 0; word < brick.passed.size(); ++word) {
                for (std::uint64_t bits = brick.passed[word]; bits != 0; bits &= bits - 1) {
                    const auto cell = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
                    visit(VoxelUpdate{key_of_morton(brick.first + cell), miss});
                }
            }
            for (const CellTerm& hit : hits_of(brick))
                visit(VoxelUpdate{key_of_morton(brick.first + hit.cell), hit.log_odds});
        }
    }
    friend bool operator==(const DepthTerms&, const DepthTerms&) = default;

  private:
    /// The brick's terms, which begin here if they have not begun.
    [[nodiscard]] BrickTerms& last(MortonCode brick);
};

[[nodiscard]] inline std::size_t count_of(const BrickMask& mask) noexcept {
    std::size_t count = 0;
    for (const std::uint64_t word : mask) count += static_cast<std::size_t>(std::popcount(word));
    return count;
}

}  // namespace octoskin
