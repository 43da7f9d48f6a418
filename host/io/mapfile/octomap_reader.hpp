// Checks and reads the bytes of an .ot or .bt file. It accepts what OctoMap's own reader accepts, except for
// hostile input: that reader also accepts truncated files and NaN, and overflows the stack on a deep chain of
// nodes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

enum class MapFault : std::uint8_t {
    not_a_map,             ///< the first line is not OctoMap's for .ot or .bt
    header_malformed,      ///< id, res or data missing, size not a number; or octoskin's own, and changed
    wrong_tree_type,       ///< an .ot that is not an occupancy tree
    resolution_not_valid,  ///< not a number from 1e-6 to 1e6
    too_many_nodes,        ///< more than the limit
    truncated,             ///< the data end before the tree
    trailing_bytes,        ///< octoskin saved it, and the tree ends before the data
    node_count_differs,    ///< the number of nodes is not that of the header; for a file of another program
                           ///< only if the tree does not end with the data either
    too_deep,              ///< a node below level 16
    inner_node_empty,      ///< a node marked as having children has none
    log_odds_not_finite,   ///< NaN or infinity in a node
    log_odds_outside_clamps,  ///< beyond the clamps given
    no_room,                  ///< the voxels need more than `MapConfig::memory_max_mib`
};

/// The fault with its place (byte) and value.
struct MapReadError {
    MapFault fault{};
    std::string what;
};

struct MapReadLimits {
    /// Clamps, threshold and memory limit of the new map. The resolution comes from the file, and so does the
    /// threshold if the file contains it. A program with OctoMap's default clamps at 3.5110, not 3.5.
    MapConfig map;
    std::uint64_t nodes_max = 50'000'000;
};

/// A map with facts about its file.
struct LoadedMap {
    FusedMap map;
    std::vector<std::string> warnings;  ///< how the file differs from OctoMap's own form
    bool is_octoskins = false;          ///< octoskin saved it
    bool has_lost_colours = false;      ///< the file has colours for its voxels; the map has none
};

/// Decodes the bytes of an .ot or .bt, distinguished by the first line. Everything is checked before a voxel
/// is made. Only leaves count: an inner node's value must be valid but is not used. O(bytes + voxels).
[[nodiscard]] Result<LoadedMap, MapReadError> decode_octomap(std::string_view bytes,
                                                             const MapReadLimits& limits);

}  // namespace octoskin
