#include "host/apps/playback/playback.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "host/apps/playback/data_set_playback.hpp"
#include "host/apps/playback/film_playback.hpp"
#include "host/apps/playback/log_survey.hpp"
#include "host/apps/playback/losses.hpp"
#include "host/apps/playback/ordered_playback.hpp"
#include "host/apps/profile/rig_pipeline.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/reading.hpp"
#include "host/apps/recording/recording_draft.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/apps/version/version.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/rig/camera_text.hpp"
#include "host/core/rig/sensor_text.hpp"
#include "host/io/candump/log_source.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/openni2/oni_reader.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin {
namespace {

struct Setup {
    rig::Rig rig;
    HostSetup host;
};

Result<Setup, AppError> read_setup(const PlaybackRequest& request) {
    const auto lock = lock_reading();
    const bool is_robot_absent =
        request.rig.empty() && request.robot.urdf.empty() && !request.recording.robot().is_there();
    auto rig = read_rig_with_body(request.rig.empty() ? request.recording.rig() : request.rig, request.robot,
                                  BodyFitting::if_needed,
                                  is_robot_absent ? ExitCode::no_input : ExitCode::bad_config);
    if (!rig) return unexpected(rig.error());
    auto host = make_host_setup(*rig);
    if (!host) return unexpected(reading_error(ExitCode::bad_config, host.error()));
    return Setup{std::move(*rig), std::move(*host)};
}

Result<candump::LogReader, AppError> open_reader(const RecordingPaths& recording) {
    auto reader = candump::LogReader::open(recording.can_log());
    if (!reader) return unexpected(reading_error(ExitCode::no_input, reader.error()));
    return std::move(*reader);
}

/// Reads the log before the replay: up to its first START, or to its end.
Status<AppError> survey_log(const RecordingPaths& recording, LogSurvey& survey) {
    auto reader = open_reader(recording);
    if (!reader) return unexpected(reader.error());
    while (!survey.is_complete()) {
        const auto entry = reader->next();
        if (!entry) return unexpected(reading_error(ExitCode::bad_data, entry.error()));
        if (!*entry) {
            if (const auto foreign = reader->foreign_file()) return fail(ExitCode::bad_data, *foreign);
            break;
        }
        survey.take(**entry);
    }
    return Done{};
}

Result<candump::LogSource, AppError> open_log(const RecordingPaths& recording, const std::string& interface) {
    auto reader = open_reader(recording);
    if (!reader) return unexpected(reader.error());
    return candump::LogSource(std::move(*reader), interface);
}

/// A camera's depth frames in the recording. If they cannot be read, that is a camera fault: the rest is
/// mapped nevertheless.
struct DepthInput {
    std::string camera;                        ///< its name
    std::optional<openni2::OniReader> reader;  ///< empty: there are none
    std::optional<Error> error;
};

DepthInput open_depth(const RecordingPaths& recording, const std::string& camera) {
    if (!recording.depth(camera).is_there()) return {camera, std::nullopt, std::nullopt};
    auto reader = openni2::OniReader::open(recording.depth(camera), recording.depth_epoch(camera));
    if (!reader) return {camera, std::nullopt, reader.error()};
    return {camera, std::move(*reader), std::nullopt};
}

/// Of each camera of the rig. Without one, a depth.oni is read nevertheless, and its frames are refused.
std::vector<DepthInput> open_depths(const RecordingPaths& recording, const HostRig& rig) {
    std::vector<DepthInput> inputs;
    for (const HostCamera& camera : rig.cameras) inputs.push_back(open_depth(recording, camera.name));
    if (rig.cameras.empty()) inputs.push_back(open_depth(recording, ""));
    return inputs;
}

DepthSources sources_of(std::vector<DepthInput>& inputs) {
    DepthSources sources;
    for (DepthInput& input : inputs) sources.push_back(input.reader ? &*input.reader : nullptr);
    return sources;
}

CounterTable line_table(const candump::LogSource& log) {
    const auto line = [](std::int64_t number) { return "can.log:" + std::to_string(number); };
    CounterTable table = tabulate("log lines", log.reader().inputs(), 0, line);
    table.used -= log.other_interface();
    table.rejected.push_back({"other_interface", log.other_interface()});
    return table;
}

/// Counts of the pixels of the used depth frames, by their use.
CounterTable pixel_table(const DepthStage& depth) {
    const DepthPixelCounts& pixels = depth.pixels();
    const std::uint64_t robot = depth.robot_pixels();
    CounterTable table{.unit = "depth pixels",
                       .of = depth.camera().name,
                       .in = pixels.used + pixels.no_value + pixels.bad_value + pixels.outside_map,
                       .used = pixels.used,
                       .pending = 0,
                       .rejected = {{"no_value", pixels.no_value - robot},
                                    {"robot", robot},
                                    {"bad_value", pixels.bad_value},
                                    {"outside_map", pixels.outside_map}},
                       .is_balanced = robot <= pixels.no_value};
    return table;
}

Result<MapOrigin, AppError> origin_of(const PlaybackRequest& request, const rig::Rig& rig) {
    const auto absolute = [](const std::filesystem::path& path) {
        return std::filesystem::absolute(path).lexically_normal();
    };
    const auto crc32 = crc32_of_recording(request.recording, request.on_checksum);
    if (!crc32) {
        std::vector<FilePlace> files{request.recording.can_log()};
        for (const std::string& camera : request.recording.cameras())
            files.push_back(request.recording.depth(camera));
        for (const FilePlace& file : files) {
            const auto opened = file.open();
            if (!opened && opened.error().fault != FolderFault::absent)
                return fail(ExitCode::bad_data, to_error(opened.error()));
        }
        return fail(ExitCode::bad_data,
                    in_file({ErrorCode::system_error, "cannot be read"}, request.recording.directory));
    }
    return MapOrigin{.made_by = program_version(),
                     .recording = absolute(request.recording.directory),
                     .recording_crc32 = *crc32,
                     .rig = absolute(request.rig.empty() ? request.recording.rig().shown() : request.rig),
                     .rig_hash = rig::rig_hash(rig),
                     .robot = absolute(rig.urdf.shown()),
                     .robot_crc32 = crc32_of(rig.urdf),
                     .configuration = request.configuration,
                     .mapping = mapping_text(request.mapping),
                     .maps = {}};
}

std::vector<std::string> take_notes(const Pipeline& pipeline) {
    std::vector<std::string> notes;
    const HostClockEstimate& clock = pipeline.intake().host_clock();
    if (clock.steps_back() + clock.steps_ahead() + clock.stamps_ignored() > 0) {
        notes.push_back("time stamps of the log: " + std::to_string(clock.steps_back()) + " steps back, " +
                        std::to_string(clock.steps_ahead()) + " ahead, " +
                        std::to_string(clock.stamps_ignored()) + " that did not fit");
    }
    return notes;
}

std::string without_depth(const std::string& camera) {
    const std::string file = RecordingPaths::depth_name(camera, ".oni");
    if (camera.empty())
        return "the rig has a camera, but the recording has no " + file + ": only the ranges are mapped";
    return "the rig has a " + camera_text(camera) + ", but the recording has no " + file +
           ": the map is made without its images";
}

std::string without_camera(const HostRig& rig, const std::string& camera) {
    const bool is_in_list = camera.empty() && !rig.cameras.empty();
    const std::string missing = is_in_list ? "camera without a name" : camera_text(camera);
    return "the recording has a " + RecordingPaths::depth_name(camera, ".oni") + ", but the rig has no " +
           missing + ": its frames are not used";
}

/// Cameras of the rig without depth frames, and depth frames without a camera in the rig.
void find_missing_depth(const RecordingPaths& recording, const HostRig& rig,
                        const std::vector<DepthInput>& depths, std::vector<std::string>& warnings) {
    for (const DepthInput& depth : depths) {
        if (!rig.cameras.empty() && !depth.reader && !depth.error)
            warnings.push_back(without_depth(depth.camera));
    }
    for (const std::string& camera : recording.cameras()) {
        if (std::ranges::find(rig.cameras, camera, &HostCamera::name) == rig.cameras.end())
            warnings.push_back(without_camera(rig, camera));
    }
}

void find_missing_frames(const RecordingMeta& meta, Playback& playback) {
    const auto frames = playback.outcome.progress.can_frames;
    if (!playback.nodes.empty() && frames < meta.can_frames) {
        playback.warnings.push_back("can.log: " + std::to_string(frames) + " frames, but meta.yaml states " +
                                    std::to_string(meta.can_frames) + ": part of the log is missing");
    }
}

/// "camera 'left': ", or nothing for a rig's only camera.
std::string before_text_of(const std::string& camera) {
    return camera.empty() ? "" : camera_text(camera) + ": ";
}

/// Sensors that contradict a camera: exchanged cables, a stuck value, or a wrong pose in the rig.
void find_contradictions(const HostRig& rig, Playback& playback) {
    const CrossChecks* const checks = playback.pipeline.builder().cross_checks();
    if (checks == nullptr) return;
    for (std::size_t camera = 0; camera < checks->cameras(); ++camera) {
        if (const auto fault = checks->pose_fault(camera))
            playback.warnings.push_back(describe(*fault, rig.joint_names(), rig.cameras[camera].name));
    }
    for (const HostNode& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            const auto found = checks->finding(node.node_id, static_cast<std::uint8_t>(i));
            if (!found.evidence.contradicts()) continue;
            playback.warnings.push_back(before_text_of(rig.cameras[found.camera].name) +
                                        sensor_text(node, i) + ": " + describe(found.evidence));
        }
    }
}

/// Images that do not have the size of the given camera.
void find_wrong_sizes(const DepthStage& stage, Playback& playback) {
    if (stage.wrong_size().frames == 0) return;
    const auto& [frames, width, height] = stage.wrong_size();
    const CameraIntrinsics& camera = stage.camera().intrinsics;
    playback.warnings.push_back(before_text_of(stage.camera().name) + std::to_string(frames) +
                                " depth images are " + std::to_string(width) + " x " +
                                std::to_string(height) + ", the camera's are " +
                                std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                                " (wrong_size): give a --rig whose camera has their width_px and height_px, "
                                "and intrinsics for that size");
}

/// The pixels of each camera, and images of a wrong size.
void take_images(Playback& playback) {
    const MapBuilder& builder = playback.pipeline.builder();
    for (std::size_t camera = 0; camera < builder.cameras(); ++camera) {
        playback.inputs.push_back(pixel_table(builder.depth_stage(camera)));
        find_wrong_sizes(builder.depth_stage(camera), playback);
    }
}

void find_full_maps(Playback& playback) {
    for (const auto& [feed, map] : playback.pipeline.maps()) {
        const std::uint64_t no_room = map.counters().no_room;
        if (no_room == 0) continue;
        const bool is_as_daemons = feed == MapFeed::both && playback.is_as_full_as_daemons;
        playback.is_map_incomplete |= !is_as_daemons;
        playback.warnings.push_back(
            std::string(name_of(feed)) + ": " + std::to_string(no_room) + " updates of voxels found no room" +
            (is_as_daemons ? ", as in the daemon" : "") + "; raise map.memory_max_mib in the mapping file");
    }
}

Result<Pipeline, AppError> make_pipeline(const PlaybackRequest& request, Setup& setup, MapBegin begin,
                                         const IntakeConfig& intake = {}) {
    PipelineConfig config;
    config.maps = request.maps;
    config.begin = begin;
    config.intake = intake;
    const std::filesystem::path rig_file =
        request.rig.empty() ? request.recording.rig().shown() : request.rig;
    auto pipeline = build_pipeline(rig_file.string(), setup.host.rig, std::move(setup.host.robot),
                                   request.mapping, config);
    if (!pipeline) return unexpected(pipeline.error());
    pipeline->set_listener(request.listener);
    return std::move(*pipeline);
}

/// Plays the log of the bus through the whole pipeline.
Result<Playback, AppError> play_log(const PlaybackRequest& request, Setup& setup, const DepthSources& depth,
                                    MapOrigin origin, const ReplayReport& report) {
    LogSurvey first(setup.host.rig);
    if (const auto read = survey_log(request.recording, first); !read) return unexpected(read.error());
    const Nanoseconds grain = first.stamp_grain();
    const IntakeConfig intake = first.intake_for_stamps();
    std::optional<LogSurvey> again;  // a second survey with the intake for coarse time stamps, which decides
                                     // whether a START is used
    if (grain.count() > 0) {
        again.emplace(setup.host.rig, intake);
        if (const auto read = survey_log(request.recording, *again); !read) return unexpected(read.error());
    }
    const LogSurvey& survey = again ? *again : first;
    auto log = open_log(request.recording, survey.interface());
    if (!log) return unexpected(log.error());
    auto pipeline = make_pipeline(request, setup, survey.begin(), intake);
    if (!pipeline) return unexpected(pipeline.error());
    PacedCan paced(*log, request.pace);
    ReplayOutcome outcome = replay(*pipeline, paced, depth, report);
    Playback playback{.rig = std::move(setup.rig),
                      .pipeline = std::move(*pipeline),
                      .outcome = std::move(outcome),
                      .inputs = {},
                      .nodes = {},
                      .notes = {},
                      .warnings = {},
                      .origin = std::move(origin)};
    playback.inputs.push_back(line_table(*log));
    for (CounterTable& table : playback.pipeline.counter_tables())
        playback.inputs.push_back(std::move(table));
    playback.nodes = summarise(playback.pipeline.intake());
    playback.notes = take_notes(playback.pipeline);
    if (auto warning = survey.warning()) playback.warnings.push_back(std::move(*warning));
    if (auto warning = describe_stamps(grain)) playback.warnings.push_back(std::move(*warning));
    return playback;
}

/// The time at which can.log begins in a replay by capture time; empty if nothing in the log gives the time.
std::optional<HostTime> begin_of_log(const RecordingPaths& recording, const HostRig& rig) {
    auto log = open_log(recording, "");
    CanIntake intake(rig);
    while (log && !intake.now()) {
        const auto entry = log->next();
        if (!entry || !*entry) break;
        (void)intake.on_frame((*entry)->frame, (*entry)->stamp);
    }
    return intake.host_clock().begun();
}

/// Plays in the daemon's own order, without the steps that determined that order.
Result<Playback, AppError> play_order(const PlaybackRequest& request, Setup& setup, const DepthSources& depth,
                                      MapOrigin origin, const ReplayReport& report) {
    auto pipeline = make_pipeline(request, setup, MapBegin::first_usable);
    if (!pipeline) return unexpected(pipeline.error());
    auto played = play_in_order(request, setup.rig, *pipeline, depth,
                                begin_of_log(request.recording, setup.host.rig), report);
    if (!played) return unexpected(played.error());
    const OrderedOutcome& order = played->outcome;
    ReplayOutcome outcome{.progress = {order.commits, order.depth_frames.in(), order.begin, order.now},
                          .can_error = order.order_error,
                          .depth_errors = order.depth_errors};
    return Playback{.rig = std::move(setup.rig),
                    .pipeline = std::move(*pipeline),
                    .outcome = std::move(outcome),
                    .inputs = std::move(played->inputs),
                    .nodes = {},
                    .notes = std::move(played->notes),
                    .warnings = std::move(played->warnings),
                    .origin = std::move(origin),
                    .is_as_full_as_daemons = played->has_daemons_mapping,
                    .is_unlike_daemons = played->is_unlike_daemons};
}

/// The error of an empty map.
Error nothing_mapped(const Playback& playback, std::string_view where_the_counters_are) {
    Error error{ErrorCode::no_content, "no measurement entered the map"};
    const CounterTable& first_table = playback.inputs.front();
    if (first_table.unit == "log lines" && first_table.in == 0) {
        error.what += ", because can.log is empty";
    } else if (playback.losses.empty()) {
        error.remedy = where_the_counters_are;
    } else {
        const Loss& first = playback.losses.front();
        error.what += ": " + std::to_string(first.rejected) + " of " + std::to_string(first.of) + " " +
                      first.title + " are not used, most as " + first.reason;
        error.remedy = "see the warnings above";
    }
    return error;
}

/// There is at least one.
AppError unread_depths(const std::vector<Error>& errors) {
    AppError first = unread_depth(errors.front());
    for (const Error& other : std::span(errors).subspan(1)) {
        std::string& others = first.error.others;
        others.append(others.empty() ? "" : ". ").append(other.message());
    }
    return first;
}

}  // namespace

std::optional<AppError> failure_of(const Playback& playback, std::string_view where_the_counters_are) {
    if (const auto& failed = playback.outcome.can_error) return AppError{ExitCode::bad_data, *failed};
    if (const auto& failed = playback.outcome.depth_errors; !failed.empty()) return unread_depths(failed);
    const bool is_balanced =
        playback.pipeline.is_balanced() && std::all_of(playback.inputs.begin(), playback.inputs.end(),
                                                       [](const auto& table) { return table.is_balanced; });
    if (!is_balanced)
        return AppError{ExitCode::failed, {ErrorCode::self_check, "the input counters do not balance"}};
    if (playback.is_map_incomplete) {
        return AppError{ExitCode::failed,
                        {.code = ErrorCode::too_large,
                         .what = "the map is not complete: it had no room for some voxels",
                         .remedy = "raise map.memory_max_mib in the mapping file"}};
    }
    if (playback.pipeline.map().known_voxels() == 0)
        return AppError{ExitCode::failed, nothing_mapped(playback, where_the_counters_are)};
    return std::nullopt;
}

std::optional<AppError> loss_of(const Playback& playback) {
    const auto lost = std::ranges::find_if(playback.losses, &Loss::is_mendable);
    if (lost == playback.losses.end()) return std::nullopt;
    return AppError{ExitCode::failed,
                    {.code = ErrorCode::no_data,
                     .what = "most of the " + lost->title + " is lost (" + lost->reason + ")",
                     .remedy = "see the warning above for the remedy"}};
}

Status<AppError> check_playable(const PlaybackRequest& request) {
    const bool is_lone_film = lone_film(request.recording).has_value();
    if (request.T_map_camera && !is_lone_film) {
        return fail(ExitCode::usage,
                    {.code = ErrorCode::bad_argument,
                     .what = "is for an .oni file without a can.log; this folder has camera poses of its own",
                     .remedy = "omit --pose",
                     .file = request.recording.directory,
                     .key = "--pose"});
    }
    if (is_data_set(request.recording)) return check_data_set(request);
    if (is_lone_film) return check_film(request);
    if (const auto checked = check_recording(request.recording, !request.rig.empty()); !checked)
        return unexpected(reading_error(ExitCode::no_input, checked.error()));
    const RecordingPaths& recording = request.recording;
    std::vector<FilePlace> files{recording.can_log(), recording.meta(), recording.order(),
                                 recording.first_map(), recording.first_state()};
    for (const std::string& camera : recording.cameras()) {
        files.push_back(recording.depth(camera));
        files.push_back(recording.depth_epoch(camera));
    }
    for (const FilePlace& file : files) {
        if (auto refused = refused_to_read(file)) return unexpected(std::move(*refused));
    }
    return Done{};
}

namespace {

/// The errors of files that could not be opened, and of those that failed while they were read.
void take_depth_errors(const HostRig& rig, const std::vector<DepthInput>& depths, ReplayOutcome& outcome) {
    std::vector<Error> errors;
    for (const DepthInput& depth : depths)
        if (depth.error) errors.push_back(*depth.error);
    errors.insert(errors.end(), outcome.depth_errors.begin(), outcome.depth_errors.end());
    const bool is_named = !rig.cameras.empty() && !rig.cameras.front().name.empty();
    const std::string remedy = is_named ? "to map without this camera, move its .oni and .epoch.yaml away"
                                        : "to map the ranges alone, move depth.oni and depth.epoch.yaml away";
    outcome.depth_errors.clear();
    for (const Error& error : errors) outcome.depth_errors.push_back(with_remedy(error, remedy));
}

Result<Playback, AppError> play_robot(const PlaybackRequest& request, const ReplayReport& report) {
    const auto meta = read_meta(request.recording);
    if (!meta) return unexpected(reading_error(ExitCode::bad_data, meta.error()));
    auto setup = read_setup(request);
    if (!setup) return unexpected(setup.error());
    const HostRig& rig = setup->host.rig;
    auto origin = origin_of(request, setup->rig);
    if (!origin) return unexpected(origin.error());
    std::vector<std::string> rig_warnings = std::move(setup->host.warnings);
    if (request.warn_first) {
        for (const std::string& warning : std::exchange(rig_warnings, {})) request.warn_first(warning);
    }
    std::vector<DepthInput> depths = open_depths(request.recording, rig);
    const auto play = is_played_in_order(request) ? play_order : play_log;
    auto playback = play(request, *setup, sources_of(depths), std::move(*origin), report);
    if (!playback) return playback;
    take_depth_errors(rig, depths, playback->outcome);
    for (const DepthInput& depth : depths) {
        if (auto loss = depth.reader ? depth.reader->loss() : std::nullopt)
            playback->warnings.push_back(std::move(*loss));
    }
    playback->warnings.insert(playback->warnings.begin(), rig_warnings.begin(), rig_warnings.end());
    playback->notes.insert(playback->notes.begin(), setup->host.notes.begin(), setup->host.notes.end());
    find_missing_frames(*meta, *playback);
    find_missing_depth(request.recording, rig, depths, playback->warnings);
    find_contradictions(rig, *playback);
    return playback;
}

}  // namespace

Result<Playback, AppError> play_recording(const PlaybackRequest& request, const ReplayReport& report) {
    if (const auto checked = check_playable(request); !checked) return unexpected(checked.error());
    const auto play = is_data_set(request.recording) ? play_data_set
                      : lone_film(request.recording) ? play_film
                                                     : play_robot;
    std::optional<FileLock> lock;  // only for a folder: a film can be a file
    if (std::filesystem::is_directory(request.recording.directory)) {
        auto locked = lock_recording(request.recording);
        if (!locked) return unexpected(locked.error());
        lock.emplace(std::move(*locked));
    }
    auto playback = play(request, report);
    if (!playback) return playback;
    take_images(*playback);
    find_full_maps(*playback);
    find_losses(*playback);
    return playback;
}

}  // namespace octoskin
