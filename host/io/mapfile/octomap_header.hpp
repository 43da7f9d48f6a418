// The text in front of the nodes in OctoMap's files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/io/mapfile/octomap_reader.hpp"

namespace octoskin {

struct OctomapHeader {
    bool is_binary = false;  ///< a .bt, two bits a child; else a .ot with log-odds
    double resolution_m = 0.0;
    std::optional<std::uint64_t> nodes;  ///< as the header says; empty if it says none
    std::size_t colour_bytes = 0;        ///< of a .ot, behind each node's log-odds
    std::size_t data_begin = 0;          ///< where the nodes begin in the file
    bool is_octoskins = false;           ///< octoskin saved the file: its comment is there
    /// From which log-odds on a voxel is occupied, where octoskin saved it with another number than 0.
    std::optional<float> occupied_from;
    /// What is not as OctoMap and octoskin write it, but does not change what the file means.
    std::vector<std::string> differences;
};

/// Whether the header says that octoskin saved the map. Octoskin did not write that into maps always.
enum class SavedMark : std::uint8_t { present, absent };

/// What octoskin writes in front of the nodes: OctoMap's own header with one comment more, and another where
/// `occupied_from` is not 0, from which on OctoMap takes a voxel for occupied. Numbers are in their shortest
/// form that reads back exactly.
[[nodiscard]] std::string octomap_header(bool is_binary, std::uint64_t nodes, double resolution_m,
                                         SavedMark mark = SavedMark::present, float occupied_from = 0.0F);

/// Reads the header at the beginning of `bytes` as OctoMap 1.9 does: words apart by any white space, of keys
/// that come twice the last, unknown keys skipped with their line; before 1.4 a .bt began with binary
/// numbers. Never looks beyond the first 1 MiB. A header that octoskin wrote may differ from it in comments
/// alone.
[[nodiscard]] Result<OctomapHeader, MapReadError> parse_octomap_header(std::string_view bytes,
                                                                       std::uint64_t nodes_max);

}  // namespace octoskin
