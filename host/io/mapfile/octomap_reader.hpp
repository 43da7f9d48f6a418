// Checks and reads the bytes of a .ot or .bt file. The input is taken for hostile: OctoMap's own reader
// accepts truncated files, wrong node counts and NaN, and overflows the stack on a deep chain.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

enum class MapFault : std::uint8_t {
    not_a_map,                ///< the first line is neither OctoMap's for .ot nor for .bt
    header_malformed,         ///< a line that is not id, size, res, data or a comment; one missing or twice
    wrong_tree_type,          ///< not an OcTree: colours, stamps or counts are not ours to drop
    resolution_not_valid,     ///< not a number between 1e-6 and 1e6
    too_many_nodes,           ///< more than the limit
    truncated,                ///< the data end before the tree does
    trailing_bytes,           ///< the tree ends before the data do
    node_count_differs,       ///< the tree has more or fewer nodes than the header says
    too_deep,                 ///< a node below level 16
    inner_node_empty,         ///< a node said to have children has none
    log_odds_not_finite,      ///< NaN or infinity in a node
    log_odds_outside_clamps,  ///< beyond the clamps given
    no_room,                  ///< the voxels need more than `MapConfig::memory_max_mib`
};

/// What is wrong, and where: at which byte and with which value.
struct MapReadError {
    MapFault fault{};
    std::string what;
};

struct MapReadLimits {
    /// Clamps, threshold and memory of the map to be made; its resolution comes from the file. A program that
    /// left OctoMap's defaults alone clamps at 3.5110 rather than 3.5.
    MapConfig map;
    std::uint64_t nodes_max = 50'000'000;
};

/// The map that the bytes hold, .ot or .bt by their first line. Everything is checked before a voxel is made.
/// Leaves alone count: an inner node's value must be sane but is not used. O(bytes + voxels).
[[nodiscard]] Result<FusedMap, MapReadError> decode_octomap(std::string_view bytes,
                                                            const MapReadLimits& limits);

}  // namespace octoskin
