#include "host/apps/playback/film_playback.hpp"

#include <utility>

#include "host/apps/playback/camera_alone.hpp"
#include "host/apps/playback/data_set_playback.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/reading.hpp"
#include "host/io/openni2/oni_reader.hpp"
#include "host/io/tum/data_set_camera.hpp"

namespace octoskin {
namespace {

constexpr const char* kSuffix = ".oni";

/// The camera of the images, and its pose in the map.
Result<rig::Camera, AppError> camera_of(const PlaybackRequest& request) {
    const auto given = rig_with_camera(request, "an .oni file");
    if (!given) return unexpected(given.error());
    auto camera = *given ? Result<rig::Camera, AppError>((*given)->cameras.front())
                         : named_camera(request.camera.empty() ? tum::kDataSetCameras.front()
                                                               : std::string_view(request.camera));
    if (!camera) return camera;
    if (*given && !camera->link.empty() && !request.T_map_camera) {
        return fail(ExitCode::bad_config,
                    {.code = ErrorCode::conflict,
                     .what = "the pose of a camera on a link is not known without joint states",
                     .value = "'" + camera->link + "'",
                     .remedy = "give --pose",
                     .file = request.rig,
                     .key = "camera.link"});
    }
    camera->link.clear();
    if (*given) camera->T_link_camera = (*given)->T_map_base * camera->T_link_camera;
    if (request.T_map_camera) camera->T_link_camera = *request.T_map_camera;
    return camera;
}

}  // namespace

std::optional<FilePlace> lone_film(const RecordingPaths& recording) {
    const bool is_named_so = recording.directory.extension() == kSuffix;
    if (is_named_so && FilePlace(recording.directory).is_file()) return FilePlace(recording.directory);
    for (const FilePlace& other : {recording.can_log(), recording.meta(), recording.order()}) {
        if (other.is_there()) return std::nullopt;
    }
    const auto folder = recording.folder.open();
    const auto names = folder ? folder->names() : unexpected(folder.error());
    if (!names || is_data_set(recording)) return std::nullopt;
    std::optional<FilePlace> film;
    for (const std::string& name : *names) {
        if (!name.ends_with(kSuffix)) continue;
        if (film) return std::nullopt;
        film = recording.file(name);
    }
    return film;
}

Status<AppError> check_film(const PlaybackRequest& request) {
    const auto film = lone_film(request.recording);
    const std::filesystem::path file = film ? film->shown() : std::filesystem::path();
    if (film) {
        if (auto refused = refused_to_read(*film)) return unexpected(std::move(*refused));
    }
    if (const auto checked = check_options_of_camera(request, file, "an .oni file on its own"); !checked)
        return checked;
    if (request.rig.empty() && !request.T_map_camera) {
        return fail(
            ExitCode::usage,
            {.code = ErrorCode::bad_argument,
             .what = "there is no can.log, and the camera's pose is unknown",
             .remedy = "give --pose X,Y,Z,ROLL,PITCH,YAW (metres and degrees, of its optical frame in "
                       "the map's), or a --rig whose camera has its pose",
             .file = file,
             .key = "--pose"});
    }
    return Done{};
}

Result<Playback, AppError> play_film(const PlaybackRequest& request, const ReplayReport& report) {
    const auto film = lone_film(request.recording);
    if (!film) {
        return fail(ExitCode::no_input, {.code = ErrorCode::not_found,
                                         .what = "the .oni no longer exists",
                                         .file = request.recording.directory});
    }
    const auto camera = camera_of(request);
    if (!camera) return unexpected(camera.error());
    const auto crc32 = crc32_of(std::span(&*film, 1), request.on_checksum);
    if (!crc32) {
        const auto opened = film->open();
        return fail(ExitCode::bad_data,
                    opened ? in_file({ErrorCode::system_error, "cannot be read"}, film->shown())
                           : to_error(opened.error()));
    }
    auto reader = openni2::OniReader::open_alone(*film);
    if (!reader) return unexpected(unread_depth(reader.error()));
    auto playback = play_camera(request, rig_of_camera(*camera, "film"), *crc32, *reader, report);
    if (!playback) return playback;
    playback->outcome.progress.begin = HostTime{0};
    if (!request.rig.empty()) {
        playback->warnings.push_back(
            film->shown().string() +
            ": without joint states; a robot that the camera sees becomes part of the map");
    }
    if (auto loss = reader->loss()) playback->warnings.push_back(std::move(*loss));
    return playback;
}

}  // namespace octoskin
