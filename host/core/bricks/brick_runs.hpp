// Splits the voxels of a ray, in the order of the ray, into runs that lie in one brick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/voxel_update.hpp"

namespace octoskin {

/// Only the first `updates` and `runs` entries are set.
struct BrickRuns {
    static constexpr std::size_t kUpdatesMax = 256;
    /// Results are written one vector at a time.
    static constexpr std::size_t kRoom = kUpdatesMax + 16;

    std::size_t updates = 0;
    std::size_t runs = 0;
    std::array<std::uint32_t, kRoom> cell_of;   ///< index of each update's voxel in its brick
    std::array<std::uint32_t, kRoom> first_of;  ///< index of the first update of each run
};

/// Finds the runs of the updates, up to the first update whose term is 0 or not finite, and kUpdatesMax at
/// most. Runs are short and differ from each other, so branch prediction cannot foresee their ends; the code
/// has no branch for it. The result is the same on every processor. About 2 ns per update.
void find_runs(std::span<const VoxelUpdate> updates, BrickRuns& found) noexcept;

}  // namespace octoskin
