// Saves and loads maps: .ot and .bt in OctoMap's formats, .ply for viewers. Start here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/mapfile/atomic_file.hpp"
#include "host/io/mapfile/octomap_reader.hpp"

namespace octoskin {

/// The error that the voxels of the map in `file` have another size than the mapping's; both in metres.
[[nodiscard]] Error other_voxels(const std::filesystem::path& file, double map_m, double mapping_m);

/// Writes the map, in the format of the extension (.ot, .bt or .ply), as a draft beside `file`, for
/// `put_in_place`. Equal maps give equal bytes.
[[nodiscard]] Result<FileDraft, Error> draft_map(const FusedMap& map, const FilePlace& file);
/// The same with `put_in_place`; returns the CRC-32. At every instant the file is the complete old one or the
/// complete new one.
[[nodiscard]] Result<std::uint32_t, Error> save_map(const FusedMap& map, const FilePlace& file);

/// Reads an .ot or .bt (distinguished by the first line, not by the name), with the checks of
/// octomap_reader.hpp; the warnings name the file. Refuses a file that is not regular or larger than
/// `file_bytes_max`.
[[nodiscard]] Result<LoadedMap, Error> load_map(const FilePlace& file, const MapReadLimits& limits = {},
                                                std::uint64_t file_bytes_max = 512ULL << 20U);

/// Whether the file contains the comment that save_map writes into .ot and .bt. Also false if it cannot be
/// read.
[[nodiscard]] bool is_saved_by_octoskin(const FilePlace& file);

/// Loads a map to continue, with a limit that fits any map saved with this resolution and `memory_max_mib`,
/// also a full one. From now on it is clamped by `config`, whatever its previous clamps. Further errors: it
/// needs more memory, or its voxels have another size.
[[nodiscard]] Result<LoadedMap, Error> load_map_of(const MapConfig& config, const FilePlace& file);

}  // namespace octoskin
