// Snapshots as files.
#pragma once

#include <cstdint>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/mapfile/atomic_file.hpp"
#include "host/io/snapshot/snapshot.hpp"

namespace octoskin {

/// Writes a draft beside `file`, for `put_in_place`. Blocks as long as the disk takes. Throws std::bad_alloc.
[[nodiscard]] Result<FileDraft, SaveError> draft_snapshot(const MapState& state, const SnapshotOrigin& origin,
                                                          const FilePlace& file);
/// The same with `put_in_place`; returns the CRC-32. At every instant the file is the complete old one or the
/// complete new one.
[[nodiscard]] Result<std::uint32_t, SaveError> save_snapshot(const MapState& state,
                                                             const SnapshotOrigin& origin,
                                                             const FilePlace& file);

/// As decode_snapshot; errors begin with the file's name. Needs memory of the file's size besides the map's.
/// A file that cannot be read is `no_snapshot`. If there is not enough memory for it, or it is larger than
/// any file saved with this configuration, the error is `no_room`.
[[nodiscard]] Result<Snapshot, Error> load_snapshot(const FilePlace& file, const MappingConfig& mapping,
                                                    std::uint32_t mapping_crc32);

/// As origin_of_snapshot, without checks of the rest; also empty if the file cannot be read.
[[nodiscard]] std::optional<SnapshotOrigin> origin_of_snapshot_file(const FilePlace& file);

}  // namespace octoskin
