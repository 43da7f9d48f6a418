#include "host/io/snapshot/snapshot_file.hpp"

#include <unistd.h>

#include <array>
#include <new>
#include <string>
#include <utility>

#include "host/io/mapfile/whole_file.hpp"
#include "host/io/snapshot/camera_records.hpp"

namespace octoskin {
namespace {

/// Log-odds, counts and times need less than twice the share of the log-odds (`bytes_needed`), also if a
/// daemon continues with less memory than before; readings need far less than the rest.
std::uint64_t file_bytes_max_of(const MapConfig& config) {
    return (std::uint64_t{config.memory_max_mib} << 21U) + (std::uint64_t{64} << 20U) +
           snapshot::kPixelBytesMax * snapshot::kCameraPixelsMax;
}

}  // namespace

Result<FileDraft, SaveError> draft_snapshot(const MapState& state, const SnapshotOrigin& origin,
                                            const FilePlace& file) {
    return FileDraft::write(file, [&](const ByteSink& sink) { write_snapshot(state, origin, sink); });
}

Result<std::uint32_t, SaveError> save_snapshot(const MapState& state, const SnapshotOrigin& origin,
                                               const FilePlace& file) {
    return save_atomically(file, [&](const ByteSink& sink) { write_snapshot(state, origin, sink); });
}

Result<Snapshot, Error> load_snapshot(const FilePlace& file, const MappingConfig& mapping,
                                      std::uint32_t mapping_crc32) try {
    const auto bytes = read_whole_file(file, file_bytes_max_of(mapping.map));
    if (!bytes) return unexpected(bytes.error());
    auto snapshot = decode_snapshot(*bytes, mapping, mapping_crc32);
    if (!snapshot) return unexpected(in_file(snapshot.error(), file.shown()));
    return snapshot;
} catch (const std::bad_alloc&) {
    return unexpected(
        in_file({ErrorCode::no_resources, "there is not enough memory to read it"}, file.shown()));
}

std::optional<SnapshotOrigin> origin_of_snapshot_file(const FilePlace& file) {
    const auto opened = file.open();
    if (!opened) return std::nullopt;
    std::array<char, kSnapshotHeadMax> bytes{};
    const ssize_t count = ::pread(opened->descriptor(), bytes.data(), bytes.size(), 0);
    if (count <= 0) return std::nullopt;
    return origin_of_snapshot({bytes.data(), static_cast<std::size_t>(count)});
}

}  // namespace octoskin
