// One stamp of 16 bits for many voxels of a brick at once.
#pragma once

#include <cstddef>
#include <cstdint>

#include "host/core/bricks/brick.hpp"

namespace octoskin {

using BrickStamps = BrickValuesOf<std::uint16_t>;

/// Gives each voxel of the set the stamp. About 30 ns for a whole brick.
void put_stamp(BrickStamps& stamps, const BrickMask& voxels, std::uint16_t stamp) noexcept;

/// Whether a voxel of the set has another one. About as long.
[[nodiscard]] bool has_other_stamp(const BrickStamps& stamps, const BrickMask& voxels,
                                   std::uint16_t stamp) noexcept;

/// Of the brick's voxels from 64 `word` on those below the limit, as a word of a BrickMask; `word` below 8.
[[nodiscard]] std::uint64_t stamps_below(const BrickStamps& stamps, std::size_t word,
                                         std::uint16_t limit) noexcept;

}  // namespace octoskin
