// Voxels one after the other, as a ray passes them: in runs of one brick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/voxel_update.hpp"

namespace octoskin {

/// Only what was found is set: of so many updates, and of so many runs.
struct BrickRuns {
    static constexpr std::size_t kUpdatesMax = 256;
    /// What is found is written a vector at a time.
    static constexpr std::size_t kRoom = kUpdatesMax + 16;

    std::size_t updates = 0;
    std::size_t runs = 0;
    std::array<std::uint32_t, kRoom> cell_of;   ///< of each update: its voxel's place in the brick
    std::array<std::uint32_t, kRoom> first_of;  ///< of each run: which update it begins with
};

/// Finds the runs of the updates up to the first whose term is 0 or not finite, and of kUpdatesMax at most.
/// Runs are short and no two of a ray are alike: where one ends no processor foresees, so that here no branch
/// asks. The same on every processor. About 2 ns an update.
void find_runs(std::span<const VoxelUpdate> updates, BrickRuns& found) noexcept;

}  // namespace octoskin
