#include "host/lab/simulation/simulation.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/reading.hpp"
#include "host/apps/recording/recording_draft.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/apps/version/version.hpp"
#include "host/io/candump/log_writer.hpp"
#include "host/io/openni2/oni_writer.hpp"
#include "host/io/robot/surface_reader.hpp"
#include "host/lab/simulation/scene.hpp"
#include "host/lab/simulation/scene_files.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/arm/body.hpp"

namespace octoskin {
namespace {

/// The input files, read before the simulation starts.
struct Inputs {
    Scene scene;
    rig::Rig rig;
    sim::Arm arm;
    sim::Body body;  ///< the true body: meshes where the rig has capsules fitted to them; no padding
};

/// `given`: the rig before its robot was fitted.
Result<sim::Body, AppError> true_body(rig::Rig given, const std::vector<PackagePath>& packages) {
    const auto robot = robot_to_fit(given);
    if (!robot) return unexpected(robot.error());
    std::vector<sim::LinkMesh> meshes;
    if (*robot) {
        auto surfaces = read_surfaces(**robot, mesh_search(packages));
        if (!surfaces) return unexpected(reading_error(ExitCode::bad_config, surfaces.error()));
        for (LinkSurface& surface : surfaces->meshes)
            meshes.push_back({std::move(surface.link),
                              {std::move(surface.mesh.vertices), std::move(surface.mesh.triangles)}});
        given.urdf = FilePlace::held(std::move(surfaces->urdf), given.urdf);
    }
    auto capsules = rig::real_body(given);
    if (!capsules) return unexpected(reading_error(ExitCode::bad_config, capsules.error()));
    return sim::Body(*std::move(capsules), meshes);
}

Result<Inputs, AppError> read_inputs(const SimulationRequest& request) {
    const auto lock = lock_reading();
    auto scene = read_scene(request.scenario, request.world);
    if (!scene) return unexpected(scene.error());
    report_world_warnings(request, scene->world);
    const auto given = read_given_rig(request.rig, request.robot.urdf);
    if (!given) return unexpected(given.error());
    auto rig = with_fitted_body(*given, request.robot.packages, BodyFitting::if_needed);
    if (!rig) return unexpected(rig.error());
    auto arm = sim::Arm::read(rig->urdf, rig->base_link, rig->joint_names());
    if (!arm) return unexpected(reading_error(ExitCode::bad_config, arm.error()));
    auto body = true_body(*given, request.robot.packages);
    if (!body) return unexpected(body.error());
    rig->T_map_base.pretranslate(scene->scenario.map_shift_m(request.seed));
    return Inputs{std::move(*scene), std::move(*rig), std::move(*arm), std::move(*body)};
}

/// The error with the place of its key, if it has one.
Error located(Error error, const sim::Scenario& scenario) {
    if (error.key.empty()) return error;
    const std::string key = error.key;
    return scenario.error(key, std::move(error));
}

/// The writers of the cameras' depth frames, in the order of the rig.
Result<std::vector<openni2::OniWriter>, Error> create_depth(const RecordingPaths& paths,
                                                            const std::vector<rig::Camera>& cameras) {
    std::vector<openni2::OniWriter> writers;
    if (!cameras.empty() && !cameras.front().name.empty()) {
        const auto folder = paths.file(RecordingPaths::kDepthFolder).make_folder();
        if (!folder) return unexpected(to_error(folder.error()));
    }
    for (const rig::Camera& camera : cameras) {
        auto writer = openni2::OniWriter::create(paths.depth(camera.name), paths.depth_epoch(camera.name),
                                                 {camera.width, camera.height});
        if (!writer) return unexpected(std::move(writer.error()));
        writers.push_back(std::move(*writer));
    }
    return writers;
}

/// Writes the files of the recording. After the first error it writes nothing more and keeps the error.
class Recorder {
  public:
    static Result<Recorder, AppError> create(const RecordingPaths& paths, const rig::Rig& rig) {
        if (const auto copied = copy_file(rig.urdf, paths.robot()); !copied)
            return unexpected(copied.error());
        const std::string rig_text = rig::canonical_text(rig::without_devices(rig), paths.robot().filename());
        if (const auto written = write_text(paths.rig(), rig_text); !written)
            return unexpected(written.error());
        auto log = candump::LogWriter::create(paths.can_log());
        if (!log) return fail(ExitCode::cannot_create, log.error());
        auto depth = create_depth(paths, rig.cameras);
        if (!depth) return fail(ExitCode::cannot_create, depth.error());
        return Recorder(std::move(*log), std::move(*depth));
    }

    void write(const wire::CanFrame& frame, WallTime stamp) {
        if (error_) return;
        if (const auto written = log_.write(stamp, frame); !written) error_ = written.error();
    }
    void write(const sim::CameraImage& image) {
        if (error_) return;
        const auto written = depth_.at(image.camera).write(image.captured, image.depth_mm);
        if (!written) error_ = written.error();
    }
    Status<AppError> close() {
        if (!error_) {
            if (const auto closed = log_.close(); !closed) error_ = closed.error();
        }
        for (openni2::OniWriter& camera : depth_) {
            if (error_) break;
            if (const auto closed = camera.close(); !closed) error_ = closed.error();
        }
        if (error_) return fail(ExitCode::cannot_create, *error_);
        return Done{};
    }

  private:
    Recorder(candump::LogWriter log, std::vector<openni2::OniWriter> depth)
        : log_(std::move(log)), depth_(std::move(depth)) {}

    candump::LogWriter log_;
    std::vector<openni2::OniWriter> depth_;  ///< of each camera of the rig
    std::optional<Error> error_;
};

/// The checksum of the scene's files; empty: the recording does not contain the scene.
Result<std::optional<std::uint32_t>, AppError> record_scene(const Scene& scene, const RecordingPaths& paths,
                                                            const SimulationRequest& request) {
    const auto lock = lock_reading();
    const auto gap = write_scene(scene, paths, request.on_world_warning);
    if (!gap) return unexpected(gap.error());
    if (!*gap) return crc32_of_scene(paths);
    if (request.on_scene_gap) request.on_scene_gap(**gap);
    return std::optional<std::uint32_t>();
}

/// The remedy that the command has and an import does not.
AppError with_force(AppError error, const SimulationRequest& request) {
    const bool can_force = !request.may_replace && error.error.code == ErrorCode::already_exists;
    if (can_force)
        error.error = with_remedy(std::move(error.error), "--force to replace a simulated recording");
    return error;
}

}  // namespace

void report_world_warnings(const SimulationRequest& request, const sim::World& world) {
    if (!request.on_world_warning) return;
    for (const std::string& warning : world.warnings()) request.on_world_warning(warning);
}

Result<sim::ExperimentSummary, AppError> simulate_recording(const SimulationRequest& request,
                                                            const std::function<void(double)>& on_progress) {
    if (const auto checked = RecordingDraft::check(request.out, request.may_replace); !checked)
        return unexpected(with_force(checked.error(), request));
    auto inputs = read_inputs(request);
    if (!inputs) return unexpected(inputs.error());
    auto draft = RecordingDraft::create(request.out, request.may_replace);
    if (!draft) return unexpected(with_force(draft.error(), request));
    auto recorder = Recorder::create(draft->paths(), inputs->rig);
    if (!recorder) return unexpected(recorder.error());
    const auto scene_crc32 = record_scene(inputs->scene, draft->paths(), request);
    if (!scene_crc32) return unexpected(scene_crc32.error());

    const sim::ExperimentInput input{.rig = inputs->rig,
                                     .body = inputs->body,
                                     .world = inputs->scene.world,
                                     .arm = inputs->arm,
                                     .scenario = inputs->scene.scenario,
                                     .seed = request.seed,
                                     .is_depth_noise_free = request.is_depth_noise_free,
                                     .emulated = request.emulated,
                                     .board_starts = request.board_starts,
                                     .motions = inputs->scene.motions};
    const sim::ExperimentOutput output{
        .on_frame = [&](const wire::CanFrame& frame, WallTime stamp) { recorder->write(frame, stamp); },
        .on_depth = [&](const sim::CameraImage& image) { recorder->write(image); },
        .on_progress = on_progress};
    if (on_progress) on_progress(0.0);
    const auto summary = sim::run_experiment(input, output);
    if (!summary) return fail(ExitCode::bad_config, located(summary.error(), inputs->scene.scenario));
    if (const auto closed = recorder->close(); !closed) return unexpected(closed.error());

    const RecordingMeta meta{.made_by = program_version(),
                             .source = "simulation",
                             .world = inputs->scene.world_file,
                             .scenario = inputs->scene.scenario_file,
                             .rig = source_file(request.rig, inputs->rig.extended_files),
                             .seed = request.seed,
                             .is_depth_noise_free = request.is_depth_noise_free,
                             .scene_crc32 = *scene_crc32,
                             .can_frames = summary->can_frames,
                             .depth_frames = summary->depth_frames,
                             .duration_s = summary->duration_s};
    if (const auto written = write_meta(draft->paths(), meta); !written) {
        return fail(ExitCode::cannot_create, written.error());
    }
    if (const auto committed = draft->commit(); !committed) return unexpected(committed.error());
    return *summary;
}

}  // namespace octoskin
