// What range sensors that see a cone have counted, beside the log-odds of everything else.
#pragma once

#include <cstddef>

#include "host/core/bricks/brick_tree.hpp"

namespace octoskin {

/// Bricks in which something was counted. Copies share what they have in common, as a BrickTree's do.
struct CountLayer {
    BrickTree prior;   ///< log-odds of everything else there; unknown where nothing else was
    BrickTree misses;  ///< of the same bricks as `hits`
    BrickTree hits;

    [[nodiscard]] bool empty() const noexcept { return hits.bricks() == 0; }
    [[nodiscard]] bool has(MortonCode brick) const noexcept { return !hits.find(brick).is_unknown(); }
    /// Begins to count in a brick whose log-odds are `now`. Throws std::bad_alloc; then it has not begun.
    void begin(MortonCode brick, const BrickView& now);
    /// Makes it so that in some voxels of a brick nothing was counted or known. Throws std::bad_alloc.
    void expire(MortonCode brick, const BrickMask& voxels);
    /// If every brick had a value of its own for each voxel.
    [[nodiscard]] std::size_t bytes_at_most() const noexcept;
    /// What a further brick may take.
    [[nodiscard]] std::size_t bytes_of_new(MortonCode brick) const noexcept;
    [[nodiscard]] std::size_t heap_bytes() const noexcept;
};

}  // namespace octoskin
