// Counts of range sensors with a cone, stored beside the log-odds of all other measurements.
#pragma once

#include <cstddef>

#include "host/core/bricks/brick_tree.hpp"

namespace octoskin {

/// Bricks with counts. Copies share unchanged bricks, like copies of a BrickTree.
struct CountLayer {
    BrickTree prior;   ///< log-odds of all other measurements there; unknown if there are none
    BrickTree misses;  ///< in the same bricks as `hits`
    BrickTree hits;

    [[nodiscard]] bool empty() const noexcept { return hits.bricks() == 0; }
    [[nodiscard]] bool has(MortonCode brick) const noexcept { return !hits.find(brick).is_unknown(); }
    /// Begins counting in a brick whose log-odds are `now`. Throws std::bad_alloc; counting has then not
    /// begun.
    void begin(MortonCode brick, const BrickView& now);
    /// Clears the counts and priors of some voxels of a brick. Throws std::bad_alloc.
    void expire(MortonCode brick, const BrickMask& voxels);
    /// Bytes if every brick had its own value for each voxel.
    [[nodiscard]] std::size_t bytes_at_most() const noexcept;
    /// Upper bound of the bytes that a further brick takes.
    [[nodiscard]] std::size_t bytes_of_new(MortonCode brick) const noexcept;
    [[nodiscard]] std::size_t heap_bytes() const noexcept;
};

}  // namespace octoskin
