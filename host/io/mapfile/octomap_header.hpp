// The text in front of the nodes in OctoMap's files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/result.hpp"
#include "host/io/mapfile/octomap_reader.hpp"

namespace octoskin {

struct OctomapHeader {
    bool is_binary = false;  ///< a .bt, two bits a child; else a .ot with log-odds
    double resolution_m = 0.0;
    std::uint64_t nodes = 0;
    std::size_t data_begin = 0;  ///< where the nodes begin in the file
};

/// Reads and checks the header at the beginning of `bytes`; never looks beyond its first 4096 bytes.
[[nodiscard]] Result<OctomapHeader, MapReadError> parse_octomap_header(std::string_view bytes,
                                                                       std::uint64_t nodes_max);

}  // namespace octoskin
