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

constexpr float kLogOddsMax = 100.0F;       // the largest log-odds in a mapping file
constexpr std::uint64_t kBytesPerNode = 5;  ///< in an .ot file: log-odds, and a bit for each child
constexpr std::size_t kHeaderBytesMax =
    4096;  ///< for a map that octoskin saved, including comments added later

/// A brick of 512 known voxels takes 2112 bytes of memory and 585 nodes of a file; an isolated one adds 13
/// nodes above it. One and a half times the memory is enough for both; the mebibyte is for the header of a
/// small file.
std::uint64_t file_bytes_max_of(const MapConfig& config) {
    return (std::uint64_t{config.memory_max_mib} << 20U) * 3 / 2 + (std::uint64_t{1} << 20U);
}

/// The code of a fault in a map file.
ErrorCode code_of(MapFault fault) {
    switch (fault) {
        case MapFault::no_room:
        case MapFault::too_many_nodes:
            return ErrorCode::too_large;
        case MapFault::truncated:
        case MapFault::trailing_bytes:
        case MapFault::node_count_differs:
        case MapFault::inner_node_empty:
        case MapFault::too_deep:
            return ErrorCode::damaged;
        case MapFault::not_a_map:
            return ErrorCode::foreign_format;
        case MapFault::wrong_tree_type:
            return ErrorCode::unsupported;
        case MapFault::header_malformed:
        case MapFault::resolution_not_valid:
            return ErrorCode::bad_syntax;
        case MapFault::log_odds_not_finite:
        case MapFault::log_odds_outside_clamps:
            break;
    }
    return ErrorCode::out_of_range;
}

}  // namespace

Result<FileDraft, Error> draft_map(const FusedMap& map, const FilePlace& file) {
    const std::string extension = file.shown().extension().string();
    ByteSource content;
    if (extension == ".ot") {
        content = [&map](const ByteSink& sink) { write_ot(map, sink); };
    } else if (extension == ".bt") {
        content = [&map](const ByteSink& sink) { write_bt(map, sink); };
    } else if (extension == ".ply") {
        content = [&map](const ByteSink& sink) { (void)sink(encode_ply(map)); };
    } else {
        return unexpected(Error{.code = ErrorCode::unknown_word,
                                .what = "expected one of the extensions .ot, .bt, .ply",
                                .value = fmt::format("\"{}\"", extension),
                                .file = file.shown()});
    }
    auto draft = FileDraft::write(file, content);
    if (!draft) return unexpected(to_error(draft.error()));
    return std::move(draft).value();
}

Result<std::uint32_t, Error> save_map(const FusedMap& map, const FilePlace& file) {
    auto draft = draft_map(map, file);
    if (!draft) return unexpected(draft.error());
    if (const auto put = put_in_place({&*draft, 1}); !put) return unexpected(to_error(put.error()));
    return draft->crc();
}

Error other_voxels(const std::filesystem::path& file, double map_m, double mapping_m) {
    return {.code = ErrorCode::mismatch,
            .what = "expected voxels of " + std::to_string(mapping_m) + " m, those of the mapping",
            .value = std::to_string(map_m) + " m",
            .file = file};
}

Result<LoadedMap, Error> load_map(const FilePlace& file, const MapReadLimits& limits,
                                  std::uint64_t file_bytes_max) {
    const auto bytes = read_whole_file(file, file_bytes_max);
    if (!bytes) return unexpected(bytes.error());
    auto map = decode_octomap(*bytes, limits);
    if (!map) {
        return unexpected(in_file({code_of(map.error().fault), map.error().what}, file.shown()));
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

Result<LoadedMap, Error> load_map_of(const MapConfig& config, const FilePlace& file) try {
    const std::uint64_t bytes_max = file_bytes_max_of(config);
    MapConfig any_clamps = config;
    any_clamps.log_odds_min = -kLogOddsMax;
    any_clamps.log_odds_max = kLogOddsMax;
    auto loaded = load_map(file, {.map = any_clamps, .nodes_max = bytes_max / kBytesPerNode}, bytes_max);
    if (!loaded && loaded.error().code == ErrorCode::too_large) {
        return unexpected(Error{
            .code = ErrorCode::too_large,
            .what = fmt::format("it was saved with more memory than the {} MiB of map.memory_max_mib ({})",
                                config.memory_max_mib, loaded.error().reason()),
            .remedy = "raise that in the mapping file",
            .file = file.shown()});
    }
    if (!loaded) return loaded;
    if (loaded->map.resolution_m() != config.resolution_m) {
        return unexpected(other_voxels(file.shown(), loaded->map.resolution_m(), config.resolution_m));
    }
    loaded->map.limit(config);
    return loaded;
} catch (const std::bad_alloc&) {
    return unexpected(
        in_file({ErrorCode::no_resources, "there is not enough memory to read it"}, file.shown()));
}

}  // namespace octoskin
