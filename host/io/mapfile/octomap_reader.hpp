// Checks and reads the bytes of a .ot or .bt file. What OctoMap's own reader takes is taken, but the input
// may be hostile: that reader also accepts truncated files and NaN, and overflows the stack on a deep chain.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

enum class MapFault : std::uint8_t {
    not_a_map,             ///< the first line is neither OctoMap's for .ot nor for .bt
    header_malformed,      ///< id, res or data missing, size no number; octoskin's, and not as it was saved
    wrong_tree_type,       ///< a .ot that is no tree of occupancies
    resolution_not_valid,  ///< not a number between 1e-6 and 1e6
    too_many_nodes,        ///< more than the limit
    truncated,             ///< the data end before the tree does
    trailing_bytes,        ///< octoskin saved it, and the tree ends before the data do
    node_count_differs,    ///< the tree has more or fewer nodes than the header says; if octoskin did not
                           ///< save it, only where the tree does not end with the data either
    too_deep,              ///< a node below level 16
    inner_node_empty,      ///< a node said to have children has none
    log_odds_not_finite,   ///< NaN or infinity in a node
    log_odds_outside_clamps,  ///< beyond the clamps given
    no_room,                  ///< the voxels need more than `MapConfig::memory_max_mib`
};

/// What is wrong, and where: at which byte and with which value.
struct MapReadError {
    MapFault fault{};
    std::string what;
};

struct MapReadLimits {
    /// Clamps, threshold and memory of the map to be made; its resolution comes from the file, and so does
    /// the threshold where the file says it. A program that left OctoMap's defaults alone clamps at 3.5110
    /// rather than 3.5.
    MapConfig map;
    std::uint64_t nodes_max = 50'000'000;
};

/// A map, and what its file is beside that.
struct LoadedMap {
    FusedMap map;
    std::vector<std::string> warnings;  ///< how the file differs from one that OctoMap writes
    bool is_octoskins = false;          ///< octoskin saved it
    bool has_lost_colours = false;      ///< the file has a colour for each voxel; the map has none
};

/// The map that the bytes hold, .ot or .bt by their first line. Everything is checked before a voxel is made.
/// Leaves alone count: an inner node's value must be sane but is not used. O(bytes + voxels).
[[nodiscard]] Result<LoadedMap, MapReadError> decode_octomap(std::string_view bytes,
                                                             const MapReadLimits& limits);

}  // namespace octoskin
