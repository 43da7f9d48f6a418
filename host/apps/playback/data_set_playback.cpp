#include "host/apps/playback/data_set_playback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/reading.hpp"
#include "host/apps/version/version.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "host/io/tum/data_set_camera.hpp"
#include "host/io/tum/data_set_reader.hpp"
#include "hw/rigfile/joined.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

class NoBus final : public CanSource {
  public:
    [[nodiscard]] Result<std::optional<StampedFrame>, CanSourceError> next() override {
        return std::optional<StampedFrame>{};
    }
};

Result<rig::Camera, AppError> named_camera(const std::string& name) {
    const auto found = tum::data_set_camera(name.empty() ? tum::kDataSetCameras.front() : name);
    if (!found) {
        return fail(ExitCode::usage, "--camera " + name + ": a data set's camera is one of " +
                                         rig::joined(tum::kDataSetCameras));
    }
    rig::Camera camera;
    camera.width = found->width;
    camera.height = found->height;
    camera.fx = found->fx;
    camera.fy = found->fy;
    camera.cx = found->cx;
    camera.cy = found->cy;
    camera.rate_hz = 30.0;
    return camera;
}

Result<rig::Camera, AppError> camera_of(const PlaybackRequest& request) {
    if (request.rig.empty()) return named_camera(request.camera);
    const auto lock = lock_reading();
    const auto rig = read_given_rig(request.rig);
    if (!rig) return unexpected(rig.error());
    if (!rig->camera) {
        return fail(ExitCode::bad_config,
                    request.rig.string() + ": has no camera, which a data set is seen by");
    }
    return *rig->camera;
}

/// A camera, and nothing else.
rig::Rig make_rig(const rig::Camera& camera) {
    rig::Rig rig;
    rig.name = "data_set";
    rig.base_link = "map";
    rig.camera = camera;
    return rig;
}

Result<Pipeline, AppError> make_pipeline(const PlaybackRequest& request, const rig::Rig& rig) {
    HostRig host;
    host.name = rig.name;
    host.camera = host_camera(*rig.camera);
    // A pipeline has a robot of at least one joint. Nobody moves this one, and nothing asks where it is.
    const JointDescription joint{.name = "no_joint",
                                 .parent_link = rig.base_link,
                                 .child_link = "no_link",
                                 .kind = JointKind::continuous,
                                 .limits = {}};
    host.joints.joints = {joint.name};
    auto robot = RobotModel::build(rig.base_link, std::span(&joint, 1), host.joints.joints);
    if (!robot) return fail(ExitCode::failed, std::string("no robot: ") + describe(robot.error().error));
    PipelineConfig config;
    config.maps = request.maps;
    auto pipeline = Pipeline::build(host, std::move(*robot), request.mapping, config);
    if (!pipeline) return fail(ExitCode::failed, "no pipeline: " + pipeline.error().element);
    pipeline->tell(request.listener);
    return std::move(*pipeline);
}

Result<MapOrigin, AppError> origin_of(const PlaybackRequest& request, const rig::Rig& rig,
                                      const tum::DataSetReader& reader) {
    const auto crc32 = crc32_of(reader.files());
    if (!crc32) {
        const auto missing = reader.missing_image();
        const bool is_refused = std::ranges::any_of(
            reader.files(), [](const FilePlace& file) { return refused_to_read(file).has_value(); });
        return fail(
            is_refused ? ExitCode::no_permission : ExitCode::no_input,
            missing ? missing->what
                    : request.recording.directory.string() + ": a file of it went away while it was read");
    }
    const auto absolute = [](const fs::path& path) { return fs::absolute(path).lexically_normal(); };
    return MapOrigin{.made_by = program_version(),
                     .recording = absolute(request.recording.directory),
                     .recording_crc32 = *crc32,
                     .rig = request.rig.empty() ? fs::path("-") : absolute(request.rig),
                     .rig_hash = rig::rig_hash(rig),
                     .robot = "-",
                     .robot_crc32 = std::nullopt,
                     .configuration = request.configuration,
                     .mapping = mapping_text(request.mapping),
                     .maps = {}};
}

AccountTable image_table(const tum::DataSetReader& reader, const ReplayOutcome& outcome) {
    const std::uint64_t failed = outcome.depth_error ? 1 : 0;
    const std::uint64_t left = reader.images_left() - failed;
    return {.unit = "depth images",
            .in = reader.images_read() + reader.images_without_pose() + failed + left,
            .used = reader.images_read(),
            .pending = left,
            .rejected = {{"without_pose", reader.images_without_pose()}, {"unreadable", failed}},
            .is_balanced = true};
}

std::vector<std::string> warnings_of(const PlaybackRequest& request, const rig::Camera& camera,
                                     const tum::DataSetReader& reader) {
    std::vector<std::string> warnings;
    const tum::DataSetReader::Paths paths{request.recording.directory};
    if (reader.poses_repeated() > 0) {
        warnings.push_back(fmt::format("{}: {} poses have the time of the one above them, and were left out",
                                       paths.poses().string(), reader.poses_repeated()));
    }
    if (const auto doubt = tum::doubt_units(reader.values(), camera.data_set, camera.depth_min_m))
        warnings.push_back(request.recording.directory.string() + ": " + *doubt);
    return warnings;
}

}  // namespace

bool is_data_set(const RecordingPaths& recording) {
    const EntryKind kind = recording.file("depth.txt").kind();
    return (kind == EntryKind::file || kind == EntryKind::link) && !recording.can_log().is_there();
}

Status<AppError> check_data_set(const PlaybackRequest& request) {
    const std::string name = request.recording.directory.string() + ": a data set (depth.txt)";
    if (!request.robot.empty()) return fail(ExitCode::usage, name + " has no robot: without --robot");
    if (!request.rig.empty() && !request.camera.empty())
        return fail(ExitCode::usage, name + " takes --rig or --camera, not both");
    return Done{};
}

Result<Playback, AppError> play_data_set(const PlaybackRequest& request_given, const ReplayReport& report) {
    PlaybackRequest request = request_given;
    request.mapping.removes_robot_from_depth = false;  // there is none
    const auto camera = camera_of(request);
    if (!camera) return unexpected(camera.error());
    rig::Rig rig = make_rig(*camera);
    auto reader = tum::DataSetReader::open(request.recording.directory, camera->data_set);
    if (!reader) {
        AppError error{ExitCode::bad_data, reader.error().what};
        for (const char* name : {"groundtruth.txt", "depth.txt"}) {
            const fs::path file = request.recording.directory / name;
            std::error_code ignored;
            if (!fs::exists(file, ignored)) error.code = ExitCode::no_input;
            error = reading_error(file, std::move(error));
        }
        return unexpected(std::move(error));
    }
    auto origin = origin_of(request, rig, *reader);
    if (!origin) return unexpected(origin.error());
    auto pipeline = make_pipeline(request, rig);
    if (!pipeline) return unexpected(pipeline.error());
    NoBus bus;
    PacedDepth paced(*reader, request.pace);
    ReplayOutcome outcome = replay(*pipeline, bus, &paced, report);
    outcome.progress.begin = reader->begin();
    AccountTable images = image_table(*reader, outcome);
    std::vector<AccountTable> accounts{std::move(images)};
    for (AccountTable& table : pipeline->account_tables()) {
        if (table.in > 0) accounts.push_back(std::move(table));
    }
    return Playback{.rig = std::move(rig),
                    .pipeline = std::move(*pipeline),
                    .outcome = std::move(outcome),
                    .accounts = std::move(accounts),
                    .nodes = {},
                    .notes = {},
                    .warnings = warnings_of(request, *camera, *reader),
                    .is_map_incomplete = false,
                    .origin = std::move(*origin)};
}

}  // namespace octoskin
