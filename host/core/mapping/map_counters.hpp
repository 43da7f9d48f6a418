// Results of all inputs that were ever given to a map.
#pragma once

#include <cstdint>

namespace octoskin {

/// Counted per voxel: input = the sum of these.
struct MapCounters {
    std::uint64_t applied = 0;
    std::uint64_t zero = 0;        ///< a term of 0, which changes nothing
    std::uint64_t not_finite = 0;  ///< refused
    std::uint64_t no_room = 0;     ///< refused: the voxel's space is new, and `memory_max_mib` is reached
    std::uint64_t no_memory = 0;   ///< refused: the voxel's space is new, and the system has no memory for it
    /// Applied, but without room or memory for the time stamp. Not part of the sum.
    std::uint64_t undated = 0;
    /// How often the system had no memory for a time stamp, or to let voxels expire. With memory, the same
    /// input gives another map, as after `no_memory`. Not part of the sum.
    std::uint64_t ages_without_memory = 0;
    [[nodiscard]] std::uint64_t refused() const noexcept { return no_room + no_memory; }
    friend bool operator==(const MapCounters&, const MapCounters&) = default;
};

/// The counter that a refused voxel increments.
using MapRefusal = std::uint64_t MapCounters::*;

}  // namespace octoskin
