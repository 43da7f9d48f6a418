#include "host/apps/octoskin/map_provenance.hpp"

#include "host/apps/octoskin/recorded_scene.hpp"

namespace octoskin::app {
namespace {

namespace fs = std::filesystem;

std::string describe(const std::optional<std::uint32_t>& crc32) {
    return crc32 ? "CRC-32 " + crc_text(*crc32) : "which cannot be read";
}

Status<AppError> check_beside(const fs::path& map, const MapOrigin& origin, const fs::path& recording) {
    const auto found = crc32_of_recording(RecordingPaths(recording));
    if (found == origin.recording_crc32) return Done{};
    return fail(ExitCode::bad_data,
                map.string() + ": was made from another recording (" + origin.recording.string() +
                    ", CRC-32 " + crc_text(origin.recording_crc32) + ") than lies beside it (" +
                    recording.string() + ", " + describe(found) + "); replay that one again");
}

/// The recording that the maps.yaml names, if it still is what it was.
std::optional<fs::path> named_recording(const MapOrigin& origin, std::vector<std::string>& warnings) {
    std::error_code error;
    if (is_of_data_set(origin) || !fs::is_directory(origin.recording, error)) return std::nullopt;
    const auto found = crc32_of_recording(RecordingPaths(origin.recording));
    if (found == origin.recording_crc32) return origin.recording;
    warnings.push_back(origin.recording.string() + ": the map was made from it, but it has changed since (" +
                       describe(found) + "); it is not used");
    return std::nullopt;
}

}  // namespace

bool is_of_data_set(const MapOrigin& origin) {
    return origin.robot == "-";  // as data_set_playback.cpp writes it: there is none
}

Result<std::optional<MapOrigin>, AppError> origin_of_map(const fs::path& map) {
    auto origin = read_map_origin(NamedFolder(fs::absolute(map).parent_path()));
    if (!origin || !*origin || !(*origin)->maps.contains(map.filename().string())) {
        return origin ? std::optional<MapOrigin>{} : std::move(origin);
    }
    if (auto fault = fault_of_map(map, **origin)) return unexpected(std::move(*fault));
    return origin;
}

Result<MapProvenance, AppError> provenance_of_map(const fs::path& map) {
    auto origin = origin_of_map(map);
    if (!origin) return unexpected(origin.error());
    RecordingBeside beside = recording_beside(map);
    MapProvenance found{std::move(*origin), beside.directory, std::move(beside.warnings)};
    if (found.origin && found.recording) {
        if (const auto checked = check_beside(map, *found.origin, *found.recording); !checked)
            return unexpected(checked.error());
    } else if (found.origin) {
        found.recording = named_recording(*found.origin, found.warnings);
    } else if (found.recording) {
        found.warnings.push_back(map.string() + ": no " + kMapOriginFile +
                                 " beside it says that it was made from " + found.recording->string() +
                                 ", which is taken for granted");
    }
    return found;
}

}  // namespace octoskin::app
