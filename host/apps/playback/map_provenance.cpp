#include "host/apps/playback/map_provenance.hpp"

#include "host/apps/recording/recording.hpp"

namespace octoskin::app {
namespace {

namespace fs = std::filesystem;

std::string describe(const std::optional<std::uint32_t>& crc32) {
    return crc32 ? "CRC-32 " + crc_text(*crc32) : "which cannot be read";
}

Status<AppError> check_same(const fs::path& map, const MapOrigin& origin, const FilePlace& recording) {
    const auto found = crc32_of_recording(RecordingPaths(recording));
    if (found == origin.recording_crc32) return Done{};
    return fail(ExitCode::bad_data,
                {.code = ErrorCode::mismatch,
                 .what = "was made from another recording: expected " + recording.shown().string() + " (" +
                         describe(found) + ")",
                 .value = origin.recording.string() + " (" + describe(origin.recording_crc32) + ")",
                 .remedy = "replay " + recording.shown().string() + " again",
                 .file = map});
}

/// The recording that maps.yaml names, if it is below the map's folder and unchanged.
std::optional<FilePlace> named_recording(const fs::path& map, const MapOrigin& origin,
                                         std::vector<std::string>& warnings) {
    if (is_of_data_set(origin)) return std::nullopt;
    const FilePlace place(NamedFolder(fs::absolute(map).parent_path()), origin.recording);
    const auto opened = place.open_folder();
    if (!opened) {
        warnings.push_back(map.string() + ": " + kMapOriginFile + " beside it names the recording " +
                           origin.recording.string() +
                           ", which is not opened because it is not below the map's folder; if you trust it, "
                           "give --recording " +
                           origin.recording.string());
        return std::nullopt;
    }
    const auto found = crc32_of_recording(RecordingPaths(place));
    if (found == origin.recording_crc32) return place;
    warnings.push_back(place.shown().string() + ": the map was made from it, but it has changed since (" +
                       describe(found) + "); it is not used");
    return std::nullopt;
}

struct RecordingBeside {
    std::optional<FilePlace> place;
    std::vector<std::string>
        warnings;  ///< about a folder that is a recording except for an unreadable meta.yaml
};

/// The recording of a map, reached without links, at the places where `octoskin replay` and `octoskin-lab
/// experiment` put their maps.
RecordingBeside recording_beside(const fs::path& map) {
    std::error_code error;
    const auto folder = fs::absolute(map, error).lexically_normal().parent_path();
    RecordingBeside found;
    const NamedFolder opened(folder);
    for (const FilePlace& candidate :
         {FilePlace(opened, "recording"), FilePlace(folder.parent_path()), FilePlace(folder)}) {
        const RecordingPaths recording(candidate);
        if (!recording.meta().is_there()) continue;
        const auto meta = read_meta(recording);
        if (meta) {
            found.place = candidate;
            return found;
        }
        found.warnings.push_back(
            meta.error().message() +
            "; repair that file, otherwise the map is not evaluated with this recording");
    }
    return found;
}

}  // namespace

bool is_of_data_set(const MapOrigin& origin) {
    return origin.robot == "-";  // "-": written by data_set_playback.cpp, there is no robot
}

Result<std::optional<MapOrigin>, AppError> origin_of_map(const fs::path& map) {
    auto origin = read_map_origin(NamedFolder(fs::absolute(map).parent_path()));
    if (!origin || !*origin || !(*origin)->maps.contains(map.filename().string())) {
        return origin ? std::optional<MapOrigin>{} : std::move(origin);
    }
    if (auto fault = fault_of_map(map, **origin)) return unexpected(std::move(*fault));
    return origin;
}

Result<MapProvenance, AppError> provenance_of_map(const fs::path& map, const fs::path& given) {
    auto origin = origin_of_map(map);
    if (!origin) return unexpected(origin.error());
    RecordingBeside beside;
    if (given.empty()) {
        beside = recording_beside(map);
    } else {
        beside.place = given;
    }
    MapProvenance found{std::move(*origin), std::move(beside.place), std::move(beside.warnings)};
    if (found.origin && found.recording) {
        if (const auto checked = check_same(map, *found.origin, *found.recording); !checked)
            return unexpected(checked.error());
    } else if (found.origin) {
        found.recording = named_recording(map, *found.origin, found.warnings);
    } else if (found.recording) {
        found.warnings.push_back(map.string() + ": no " + kMapOriginFile + " beside it names as its source " +
                                 found.recording->shown().string() + ", which is not checked");
    }
    return found;
}

}  // namespace octoskin::app
