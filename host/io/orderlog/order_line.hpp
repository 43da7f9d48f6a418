// One line of order.log:
//
//     octoskin-order/2 rig 1a2b3c4d mapping 1a2b3c4d joints 7 first 1a2b3c4d state 1a2b3c4d    the first line
//     J 71000000000 0.1 -0.2 0 0 0 0 0        joint sample: taken at (ns), radians, one for each of `joints`.
//                                             With several sources, `joints 7+2`, its source's index, from 0,
//                                             is before the time
//     R 2 3 0 71003000000 0.734 0.021         reading: node, sensor, zone, captured at (ns), range and sigma
//                                             in metres; range "-": no target
//     D 12 71010000000                        depth frame: its index in depth.oni, from 0, captured at (ns);
//                                             "-": the image is not recorded. With several cameras,
//                                             `joints 7 cameras 2`, its camera's index in the rig, from 0, is
//                                             before, and the frame is in depth/NAME.oni
//     W 12                                    a saved map waits for its first measurement; seconds that
//                                             have passed
//     # anything                              a comment
//     end commits 3 lost_can 0 lost_commits 0 lost_depth 0 last 1a2b3c4d          the last line
//
// Times are on the clock of SYNC. Numbers are the shortest decimals that give the same double again.
// CRC-32 (zlib's): `mapping` of the whole mapping text, `first` of first.ot, `state` of first.snapshot,
// `last` of last.ot; "-": an empty map. `rig` is the rig's hash. Version 1 has neither `state` nor W: it
// begins with first.ot only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/core/pipeline/commit.hpp"

namespace octoskin::orderlog {

/// What the fields of a commit depend on.
struct CommitForm {
    std::vector<std::size_t> joints = {};  ///< of each source of the rig, 1..7 each
    std::size_t cameras = 1;               ///< of the rig; 1 also if it has none
    friend bool operator==(const CommitForm&, const CommitForm&) = default;
};

struct Header {
    std::uint32_t rig_hash = 0;
    std::uint32_t mapping_crc32 = 0;
    CommitForm form = {};
    std::optional<std::uint32_t> first_map;         ///< CRC-32 of first.ot; empty: the map was empty
    std::optional<std::uint32_t> first_state = {};  ///< CRC-32 of first.snapshot; empty: version 1
    friend bool operator==(const Header&, const Header&) = default;
};

/// The end of a recording.
struct Trailer {
    std::uint64_t commits = 0;  ///< number of lines J, R and D that the file should have
    std::uint64_t lost_can = 0;
    std::uint64_t lost_commits = 0;
    std::uint64_t lost_depth = 0;
    std::optional<std::uint32_t> last_map;  ///< CRC-32 of last.ot; empty: the map was empty
    /// True if nothing of the map's input is missing. Lost frames of the bus change no voxel.
    [[nodiscard]] bool is_complete() const noexcept { return lost_commits + lost_depth == 0; }
    friend bool operator==(const Trailer&, const Trailer&) = default;
};

/// "7+2": the joints of each source.
[[nodiscard]] std::string joints_text(std::span<const std::size_t> joints);

/// Each with its line feed. A header without `first_state` is of version 1. `form`: that of the header.
[[nodiscard]] std::string format_header(const Header& header);
[[nodiscard]] std::string format_commit(const Commit& commit, const CommitForm& form);
[[nodiscard]] std::string format_trailer(const Trailer& trailer);

/// Well above the longest line of any kind.
inline constexpr std::size_t kLineBytesMax = 1024;

/// `line` has no line feed. Empty if it is not such a line. Safe for any bytes.
[[nodiscard]] std::optional<Header> parse_header(std::string_view line);
[[nodiscard]] std::optional<Commit> parse_commit(std::string_view line, const CommitForm& form);
[[nodiscard]] std::optional<Trailer> parse_trailer(std::string_view line);

}  // namespace octoskin::orderlog
