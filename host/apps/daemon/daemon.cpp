#include "host/apps/daemon/daemon.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/wall_time.hpp"
#include "host/apps/daemon/daemon_parts.hpp"
#include "host/apps/daemon/description.hpp"
#include "host/apps/daemon/ending.hpp"
#include "host/apps/daemon/feeder_request.hpp"
#include "host/apps/daemon/unwinding_room.hpp"
#include "host/apps/query/query_answer.hpp"
#include "host/apps/query/voxel_answer.hpp"

namespace octoskin {
namespace {

constexpr std::chrono::milliseconds kAttendPeriod{50};
constexpr std::chrono::milliseconds kHomePeriod{500};
constexpr std::chrono::milliseconds kWatchPeriod{100};

}  // namespace

void report_warnings(const Settings& settings) {
    for (const std::string& warning : settings.host.warnings) spdlog::warn("{}", warning);
    for (const std::string& note : settings.host.notes) spdlog::info("{}", note);
}

Result<std::unique_ptr<Daemon>, AppError> Daemon::build(const DaemonRequest& request,
                                                        std::shared_ptr<const LogQueue> log) {
    auto settings = read_settings(request);
    if (!settings) return unexpected(settings.error());
    report_warnings(*settings);
    auto pipeline = make_pipeline(request, *settings);
    if (!pipeline) return unexpected(pipeline.error());
    auto parts = std::make_unique<Parts>(request, std::move(settings).value(), std::move(pipeline).value(),
                                         std::move(log));
    if (const auto taken = parts->take_sockets(); !taken) return unexpected(taken.error());
    if (const auto taken = parts->take_folder(); !taken) return unexpected(taken.error());
    parts->watch();
    return std::unique_ptr<Daemon>(new Daemon(std::move(parts)));
}

Daemon::Daemon(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Daemon::~Daemon() = default;

ExitCode Daemon::run() {
    (void)sd_notify(0, "READY=1");
    spdlog::info("running: rig '{}', {}{}", parts_->settings.host.rig.name, parts_->request.interface,
                 parts_->request.is_listen_only ? ", listening only" : "");
    const int outcome = parts_->run_loop();
    const Nanoseconds patience = end_patience(parts_->pipeline.map().memory_bytes());
    report_end(patience);
    parts_->stop_recording();
    const HostTime end = monotonic_now() + patience;
    parts_->control->close_clients();
    parts_->watchers.end();
    const std::string error = parts_->save_last_map(end);
    parts_->recordings.finish(end - monotonic_now());
    if (!error.empty()) {
        spdlog::error("the map is not saved as it was at the end: {}", error);
        return ExitCode::cannot_create;
    }
    spdlog::info("stopped; the map is saved in {}", parts_->home->where());
    return static_cast<ExitCode>(outcome);
}

/// A failure to end the recording must not keep the map from being saved.
void Daemon::Parts::stop_recording() {
    try {
        recordings.stop(monotonic_now(), "the daemon ended");
    } catch (const std::exception& error) {
        spdlog::error("the recording could not be ended: {}", error.what());
    }
}

int Daemon::Parts::run_loop() {
    try {
        return loop.run();
    } catch (const std::exception& error) {
        return report_why_it_ends(error);
    }
}

Status<AppError> Daemon::Parts::take_sockets() {
    auto opened = ControlSocket::open(request.control_socket, loop,
                                      [this](const std::string& line) { return answer(line); });
    if (!opened) return unexpected(opened.error());
    control = std::move(opened).value();
    control->answer_later([this](const std::string& line, std::uint64_t ticket,
                                 uid_t user) { return queries.take(line, ticket, user); },
                          [this](std::uint64_t ticket) { queries.forget(ticket); });
    control->hand_over([this](const std::string& line, int connection) {
        return take_watcher(line, connection) || take_feeder(inputs.camera_inputs(), line, connection);
    });
    return inputs.take_sockets(settings.host.rig);
}

bool Daemon::Parts::take_watcher(const std::string& line, int connection) {
    if (!WatchServer::is_request(line)) return false;
    const auto wants = WatchServer::parse(line);
    return wants && watchers.take(connection, *wants);
}

/// A copy takes no time; what is written afterwards is copied once more.
void Daemon::Parts::give_map_to_watchers() {
    if (!watchers.wants(watch::FrameKind::map)) return;
    watchers.give_map(pipeline.map().copy(), inputs.bus_now(monotonic_now()).value_or(HostTime{0}));
}

void Daemon::Parts::give_status_to_watchers(const DaemonView& now, const std::vector<Problem>& problems) {
    constexpr Nanoseconds kPeriod{1'000'000'000};
    if (!watchers.wants(watch::FrameKind::status)) return;
    std::vector<std::string> names;
    for (const Problem& problem : problems)
        names.push_back(std::string(name_of(problem.code)).append(" ").append(problem.on));
    if (names == problems_given && now.now - status_given < kPeriod) return;
    watchers.give_status(
        status_json(now).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    problems_given = std::move(names);
    status_given = now.now;
}

void Daemon::Parts::watch() {
    for (const int signal : {SIGTERM, SIGINT, SIGQUIT})
        sources.push_back(loop.on_signal(signal, [this] { loop.stop(0); }));
    sources.push_back(loop.on_signal(SIGXCPU, [this] {
        spdlog::error("the processor time limit of this process is reached (ulimit -t): raise the limit");
        loop.stop(static_cast<int>(ExitCode::no_resources));
    }));
    sources.push_back(loop.on_readable(faults.descriptor(), [this] { faults.rethrow(); }));
    sources.push_back(loop.on_signal(SIGHUP, [this] { ask_reload(); }));
    sources.push_back(loop.on_readable(reading.descriptor(), [this] { end_reload(); }));
    depth_threads.grow_to(settings.host.rig.cameras.size());
    pipeline.work_beside(depth_threads.workers());
    pipeline.observe(&watchers);
    watchers.give_robot(settings.recorded.robot);
    sources.push_back(loop.every(kWatchPeriod, [this] { give_map_to_watchers(); }));
    sources.push_back(loop.on_readable(queries.descriptor(), [this] {
        const HostTime now = monotonic_now();
        const QueryServer::Now of_map{inputs.bus_now(now), inputs.reckoned_bus_now(now), wall_now()};
        for (const auto& [ticket, line] : queries.serve(pipeline, of_map)) control->reply(ticket, line);
    }));
    sources.push_back(loop.every(kAttendPeriod, [this] { attend(); }));
    sources.push_back(loop.every(kHomePeriod, [this] { home->ask(); }));
    sources.push_back(loop.on_readable(home->descriptor(), [this] { go_where_home_is(home->take()); }));
    sources.push_back(loop.every(request.save_period, [this] { save_map(); }));
    inputs.watch(settings.host.rig);
}

void Daemon::Parts::attend() {
    UnwindingRoom::keep();
    inputs.attend();
    recordings.attend(monotonic_now());
    last_used.note(pipeline, settings.host.rig, monotonic_now());
    if (const auto slept = map_time.attend(pipeline, inputs.reckoned_bus_now(monotonic_now()));
        slept > Nanoseconds{0})
        spdlog::info("the machine slept for {:.0f} s: the map is older by that time", seconds_of(slept));
    if (reload_pace.is_due(monotonic_now())) begin_reload();
    report_problems();
    for (const std::string& line : register_log.news(pipeline.intake().nodes())) spdlog::info("{}", line);
}

void Daemon::Parts::report_problems() {
    const DaemonView now = view();
    const std::vector<Problem> found = problems(now);
    give_status_to_watchers(now, found);
    problem_log.update(found, now.now, now.is_settling());
}

DaemonView Daemon::Parts::view() const {
    const HostTime now = monotonic_now();
    return {.now = now,
            .bus_now = inputs.bus_now(now),
            .bus_reckoned = inputs.reckoned_bus_now(now),
            .started = started,
            .rig = &settings.host.rig,
            .pipeline = &pipeline,
            .inputs = &inputs,
            .is_wall_clock_right = tells_time(wall_now()),
            .interface = &request.interface,
            .is_listen_only = request.is_listen_only,
            .cameras = inputs.cameras(),
            .used = last_used,
            .log = log->record(),
            .saves = saver->record(),
            .maps_silent_since = maps_silent_since(now),
            .maps_problem = home->problem(),
            .recorder = recordings.recorder(),
            .recording_refusal = recordings.refusal(),
            .reload_error = reload_error,
            .reloads = {reloads.count, reloads.unchanged, reloads.dropped, reading.begun()},
            .reloaded = reloaded,
            .watch = watchers.record()};
}

std::string Daemon::Parts::answer(const std::string& line) {
    constexpr std::size_t kRoomBytes = std::size_t{1} << 20U;
    std::optional<AnswerRoom> room;
    try {
        room.emplace(kRoomBytes);
    } catch (const std::bad_alloc&) {  // too little is left to process even the answer
        return AnswerRoom::kRefusal;
    }
    if (line == "status") {
        inputs.catch_up();  // the loop may have been busy with an image: use what arrived meanwhile
        return status_json(view()).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    }
    if (line == "hello") return R"({"ok":true})";
    if (line == "describe")
        return description_json(settings.host, request.has_camera, reloads.count)
            .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    if (is_voxel_request(line)) {
        FusedMap now = pipeline.map().copy();
        now.advance_time(inputs.reckoned_bus_now(monotonic_now()));
        return answer_voxel(line, now).dump();
    }
    if (WatchServer::is_request(line)) {
        const bool is_known = WatchServer::parse(line).has_value();
        return query_refused(
                   is_known ? AppError{ExitCode::unavailable,
                                       {.code = ErrorCode::limit_exceeded,
                                        .what = fmt::format("too many watchers: {} are served at once",
                                                            WatchServer::kWatchersMax),
                                        .remedy = "end one of them"}}
                            : AppError{ExitCode::usage,
                                       {.code = ErrorCode::bad_argument,
                                        .what = "unknown kind of frames to watch",
                                        .remedy = "there are: map, ranges, joints, status, images, robot"}})
            .dump();
    }
    if (const auto name = fed_camera_of(line)) return feeder_refusal(inputs.camera_inputs(), *name);
    if (RecordRequests::is_one(line))
        return recordings.answer(line, settings.recorded, pipeline, monotonic_now());
    return query_refused(
               {ExitCode::usage,
                {.code = ErrorCode::bad_argument,
                 .what = "unknown request",
                 .remedy = "there are: hello, status, describe, record, query, voxel, watch, camera"}})
        .dump();
}

}  // namespace octoskin
