#include "host/apps/playback/camera_alone.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/reading.hpp"
#include "host/apps/version/version.hpp"
#include "host/core/pipeline/can_source.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "host/io/tum/data_set_camera.hpp"
#include "hw/rigfile/joined.hpp"

namespace octoskin {

rig::Camera camera_with(const CameraIntrinsics& intrinsics) {
    rig::Camera camera;
    camera.width = intrinsics.width;
    camera.height = intrinsics.height;
    camera.fx = intrinsics.fx;
    camera.fy = intrinsics.fy;
    camera.cx = intrinsics.cx;
    camera.cy = intrinsics.cy;
    camera.rate_hz = 30.0;
    return camera;
}

Result<rig::Camera, AppError> named_camera(std::string_view name) {
    if (const auto found = tum::data_set_camera(name)) return camera_with(*found);
    return fail(ExitCode::usage,
                {.code = ErrorCode::unknown_word,
                 .what = "expected a data set's camera, one of " + rig::joined(tum::kDataSetCameras),
                 .value = "'" + std::string(name) + "'",
                 .key = "--camera"});
}

namespace {

/// A rig that names its camera takes this name; another one decides by itself.
AppError unnamed_camera(const PlaybackRequest& request) {
    return {ExitCode::usage,
            {.code = ErrorCode::conflict,
             .what = "expected only one of --camera and --rig: the rig has one camera, "
                     "without a name",
             .value = "'" + request.camera + "'",
             .remedy = "omit --rig or --camera",
             .file = request.rig,
             .key = "--camera"}};
}

AppError unknown_camera(const PlaybackRequest& request, const std::vector<rig::Camera>& cameras) {
    std::vector<std::string> names;
    for (const rig::Camera& camera : cameras) names.push_back(camera.name);
    const bool is_given = !request.camera.empty();
    return {ExitCode::usage,
            {.code = is_given ? ErrorCode::unknown_word : ErrorCode::bad_argument,
             .what = "expected the name of one of the rig's cameras: " + rig::joined(names),
             .value = is_given ? "'" + request.camera + "'" : "none",
             .remedy = "give --camera " + names.front(),
             .file = request.rig,
             .key = "--camera"}};
}

/// Leaves the rig one camera. It must have one.
Status<AppError> choose_camera(const PlaybackRequest& request, std::vector<rig::Camera>& cameras) {
    if (cameras.size() == 1 && request.camera.empty()) return Done{};
    if (cameras.front().name.empty()) return unexpected(unnamed_camera(request));
    const auto named = std::ranges::find(cameras, request.camera, &rig::Camera::name);
    if (named == cameras.end()) return unexpected(unknown_camera(request, cameras));
    cameras = {rig::Camera(*named)};
    return Done{};
}

}  // namespace

Result<std::optional<rig::Rig>, AppError> rig_with_camera(const PlaybackRequest& request,
                                                          const std::string& seen) {
    if (request.rig.empty()) return std::optional<rig::Rig>{};
    const auto lock = lock_reading();
    auto rig = read_given_rig(request.rig);
    if (!rig) return unexpected(rig.error());
    if (rig->cameras.empty()) {
        return fail(ExitCode::bad_config, {.code = ErrorCode::missing_key,
                                           .what = "expected the camera of " + seen,
                                           .value = "none",
                                           .remedy = "add it, or give another --rig",
                                           .file = request.rig,
                                           .key = "camera"});
    }
    if (const auto chosen = choose_camera(request, rig->cameras); !chosen) return unexpected(chosen.error());
    return std::optional(std::move(*rig));
}

Status<AppError> check_options_of_camera(const PlaybackRequest& request, const std::filesystem::path& file,
                                         const std::string& kind) {
    if (!request.robot.urdf.empty()) {
        return fail(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                      .what = kind + " has no robot",
                                      .remedy = "omit --robot",
                                      .file = file,
                                      .key = "--robot"});
    }
    return Done{};
}

rig::Rig rig_of_camera(const rig::Camera& camera, const std::string& name) {
    rig::Rig rig;
    rig.name = name;
    rig.base_link = "map";
    rig::Camera& only = rig.cameras.emplace_back(camera);
    only.name.clear();
    only.device.clear();
    only.link.clear();  // there is no robot: each image has its own pose
    return rig;
}

namespace {

namespace fs = std::filesystem;

class NoBus final : public CanSource {
  public:
    [[nodiscard]] Result<std::optional<StampedFrame>, Error> next() override {
        return std::optional<StampedFrame>{};
    }
};

MapOrigin origin_of(const PlaybackRequest& request, const rig::Rig& rig, std::uint32_t crc32) {
    const auto absolute = [](const fs::path& path) { return fs::absolute(path).lexically_normal(); };
    return {.made_by = program_version(),
            .recording = absolute(request.recording.directory),
            .recording_crc32 = crc32,
            .rig = request.rig.empty() ? fs::path("-") : absolute(request.rig),
            .rig_hash = rig::rig_hash(rig),
            .robot = "-",
            .robot_crc32 = std::nullopt,
            .configuration = request.configuration,
            .mapping = mapping_text(request.mapping),
            .maps = {}};
}

Result<Pipeline, AppError> make_pipeline(const PlaybackRequest& request, const rig::Rig& rig) {
    HostRig host;
    host.name = rig.name;
    host.cameras = {host_camera(rig.cameras.front())};
    // A pipeline requires a robot with at least one joint. This joint never moves and is never used.
    const JointDescription joint{.name = "no_joint",
                                 .parent_link = rig.base_link,
                                 .child_link = "no_link",
                                 .kind = JointKind::continuous,
                                 .limits = {}};
    host.joint_sources = {{.joints = {joint.name}}};
    auto robot = RobotModel::build(rig.base_link, std::span(&joint, 1), host.joint_names());
    if (!robot) {
        return fail(ExitCode::failed,
                    {ErrorCode::self_check, std::string("no robot: ") + describe(robot.error().error)});
    }
    PipelineConfig config;
    config.maps = request.maps;
    auto pipeline = Pipeline::build(host, std::move(*robot), request.mapping, config);
    if (!pipeline) {
        return fail(ExitCode::failed,
                    {ErrorCode::self_check, "no pipeline", "'" + pipeline.error().element + "'"});
    }
    pipeline->set_listener(request.listener);
    return std::move(*pipeline);
}

}  // namespace

Result<Playback, AppError> play_camera(PlaybackRequest request, rig::Rig rig, std::uint32_t crc32,
                                       DepthSource& images, const ReplayReport& report) {
    request.mapping.removes_robot_from_depth = false;  // there is no robot to remove
    auto pipeline = make_pipeline(request, rig);
    if (!pipeline) return unexpected(pipeline.error());
    MapOrigin origin = origin_of(request, rig, crc32);
    NoBus bus;
    PacedDepth paced(images, request.pace);
    ReplayOutcome outcome = replay(*pipeline, bus, {&paced}, report);
    std::vector<CounterTable> inputs = pipeline->counter_tables();
    std::erase_if(inputs, [](const CounterTable& table) { return table.in == 0; });
    return Playback{.rig = std::move(rig),
                    .pipeline = std::move(*pipeline),
                    .outcome = std::move(outcome),
                    .inputs = std::move(inputs),
                    .nodes = {},
                    .notes = {},
                    .warnings = {},
                    .origin = std::move(origin)};
}

}  // namespace octoskin
