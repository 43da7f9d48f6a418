// Maps to files and back: .ot and .bt as OctoMap has them, .ply for the eye. Start here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/mapfile/atomic_file.hpp"
#include "host/io/mapfile/octomap_reader.hpp"

namespace octoskin {

/// "out/map.ot: byte 4711: the data end within the tree": file, place, value and, where there is one, remedy.
struct MapFileError {
    std::string message;
    bool is_too_large = false;        ///< for the limits given; it may be whole
    bool is_of_other_voxels = false;  ///< than the mapping asks for; it is whole
};

/// That the map in `file` has voxels of one size, and the mapping asks for another, metres both.
[[nodiscard]] std::string describe_other_voxels(const std::filesystem::path& file, double map_m,
                                                double mapping_m);

/// Writes the map, in the format that the extension names (.ot, .bt or .ply), beside `file`, until
/// `put_in_place`. Equal maps give equal bytes.
[[nodiscard]] Result<FileDraft, MapFileError> draft_map(const FusedMap& map, const FilePlace& file);
/// The same in its place, and its CRC-32: at every instant the file is the old one or the new one, whole.
[[nodiscard]] Result<std::uint32_t, MapFileError> save_map(const FusedMap& map, const FilePlace& file);

/// Reads a .ot or .bt (told apart by the first line, not by name), checked as octomap_reader.hpp says; the
/// warnings name the file. Refuses what is no regular file and what is larger than `file_bytes_max`.
[[nodiscard]] Result<LoadedMap, MapFileError> load_map(const FilePlace& file,
                                                       const MapReadLimits& limits = {},
                                                       std::uint64_t file_bytes_max = 512ULL << 20U);

/// Whether the file has the comment that save_map leaves in a .ot or .bt. False, too, if it cannot be read.
[[nodiscard]] bool is_saved_by_octoskin(const FilePlace& file);

/// A map to go on with, as it was saved from one of this resolution and `memory_max_mib`: any such map has
/// room, also a full one. Whatever it was clamped to, it is clamped as `config` says from now on. Further
/// errors: it needs more memory than that, or has voxels of another size.
[[nodiscard]] Result<LoadedMap, MapFileError> load_map_of(const MapConfig& config, const FilePlace& file);

}  // namespace octoskin
