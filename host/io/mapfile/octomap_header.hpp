// The text before the nodes in OctoMap's files.
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
    bool is_binary = false;  ///< .bt with two bits a child; otherwise .ot with log-odds
    double resolution_m = 0.0;
    std::optional<std::uint64_t> nodes;  ///< number in the header; empty if it has none
    std::size_t colour_bytes = 0;        ///< of an .ot: bytes after each node's log-odds
    std::size_t data_begin = 0;          ///< position of the first node in the file
    bool is_octoskins = false;           ///< octoskin saved the file: it has octoskin's comment
    /// The log-odds threshold for occupied voxels, if octoskin saved it with a value other than 0.
    std::optional<float> occupied_from;
    /// Deviations from the form that OctoMap and octoskin write, without effect on the meaning.
    std::vector<std::string> differences;
};

/// Whether the header contains octoskin's comment. Older versions did not write it.
enum class SavedMark : std::uint8_t { present, absent };

/// The header that octoskin writes: OctoMap's own with one more comment, and another one if `occupied_from`
/// is not 0, OctoMap's threshold for occupied voxels. Numbers have the shortest form that reads back exactly.
[[nodiscard]] std::string octomap_header(bool is_binary, std::uint64_t nodes, double resolution_m,
                                         SavedMark mark = SavedMark::present, float occupied_from = 0.0F);

/// Parses the header at the beginning of `bytes` as OctoMap 1.9 does: words are separated by any white space,
/// the last of repeated keys counts, and unknown keys are skipped with their line. A .bt before OctoMap 1.4
/// began with binary numbers. Examines at most the first 1 MiB. A header that octoskin wrote may differ from
/// its form in comments only.
[[nodiscard]] Result<OctomapHeader, MapReadError> parse_octomap_header(std::string_view bytes,
                                                                       std::uint64_t nodes_max);

}  // namespace octoskin
