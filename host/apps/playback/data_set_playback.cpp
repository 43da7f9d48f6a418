#include "host/apps/playback/data_set_playback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/apps/playback/camera_alone.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/reading.hpp"
#include "host/io/tum/data_set_camera.hpp"
#include "host/io/tum/data_set_reader.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

/// In this order: the rig's camera (the requested one of several), the requested one, the one described by a
/// file of the data set, the one of the data set's layout.
Result<rig::Camera, AppError> camera_of(const PlaybackRequest& request, const std::optional<rig::Rig>& given,
                                        const tum::DataSetReader& reader) {
    if (given) return given->cameras.front();
    if (!request.camera.empty()) return named_camera(request.camera);
    const auto calibration = reader.calibration();
    if (!calibration) return named_camera(reader.layout().camera);
    const auto found = tum::calibrated_camera(*calibration, reader.first_image());
    if (found) return camera_with(*found);
    return unexpected(reading_error(
        calibration->shown(),
        {ExitCode::bad_data, with_remedy(found.error(), "give the camera with --camera or --rig")}));
}

/// Of all measurements of the data set.
Result<std::uint32_t, AppError> checksum_of(const PlaybackRequest& request,
                                            const tum::DataSetReader& reader) {
    if (const auto crc32 = crc32_of(reader.files())) return *crc32;
    const auto missing = reader.missing_image();
    const bool is_refused = std::ranges::any_of(
        reader.files(), [](const FilePlace& file) { return refused_to_read(file).has_value(); });
    const Error disappeared{.code = ErrorCode::not_found,
                            .what = "a file of it disappeared while it was read",
                            .file = request.recording.directory};
    return fail(is_refused ? ExitCode::no_permission : ExitCode::no_input, missing.value_or(disappeared));
}

std::string first_of(const tum::ImageCounts& images) {
    return images.first_without_pose ? seconds_text(images.first_without_pose->captured.ns) : "";
}

CounterTable image_table(const tum::DataSetReader& reader, const ReplayOutcome& outcome) {
    const std::uint64_t failed = outcome.depth_errors.size();
    const std::uint64_t left = reader.images_left() - failed;
    const tum::ImageCounts& images = reader.images();
    return {.unit = "depth images",
            .in = images.read + images.without_pose + images.bad.count + failed + left,
            .used = images.read,
            .pending = left,
            .rejected = {{"without_pose", images.without_pose, first_of(images)},
                         {"bad_line", images.bad.count},
                         {"unreadable", failed}},
            .is_balanced = true};
}

CounterTable pose_table(const tum::PoseCounts& poses) {
    return {
        .unit = "camera poses",
        .in = poses.in,
        .used = poses.used,
        .pending = 0,
        .rejected = {{"no_pose", poses.no_pose}, {"bad_line", poses.bad.count}, {"repeated", poses.repeated}},
        .is_balanced = poses.in == poses.used + poses.no_pose + poses.bad.count + poses.repeated};
}

void warn_of_lines(const tum::BadLines& bad, const std::optional<Error>& disorder, std::uint64_t unordered,
                   std::vector<std::string>& warnings) {
    if (bad.first)
        warnings.push_back(
            fmt::format("{}; left out (bad_line: {} in all)", bad.first->message(), bad.count));
    if (disorder)
        warnings.push_back(fmt::format("{}; put in order ({} in all)", disorder->message(), unordered));
}

/// The gap between the poses before and after the first image without a pose.
void warn_of_gap(const tum::DataSetReader& reader, std::vector<std::string>& warnings) {
    const auto& first = reader.images().first_without_pose;
    if (!first || !first->gap || *first->gap <= reader.pose_gap_max())
        return;  // otherwise its pose is unknown
    constexpr double kNsPerMs = 1e6;
    warnings.push_back(fmt::format(
        "{}: the poses before and after it are {:.0f} ms apart, and at most {:.0f} ms are bridged "
        "(camera.data_set.pose_gap_max_ms of a --rig; without_pose: {} images in all)",
        first->image.message(), static_cast<double>(first->gap->count()) / kNsPerMs,
        static_cast<double>(reader.pose_gap_max().count()) / kNsPerMs, reader.images().without_pose));
}

std::vector<std::string> warnings_of(const PlaybackRequest& request, const rig::Camera& camera,
                                     const tum::DataSetReader& reader) {
    std::vector<std::string> warnings;
    const tum::ImageCounts& images = reader.images();
    warn_of_lines(images.bad, images.disorder, images.unordered, warnings);
    const tum::PoseCounts& poses = reader.poses();
    warn_of_lines(poses.bad, poses.disorder, poses.unordered, warnings);
    const std::string set = request.recording.directory.string();
    if (poses.repeated > 0) {
        warnings.push_back(fmt::format("{}: {} poses have the time of the previous pose and were left out",
                                       set, poses.repeated));
    }
    if (poses.no_pose > 0) {
        warnings.push_back(fmt::format(
            "{}: the camera's pose is unknown at {} times (nan, a zero quaternion, or no pose file)", set,
            poses.no_pose));
    }
    warn_of_gap(reader, warnings);
    if (const auto doubt = tum::doubt_units(reader.values(), reader.scale(), camera.depth_min_m))
        warnings.push_back(set + ": " + *doubt);
    return warnings;
}

}  // namespace

bool is_data_set(const RecordingPaths& recording) {
    return !recording.can_log().is_there() && tum::depth_images_of(recording.folder).has_value();
}

Status<AppError> check_data_set(const PlaybackRequest& request) {
    const std::string name =
        "a data set (" + tum::depth_images_of(request.recording.folder).value_or("") + ")";
    return check_options_of_camera(request, request.recording.directory, name);
}

namespace {

Result<tum::DataSetReader, AppError> open_reader(const PlaybackRequest& request,
                                                 const std::optional<rig::Rig>& given) {
    auto reader = tum::DataSetReader::open(request.recording.directory,
                                           given ? given->cameras.front().data_set : rig::DataSetKeys{});
    if (reader) return std::move(*reader);
    AppError error{ExitCode::bad_data, reader.error()};
    const auto files = tum::find_data_set(request.recording.folder);
    if (!files) return unexpected(std::move(error));
    for (const std::string& name : {files->poses, files->images}) {
        if (name.empty()) continue;
        const fs::path file = request.recording.directory / name;
        std::error_code ignored;
        if (!fs::exists(file, ignored)) error.exit = ExitCode::no_input;
        error = reading_error(file, std::move(error));
    }
    return unexpected(std::move(error));
}

}  // namespace

Result<Playback, AppError> play_data_set(const PlaybackRequest& request, const ReplayReport& report) {
    if (!request.camera.empty() && request.rig.empty()) {
        if (const auto known = named_camera(request.camera); !known) return unexpected(known.error());
    }
    const auto given = rig_with_camera(request, "a data set");
    if (!given) return unexpected(given.error());
    auto reader = open_reader(request, *given);
    if (!reader) return unexpected(reader.error());
    const auto camera = camera_of(request, *given, *reader);
    if (!camera) return unexpected(camera.error());
    const auto crc32 = checksum_of(request, *reader);
    if (!crc32) return unexpected(crc32.error());
    auto playback = play_camera(request, rig_of_camera(*camera, "data_set"), *crc32, *reader, report);
    if (!playback) return playback;
    playback->outcome.progress.begin = reader->begin();
    playback->inputs.insert(playback->inputs.begin(),
                            {image_table(*reader, playback->outcome), pose_table(reader->poses())});
    playback->warnings = warnings_of(request, *camera, *reader);
    return playback;
}

}  // namespace octoskin
