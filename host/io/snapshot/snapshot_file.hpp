// Snapshots as files.
#pragma once

#include <cstdint>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/mapfile/atomic_file.hpp"
#include "host/io/snapshot/snapshot.hpp"

namespace octoskin {

/// Written beside `file`, until `put_in_place`. Blocks as long as the disk takes. Throws std::bad_alloc.
[[nodiscard]] Result<FileDraft, SaveError> draft_snapshot(const MapState& state, const SnapshotOrigin& origin,
                                                          const FilePlace& file);
/// The same in its place, and its CRC-32: at every instant the file is the old one or the new one, whole.
[[nodiscard]] Result<std::uint32_t, SaveError> save_snapshot(const MapState& state,
                                                             const SnapshotOrigin& origin,
                                                             const FilePlace& file);

/// As decode_snapshot; errors begin with the file's name. Takes the file's size of memory besides the map's.
/// A file that cannot be read is `no_snapshot`; without memory for it, or larger than any that was saved with
/// this configuration, it is `no_room`.
[[nodiscard]] Result<Snapshot, SnapshotError> load_snapshot(const FilePlace& file,
                                                            const MappingConfig& mapping,
                                                            std::uint32_t mapping_crc32);

/// As origin_of_snapshot, whatever lies behind the head; empty, too, if the file cannot be read.
[[nodiscard]] std::optional<SnapshotOrigin> origin_of_snapshot_file(const FilePlace& file);

}  // namespace octoskin
