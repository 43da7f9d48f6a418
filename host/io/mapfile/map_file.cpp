#include "host/io/mapfile/map_file.hpp"

#include <fmt/format.h>

#include <limits>
#include <new>

#include "host/io/mapfile/octomap_header.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/mapfile/ply_writer.hpp"
#include "host/io/mapfile/whole_file.hpp"

namespace octoskin {
namespace {

constexpr float kLogOddsMax = 100.0F;       // the limit of a mapping file
constexpr std::uint64_t kBytesPerNode = 5;  ///< in an .ot file: log-odds, and a bit for each child
constexpr std::size_t kHeaderBytesMax =
    4096;  ///< for a map that octoskin saved, including comments added later

/// A brick of 512 known voxels takes 2112 bytes of memory and 585 nodes of a file; an isolated one adds 13
/// nodes above it. One and a half times the memory is enough for both; the mebibyte is for the header of a
/// small file.
std::uint64_t file_bytes_max_of(const MapConfig& config) {
    return (std::uint64_t{config.memory_max_mib} << 20U) * 3 / 2 + (std::uint64_t{1} << 20U);
}

Unexpected<MapFileError> fail(const std::filesystem::path& file, const std::string& what,
                              bool is_too_large = false) {
    return unexpected(MapFileError{fmt::format("{}: {}", file.string(), what), is_too_large});
}

}  // namespace

Result<FileDraft, MapFileError> draft_map(const FusedMap& map, const FilePlace& file) {
    const std::string extension = file.shown().extension().string();
    ByteSource content;
    if (extension == ".ot") {
        content = [&map](const ByteSink& sink) { write_ot(map, sink); };
    } else if (extension == ".bt") {
        content = [&map](const ByteSink& sink) { write_bt(map, sink); };
    } else if (extension == ".ply") {
        content = [&map](const ByteSink& sink) { (void)sink(encode_ply(map)); };
    } else {
        return fail(file.shown(), fmt::format("extension \"{}\" is not one of .ot, .bt, .ply", extension));
    }
    auto draft = FileDraft::write(file, content);
    if (!draft) return unexpected(MapFileError{draft.error().message(), false});
    return std::move(draft).value();
}

Result<std::uint32_t, MapFileError> save_map(const FusedMap& map, const FilePlace& file) {
    auto draft = draft_map(map, file);
    if (!draft) return unexpected(draft.error());
    if (const auto put = put_in_place({&*draft, 1}); !put)
        return unexpected(MapFileError{put.error().message(), false});
    return draft->crc();
}

std::string describe_other_voxels(const std::filesystem::path& file, double map_m, double mapping_m) {
    return file.string() + ": its voxels are " + std::to_string(map_m) + " m, the mapping's are " +
           std::to_string(mapping_m) + " m";
}

Result<LoadedMap, MapFileError> load_map(const FilePlace& file, const MapReadLimits& limits,
                                         std::uint64_t file_bytes_max) {
    const auto bytes = read_whole_file(file, file_bytes_max);
    if (!bytes) return unexpected(MapFileError{bytes.error().message, bytes.error().is_too_large});
    auto map = decode_octomap(*bytes, limits);
    if (!map) {
        const MapFault fault = map.error().fault;
        return fail(file.shown(), map.error().what,
                    fault == MapFault::no_room || fault == MapFault::too_many_nodes);
    }
    for (std::string& warning : map->warnings)
        warning = fmt::format("{}: {}", file.shown().string(), warning);
    return std::move(map).value();
}

bool is_saved_by_octoskin(const FilePlace& file) {
    const auto opened = file.open();
    if (!opened) return false;
    const auto beginning = opened->read(kHeaderBytesMax);
    if (!beginning) return false;
    const auto header = parse_octomap_header(*beginning, std::numeric_limits<std::uint64_t>::max());
    return header && header->is_octoskins;
}

Result<LoadedMap, MapFileError> load_map_of(const MapConfig& config, const FilePlace& file) try {
    const std::uint64_t bytes_max = file_bytes_max_of(config);
    MapConfig any_clamps = config;
    any_clamps.log_odds_min = -kLogOddsMax;
    any_clamps.log_odds_max = kLogOddsMax;
    auto loaded = load_map(file, {.map = any_clamps, .nodes_max = bytes_max / kBytesPerNode}, bytes_max);
    if (!loaded && loaded.error().is_too_large) {
        return fail(file.shown(),
                    fmt::format("it was saved with more memory than the {} MiB of map.memory_max_mib: raise "
                                "that in the mapping file ({})",
                                config.memory_max_mib, loaded.error().message),
                    true);
    }
    if (!loaded) return loaded;
    if (loaded->map.resolution_m() != config.resolution_m) {
        return unexpected(MapFileError{
            .message = describe_other_voxels(file.shown(), loaded->map.resolution_m(), config.resolution_m),
            .is_of_other_voxels = true});
    }
    loaded->map.limit(config);
    return loaded;
} catch (const std::bad_alloc&) {
    return fail(file.shown(), "there is not enough memory to read it");
}

}  // namespace octoskin
