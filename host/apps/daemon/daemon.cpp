#include "host/apps/daemon/daemon.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/camera_feed.hpp"
#include "host/apps/daemon/can_link.hpp"
#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/joint_socket.hpp"
#include "host/apps/daemon/latency.hpp"
#include "host/apps/daemon/map_keeper.hpp"
#include "host/apps/daemon/record_requests.hpp"
#include "host/apps/daemon/status.hpp"
#include "host/apps/study/configuration.hpp"
#include "host/core/ingest/local_joints.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/time/sync_master.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "host/io/socketcan/our_filters.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {
namespace {

constexpr std::chrono::milliseconds kAttendPeriod{50};
constexpr Nanoseconds kSavePatience{4'500'000'000};
constexpr std::chrono::milliseconds kCameraSilenceMax{2'000};
/// Frames taken in one go before others have a turn.
constexpr int kFramesPerTurn = 256;

/// What the files say.
struct Settings {
    HostSetup host;
    MappingConfig mapping;
    RecordedSettings recorded;
};

/// The same as text, for recordings.
Result<RecordedSettings, AppError> recorded_settings(const rig::Rig& rig, const MappingConfig& mapping,
                                                     const std::string& interface) {
    std::ifstream robot(rig.urdf, std::ios::binary);
    RecordedSettings recorded{.rig = rig::canonical_text(rig, "robot.urdf"),
                              .robot = {std::istreambuf_iterator<char>(robot), {}},
                              .mapping = mapping_text(mapping),
                              .rig_hash = rig::rig_hash(rig),
                              .joints = rig.joints.joints.size(),
                              .interface = interface};
    if (!robot) return fail(ExitCode::bad_config, rig.urdf.string() + ": cannot be read");
    return recorded;
}

Result<Settings, AppError> read_settings(const DaemonRequest& request) {
    const auto configuration = study_configuration(request.configuration);
    if (!configuration) return unexpected(configuration.error());
    const auto rig = rig::read_rig(request.rig, request.robot);
    if (!rig) return fail(ExitCode::bad_config, rig.error().message());
    auto host = make_host_setup(*rig);
    if (!host) return fail(ExitCode::bad_config, host.error().message());
    auto recorded = recorded_settings(*rig, configuration->mapping, request.interface);
    if (!recorded) return unexpected(recorded.error());
    return Settings{std::move(host).value(), configuration->mapping, std::move(recorded).value()};
}

Result<Pipeline, AppError> make_pipeline(const DaemonRequest& request, const Settings& settings) {
    PipelineConfig config;
    config.maps = {.depth = false, .proximity = false, .fused = true};
    config.release = Release::once_placed;
    auto pipeline = Pipeline::build(settings.host.rig, settings.host.robot, settings.mapping, config);
    if (pipeline) return std::move(pipeline).value();
    return fail(ExitCode::bad_config, request.rig.string() + ": the robot has no '" +
                                          pipeline.error().element + "' that the rig speaks of");
}

CanLink::Opener opener(const DaemonRequest& request, const HostRig& rig) {
    if (request.can_descriptor) {
        return [descriptor = *request.can_descriptor, name = request.interface,
                is_open = false]() mutable -> Result<socketcan::CanSocket, socketcan::SocketFault> {
            if (std::exchange(is_open, true))
                return unexpected(socketcan::SocketFault{name, ENODEV, "closed by the other end"});
            return socketcan::CanSocket(name, descriptor, true);
        };
    }
    return [interface = request.interface, filters = socketcan::our_filters(rig)] {
        return socketcan::CanSocket::open(interface, {.filters = filters, .hears_itself = true});
    };
}

}  // namespace

/// What lives while the daemon does. The loop comes first: whatever watches through it goes before it.
struct Daemon::Parts {
    Parts(DaemonRequest request_in, Settings settings_in, Pipeline pipeline_in)
        : request(std::move(request_in)),
          settings(std::move(settings_in)),
          pipeline(std::move(pipeline_in)),
          can(opener(request, settings.host.rig), [this] { can_ready = EventSource(); }),
          local_joints(settings.host.rig.joints.node_id, settings.host.rig.joints.joints.size()),
          keeper(request.map_folder),
          started(monotonic_now()) {}

    Status<AppError> take_sockets();
    void watch();
    void attend();
    void drain_can();
    void take_frame(const socketcan::Received& received);
    void answer_sync(const socketcan::Received& received, HostTime at);
    void learn_shift(const socketcan::Received& received);
    void feed(const wire::CanFrame& frame, WallTime stamp);
    void drain_joints();
    void drain_camera();
    void save_map();
    void reload();
    void note_used(HostTime now);
    void tell_changes();
    [[nodiscard]] DaemonView view() const;
    std::string answer(const std::string& request_line);

    DaemonRequest request;
    Settings settings;
    EventLoop loop;
    EventSource can_ready;
    Pipeline pipeline;
    CanLink can;
    SyncMaster sync;
    LocalJoints local_joints;
    MapKeeper keeper;
    std::optional<JointSocket> joints;
    std::unique_ptr<CameraFeed> camera;
    std::unique_ptr<ControlSocket> control;
    RecordRequests recordings;
    LatencyHistogram latency;
    HostTime started;
    std::string reload_error;
    std::optional<HostTime> foreign_sync;  ///< the newest of another host, on this machine's clock
    std::uint8_t foreign_sequence = 0;
    Nanoseconds shift{0};  ///< from this machine's clock to the one that SYNC tells
    std::vector<std::string> problems_told;
    LastUsed last_used;
    std::array<std::uint64_t, 3> used_counts{};  ///< joint samples, readings, depth frames

    std::vector<EventSource> sources;
};

Result<std::unique_ptr<Daemon>, AppError> Daemon::build(const DaemonRequest& request) {
    auto settings = read_settings(request);
    if (!settings) return unexpected(settings.error());
    auto pipeline = make_pipeline(request, *settings);
    if (!pipeline) return unexpected(pipeline.error());
    auto parts = std::make_unique<Parts>(request, std::move(settings).value(), std::move(pipeline).value());
    if (const auto taken = parts->take_sockets(); !taken) return unexpected(taken.error());
    auto saved = parts->keeper.load(parts->settings.mapping.map);
    if (!saved) {
        return fail(saved.error().code, saved.error().message + "; move it away to begin with an empty map");
    }
    if (saved->has_value()) {
        spdlog::info("going on with the saved map: {} known voxels", (*saved)->known_voxels());
        parts->pipeline.begin_with(std::move(*saved).value());
    }
    parts->watch();
    return std::unique_ptr<Daemon>(new Daemon(std::move(parts)));
}

Daemon::Daemon(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Daemon::~Daemon() = default;

ExitCode Daemon::run() {
    (void)sd_notify(0, "READY=1");
    spdlog::info("running: rig '{}', {}{}", parts_->settings.host.rig.name, parts_->request.interface,
                 parts_->request.is_listen_only ? ", listening only" : "");
    constexpr int kInternal = 70;
    int outcome = kInternal;
    try {
        outcome = parts_->loop.run();
    } catch (const std::exception& error) {
        spdlog::critical("a defect of octoskin, please report it: {}; the map is saved, and it ends",
                         error.what());
    }
    (void)sd_notify(0, "STOPPING=1");
    const HostTime deadline = monotonic_now() + kSavePatience;  // for both
    parts_->recordings.stop(monotonic_now());
    parts_->save_map();
    const bool is_saved = parts_->keeper.finish(kSavePatience);
    parts_->recordings.finish(deadline - monotonic_now());
    const SaveRecord saves = parts_->keeper.record();
    if (!is_saved || !saves.error.empty()) {
        spdlog::error("the map is not saved: {}", is_saved ? saves.error : "the disk took too long");
        return ExitCode::cannot_create;
    }
    spdlog::info("stopped; the map is saved in {}", parts_->request.map_folder.string());
    return static_cast<ExitCode>(outcome);
}

Status<AppError> Daemon::Parts::take_sockets() {
    auto opened = ControlSocket::open(request.control_socket, loop,
                                      [this](const std::string& line) { return answer(line); });
    if (!opened) return unexpected(opened.error());
    control = std::move(opened).value();
    if (!request.joint_socket.empty()) {
        auto socket = JointSocket::open(request.joint_socket, settings.host.rig.joints.joints.size());
        if (!socket) return unexpected(socket.error());
        joints = std::move(socket).value();
    }
    return Done{};
}

void Daemon::Parts::watch() {
    for (const int signal : {SIGTERM, SIGINT})
        sources.push_back(loop.on_signal(signal, [this] { loop.stop(0); }));
    sources.push_back(loop.on_signal(SIGHUP, [this] { reload(); }));
    if (joints) sources.push_back(loop.on_readable(joints->descriptor(), [this] { drain_joints(); }));
    if (request.has_camera && settings.host.rig.camera) {
        camera = std::make_unique<CameraFeed>(request.camera_uri, kCameraSilenceMax);
        sources.push_back(loop.on_readable(camera->descriptor(), [this] { drain_camera(); }));
    }
    sources.push_back(loop.every(kAttendPeriod, [this] { attend(); }));
    sources.push_back(loop.every(request.save_period, [this] { save_map(); }));
    attend();
}

void Daemon::Parts::attend() {
    const HostTime now = monotonic_now();
    if (can.attend(now)) {
        can_ready = loop.on_readable(can.descriptor(), [this] { drain_can(); });
    }
    if (!request.is_listen_only) {
        if (const auto due = sync.poll(now)) (void)can.send(wire::encode(*due, wire::kHostId));
    }
    drain_can();  // what this host sent comes back without waking anybody, where there is no kernel
    recordings.attend(now);
    note_used(now);
    tell_changes();
}

void Daemon::Parts::note_used(HostTime now) {
    const PipelineAccounts& accounts = pipeline.accounts();
    const auto note = [now](std::uint64_t count, std::uint64_t& before, std::optional<HostTime>& last) {
        if (count > before) last = now;
        before = count;
    };
    note(accounts.joint_samples.used(), used_counts[0], last_used.joint_sample);
    note(accounts.readings.used(), used_counts[1], last_used.reading);
    note(accounts.depth_frames.used(), used_counts[2], last_used.depth_frame);
}

void Daemon::Parts::drain_can() {
    for (int i = 0; i < kFramesPerTurn; ++i) {
        const auto received = can.receive();
        if (!received) return;
        take_frame(*received);
    }
}

void Daemon::Parts::take_frame(const socketcan::Received& received) {
    feed(received.entry.frame, received.entry.stamp);
    if (const auto at = monotonic_of(received.entry.stamp)) answer_sync(received, *at);
    learn_shift(received);
}

/// Who only listens has the clock of the host that sends SYNC: what this machine measures is put on it.
void Daemon::Parts::learn_shift(const socketcan::Received& received) {
    if (!request.is_listen_only ||
        received.entry.frame.can_id != wire::can_id(wire::FrameType::follow_up, wire::kHostId))
        return;
    const auto decoded = wire::decode(received.entry.frame);
    const auto* const message = decoded ? std::get_if<wire::FollowUp>(&decoded->message) : nullptr;
    if (message == nullptr || !foreign_sync || message->sequence != foreign_sequence) return;
    shift =
        Nanoseconds{static_cast<std::int64_t>(message->host_time_us) * 1000} - (*foreign_sync - HostTime{});
}

/// What a SYNC asks of this host: the answer of its local joints, and the FOLLOW_UP if it was its own.
void Daemon::Parts::answer_sync(const socketcan::Received& received, HostTime at) {
    if (received.entry.frame.can_id != wire::can_id(wire::FrameType::sync, wire::kHostId)) return;
    const auto decoded = wire::decode(received.entry.frame);
    const auto* const message = decoded ? std::get_if<wire::Sync>(&decoded->message) : nullptr;
    if (message == nullptr) return;
    if (joints && joints->samples() > 0)
        feed(local_joints.report(message->sequence, at), received.entry.stamp);
    if (!received.is_own) {
        foreign_sync = at;
        foreign_sequence = message->sequence;
        return;
    }
    if (const auto follow_up = sync.on_sent(message->sequence, at))
        (void)can.send(wire::encode(*follow_up, wire::kHostId));
}

/// Into the pipeline, and how long that took since the frame was here.
void Daemon::Parts::feed(const wire::CanFrame& frame, WallTime stamp) {
    const std::uint64_t used_before = pipeline.accounts().readings.used();
    recordings.on_can(frame, stamp);
    pipeline.on_can(frame, stamp);
    const std::uint64_t used = pipeline.accounts().readings.used() - used_before;
    if (used == 0) return;
    const Nanoseconds took{wall_now().ns - stamp.ns};
    for (std::uint64_t i = 0; i < used; ++i) latency.add(took);
}

void Daemon::Parts::drain_joints() {
    drain_can();  // what came before them goes first: the bus's time is told by the order of stamps
    std::optional<JointSample> sample;
    for (int i = 0; i < kFramesPerTurn && joints->receive(sample); ++i) {
        if (!sample) continue;  // counted by the socket
        const auto frames = local_joints.frames(sample->sampled, sample->position);
        if (!frames) continue;  // the socket refuses and counts such a sample already
        for (const wire::CanFrame& frame : *frames) feed(frame, wall_now());
    }
}

void Daemon::Parts::drain_camera() {
    auto frame = camera->take();
    if (!frame) return;
    frame->captured = frame->captured + shift;
    pipeline.on_depth(std::move(*frame));
}

void Daemon::Parts::save_map() {
    keeper.save(pipeline.maps().fused()->copy());
}

void Daemon::Parts::reload() {
    (void)sd_notify(0, "RELOADING=1");
    auto read = read_settings(request);
    auto made = read ? make_pipeline(request, *read) : unexpected(read.error());
    if (!made) {
        reload_error = made.error().message;
        spdlog::error("not reloaded, the old settings hold: {}", reload_error);
    } else {
        recordings.stop(monotonic_now());  // it has the old settings, and is whole with them
        const bool is_same_grid = read->mapping.map == settings.mapping.map;
        if (is_same_grid) made->begin_with(pipeline.maps().fused()->copy());
        settings = std::move(read).value();
        if (!request.can_descriptor) can.reopen(opener(request, settings.host.rig));
        pipeline = std::move(made).value();
        local_joints = LocalJoints(settings.host.rig.joints.node_id, settings.host.rig.joints.joints.size());
        reload_error.clear();
        spdlog::info("reloaded: rig '{}'; the map {}", settings.host.rig.name,
                     is_same_grid ? "goes on" : "begins anew: the mapping has other voxels");
    }
    (void)sd_notify(0, "READY=1");
}

/// A problem is logged when it comes and when it goes.
void Daemon::Parts::tell_changes() {
    std::vector<std::string> now = problems(view());
    for (const std::string& problem : now) {
        if (std::ranges::find(problems_told, problem) == problems_told.end()) spdlog::warn("{}", problem);
    }
    for (const std::string& problem : problems_told) {
        if (std::ranges::find(now, problem) == now.end()) spdlog::info("over: {}", problem);
    }
    if (now != problems_told) {
        const std::string state = now.empty() ? "STATUS=all is well" : "STATUS=" + now.front();
        (void)sd_notify(0, state.c_str());
    }
    problems_told = std::move(now);
}

DaemonView Daemon::Parts::view() const {
    const HostTime now = monotonic_now();
    return {.now = now,
            .bus_now = now + shift,
            .started = started,
            .rig = &settings.host.rig,
            .pipeline = &pipeline,
            .can = &can,
            .interface = &request.interface,
            .is_listen_only = request.is_listen_only,
            .foreign_sync = request.is_listen_only ? std::nullopt : foreign_sync,
            .joints = joints ? &*joints : nullptr,
            .camera = camera ? std::optional(camera->record()) : std::nullopt,
            .latency = &latency,
            .used = last_used,
            .saves = keeper.record(),
            .recorder = recordings.recorder(),
            .reload_error = reload_error};
}

std::string Daemon::Parts::answer(const std::string& line) {
    if (line == "status")
        return status_json(view()).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    if (line == "save") {
        save_map();
        return R"({"ok": true})";
    }
    if (RecordRequests::is_one(line))
        return recordings.answer(line, settings.recorded, pipeline, monotonic_now());
    return nlohmann::ordered_json{{"ok", false},
                                  {"error", "unknown request; there are: status, save, record"}}
        .dump();
}

}  // namespace octoskin
