#include "host/apps/daemon/daemon.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <new>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "common/wall_time.hpp"
#include "host/apps/daemon/boot_clock.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/depth_thread.hpp"
#include "host/apps/daemon/ending.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/home_watch.hpp"
#include "host/apps/daemon/inputs.hpp"
#include "host/apps/daemon/map_files.hpp"
#include "host/apps/daemon/map_keeper.hpp"
#include "host/apps/daemon/next_settings.hpp"
#include "host/apps/daemon/problem_log.hpp"
#include "host/apps/daemon/query_desk.hpp"
#include "host/apps/daemon/record_requests.hpp"
#include "host/apps/daemon/register_log.hpp"
#include "host/apps/daemon/reload_pace.hpp"
#include "host/apps/daemon/side_task.hpp"
#include "host/apps/daemon/status.hpp"
#include "host/apps/querying/query_answer.hpp"
#include "host/io/mapfile/map_file.hpp"

namespace octoskin {
namespace {

constexpr std::chrono::milliseconds kAttendPeriod{50};
constexpr std::chrono::milliseconds kHomePeriod{500};

void tell_warnings(const Settings& settings) {
    for (const std::string& warning : settings.host.warnings) spdlog::warn("{}", warning);
    for (const std::string& note : settings.host.notes) spdlog::info("{}", note);
}

}  // namespace

/// What lives while the daemon does. The loop comes first: whatever watches through it goes before it.
struct Daemon::Parts {
    Parts(DaemonRequest request_in, Settings settings_in, Pipeline pipeline_in,
          std::shared_ptr<const LogQueue> log_in)
        : log(std::move(log_in)),
          request(std::move(request_in)),
          settings(std::move(settings_in)),
          pipeline(std::move(pipeline_in)),
          inputs(request, settings.host.rig, loop, pipeline, recordings),
          queries(settings.host),
          started(monotonic_now()) {}

    Status<AppError> take_sockets();
    Status<AppError> take_folder();
    void watch();
    void attend();
    void tell_problems();
    void go_where_home_is(std::optional<OpenFolder> next);
    [[nodiscard]] std::optional<HostTime> maps_silent_since(HostTime now) const;
    void go_on_with(KeptMap kept);
    /// What a copy of the map is of, for the next start, once it has gone on to now.
    [[nodiscard]] SnapshotOrigin make_ready_to_save(FusedMap& copy);
    void save_map();
    std::string save_last_map(HostTime end);
    std::uint64_t settle_pipeline();
    [[nodiscard]] std::string why_map_ends(const Settings& next) const;
    void keep_within(const MapConfig& next);
    [[nodiscard]] bool is_placed_as(std::uint32_t placement_crc32) const;
    [[nodiscard]] bool take_limits(const Settings& next);
    [[nodiscard]] bool go_on_with(Next& next);
    void ask_reload();
    void begin_reload();
    void end_reload();
    void obey_reload(NextResult next);
    /// Whether anything changed.
    [[nodiscard]] bool take_next(NextResult next);
    [[nodiscard]] DaemonView view() const;
    std::string answer(const std::string& line);

    std::shared_ptr<const LogQueue> log;
    DaemonRequest request;
    Settings settings;
    EventLoop loop;
    Pipeline pipeline;
    DepthThread depth_thread;   ///< goes before the pipeline that it works for
    RecordRequests recordings;  ///< lets go of the pipeline before that goes
    Inputs inputs;
    std::optional<HomeWatch> home;
    std::optional<MapKeeper> keeper;
    std::unique_ptr<ControlSocket> control;
    QueryDesk queries;
    HostTime started;
    std::string reload_error;
    ReloadCounts reloads;
    std::optional<HostTime> reloaded;
    ReloadPace reload_pace;
    SideTask<NextResult> reading;  ///< of the files, for SIGHUP
    ProblemLog problem_log;
    RegisterLog register_log;
    LastUsed last_used;
    MapTime map_time;

    std::vector<EventSource> sources;
};

Result<std::unique_ptr<Daemon>, AppError> Daemon::build(const DaemonRequest& request,
                                                        std::shared_ptr<const LogQueue> log) {
    auto settings = read_settings(request);
    if (!settings) return unexpected(settings.error());
    tell_warnings(*settings);
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
    int outcome = kInternalDefect;
    try {
        outcome = parts_->loop.run();
    } catch (const std::exception& error) {
        outcome = tell_why_it_ends(error);
    }
    const Nanoseconds patience = end_patience(parts_->pipeline.map().memory_bytes());
    tell_end(patience);
    parts_->recordings.stop(monotonic_now(), "the daemon ended");
    const HostTime end = monotonic_now() + patience;
    parts_->control->close_clients();
    const std::string error = parts_->save_last_map(end);
    parts_->recordings.finish(end - monotonic_now());
    if (!error.empty()) {
        spdlog::error("the map is not saved as it was at the end: {}", error);
        return ExitCode::cannot_create;
    }
    spdlog::info("stopped; the map is saved in {}", parts_->home->where());
    return static_cast<ExitCode>(outcome);
}

Status<AppError> Daemon::Parts::take_sockets() {
    auto opened = ControlSocket::open(request.control_socket, loop,
                                      [this](const std::string& line) { return answer(line); });
    if (!opened) return unexpected(opened.error());
    control = std::move(opened).value();
    control->answer_later(
        [this](const std::string& line, std::uint64_t ticket) { return queries.take(line, ticket); },
        [this](std::uint64_t ticket) { queries.forget(ticket); });
    return inputs.take_sockets(settings.host.rig);
}

/// After the sockets: nothing in the folder is touched by a daemon that is one too many.
Status<AppError> Daemon::Parts::take_folder() {
    auto taken = MapHome::take(request.map_folder);
    if (!taken) return unexpected(taken.error());
    keeper.emplace(NamedFolder(taken->folder()));
    home.emplace(std::move(taken).value());
    tell_load(load_patience(keeper->saved_bytes()));
    auto saved = keeper->load(settings.mapping, settings.recorded.mapping_crc32());
    if (!saved) return unexpected(saved.error());
    if (saved->has_value()) go_on_with(std::move(**saved));
    return Done{};
}

/// Its ages grow by what passed since it was saved, here and until its first measurement.
void Daemon::Parts::go_on_with(KeptMap kept) {
    for (const std::string& warning : kept.warnings) spdlog::warn("{}", warning);
    if (kept.is_whole && !is_placed_as(kept.placement_crc32)) kept.map_time.reset();
    const auto passed_s = map_time.begin_with(kept.map, kept.map_time);
    spdlog::info("going on with the saved map: {} known voxels, {}", kept.map.known_voxels(),
                 passed_s ? fmt::format("{} s older", *passed_s) : "all of them stale");
    pipeline.begin_with(std::move(kept.map));
}

/// Nothing may have been measured for long.
SnapshotOrigin Daemon::Parts::make_ready_to_save(FusedMap& copy) {
    const HostTime bus = inputs.reckoned_bus_now(monotonic_now());
    map_time.note(copy, bus);
    return {.mapping_crc32 = settings.recorded.mapping_crc32(),
            .placement_crc32 = settings.recorded.placement_crc32,
            .map_time = map_time.go_on(copy, bus)};
}

void Daemon::Parts::watch() {
    for (const int signal : {SIGTERM, SIGINT, SIGQUIT})
        sources.push_back(loop.on_signal(signal, [this] { loop.stop(0); }));
    sources.push_back(loop.on_signal(SIGXCPU, [this] {
        spdlog::error("the processor time that this process may use is over (ulimit -t): raise the limit");
        loop.stop(static_cast<int>(ExitCode::no_resources));
    }));
    sources.push_back(loop.on_signal(SIGHUP, [this] { ask_reload(); }));
    sources.push_back(loop.on_readable(reading.descriptor(), [this] { end_reload(); }));
    pipeline.work_beside(&depth_thread);
    sources.push_back(loop.on_readable(depth_thread.descriptor(), [this] {
        depth_thread.acknowledge();
        pipeline.on_worker_done();
    }));
    sources.push_back(loop.on_readable(queries.descriptor(), [this] {
        const HostTime now = monotonic_now();
        const QueryDesk::Now of_map{inputs.bus_now(now), inputs.reckoned_bus_now(now), wall_now()};
        for (const auto& [ticket, line] : queries.serve(pipeline, of_map)) control->reply(ticket, line);
    }));
    sources.push_back(loop.every(kAttendPeriod, [this] { attend(); }));
    sources.push_back(loop.every(kHomePeriod, [this] { home->ask(); }));
    sources.push_back(loop.on_readable(home->descriptor(), [this] { go_where_home_is(home->take()); }));
    sources.push_back(loop.every(request.save_period, [this] { save_map(); }));
    inputs.watch(settings.host.rig);
}

void Daemon::Parts::attend() {
    inputs.attend();
    recordings.attend(monotonic_now());
    last_used.note(pipeline, monotonic_now());
    if (const auto slept = map_time.attend(pipeline, inputs.reckoned_bus_now(monotonic_now()));
        slept > Nanoseconds{0})
        spdlog::info("the machine slept for {:.0f} s: the map is older by that", seconds_of(slept));
    if (reload_pace.is_due(monotonic_now())) begin_reload();
    tell_problems();
    for (const std::string& line : register_log.news(pipeline.intake().nodes())) spdlog::info("{}", line);
}

void Daemon::Parts::tell_problems() {
    const DaemonView now = view();
    problem_log.tell(problems(now), now.now, now.is_settling());
}

/// Where a person looks for them.
void Daemon::Parts::go_where_home_is(std::optional<OpenFolder> next) {
    if (!next) return;
    keeper->move_to(NamedFolder(std::move(*next)));
    spdlog::warn("{}: the maps' folder was removed and made anew: the map goes on being saved there",
                 home->where());
}

/// Since when the maps' folder does not answer; empty: it does, or may only be slow.
std::optional<HostTime> Daemon::Parts::maps_silent_since(HostTime now) const {
    constexpr Nanoseconds kLookMax{3'000'000'000};
    const auto& looking = home->looking_since();
    if (looking && now - *looking > kLookMax) return looking;
    const auto saving = keeper->record().saving_since;
    if (!saving) return std::nullopt;
    const Nanoseconds save_max = end_patience(pipeline.map().memory_bytes()) + kEndMargin;
    return now - *saving > save_max ? saving : std::nullopt;
}

void Daemon::Parts::save_map() {
    // Counted if one is at work still; the next is not far.
    (void)keeper->save(pipeline.map(), [this](FusedMap& copy) { return make_ready_to_save(copy); });
}

/// Why it could not be saved by `end`; empty: it is saved.
std::string Daemon::Parts::save_last_map(HostTime end) {
    constexpr Nanoseconds kLookMax{500'000'000};
    go_where_home_is(home->look_again(std::min(kLookMax, end - monotonic_now())));
    const auto too_long = [this](const char* what) {
        const auto silent = home->looking_since();
        return silent ? fmt::format("the maps' folder does not answer since {:.1f} s",
                                    seconds_of(monotonic_now() - *silent))
                      : std::string(what);
    };
    if (!keeper->finish(end - monotonic_now())) return too_long("the disk took too long for the save before");
    FusedMap last = pipeline.take_map();
    const SnapshotOrigin origin = make_ready_to_save(last);
    keeper->save_last(std::move(last), origin);
    if (!keeper->finish(end - monotonic_now())) return too_long("the disk took too long");
    return keeper->record().error;
}

/// What waits in the pipeline that is about to go is used or counted; how much was not used.
std::uint64_t Daemon::Parts::settle_pipeline() {
    const auto rejected = [this] {
        const PipelineAccounts& accounts = pipeline.accounts();
        return accounts.readings.rejected() + accounts.joint_samples.rejected() +
               accounts.depth_frames.rejected();
    };
    const std::uint64_t before = rejected();
    pipeline.finish();
    ++reloads.count;
    reloads.dropped += rejected() - before;
    return rejected() - before;
}

/// Why the map cannot go on with these settings; empty if it can. Another resolution is refused as at the
/// start: the next save would replace the map.
std::string Daemon::Parts::why_map_ends(const Settings& next) const {
    const double now = settings.mapping.map.resolution_m;
    const double wanted = next.mapping.map.resolution_m;
    if (wanted == now) return why_no_room(pipeline.map(), next.mapping.map);
    return fmt::format("{}; end octoskin, move {} away and start octoskin to begin with an empty map",
                       describe_other_voxels(request.map_folder / kMapFile, now, wanted), kMapFilesText);
}

/// What still waits must not make the map larger than it may be from then on: the next start would refuse it.
void Daemon::Parts::keep_within(const MapConfig& next) {
    MapConfig both = settings.mapping.map;
    both.memory_max_mib = std::min(both.memory_max_mib, next.memory_max_mib);
    pipeline.limit_map(both);
}

/// Whether measurements with that placement lie in the map where those of today do. If not, what the map has
/// may lie elsewhere than the robot finds it: all of it is stale until it is seen again.
bool Daemon::Parts::is_placed_as(std::uint32_t placement_crc32) const {
    if (placement_crc32 == settings.recorded.placement_crc32) return true;
    spdlog::warn(
        "the rig or the robot's URDF places base, sensors or camera elsewhere than when the map was made: "
        "all of the "
        "map is stale until it is seen again; to begin with an empty map, end octoskin, move {} away and "
        "start it",
        kMapFilesText);
    return false;
}

/// While the map is still the pipeline's: it must not be lost with what there is no memory for.
bool Daemon::Parts::take_limits(const Settings& next) {
    try {
        pipeline.limit_map(next.mapping.map);
        if (!is_placed_as(next.recorded.placement_crc32)) pipeline.forget_times();
        return true;
    } catch (const std::bad_alloc&) {
        pipeline.limit_map(settings.mapping.map);
        reload_error = "there is no memory for the map within its new limits beside the old one";
        return false;
    }
}

/// False, and as before: there is no memory for that.
bool Daemon::Parts::go_on_with(Next& next) {
    recordings.stop(monotonic_now(), "the daemon read its files anew (SIGHUP)");  // whole with the old ones
    keep_within(next.settings.mapping.map);
    inputs.prepare_for(next.settings.host.rig);
    const std::uint64_t dropped = settle_pipeline();
    if (!take_limits(next.settings)) {
        inputs.prepare_for(settings.host.rig);
        return false;
    }
    next.pipeline.go_on_from(pipeline);
    settings = std::move(next.settings);
    pipeline = std::move(next.pipeline);
    pipeline.work_beside(&depth_thread);
    inputs.change_rig(settings.host.rig);
    queries.change_robot(settings.host);
    reload_error.clear();
    reloaded = monotonic_now();
    spdlog::info("reloaded: rig '{}'; the map goes on; {} of what waited was not used",
                 settings.host.rig.name, dropped);
    tell_warnings(settings);
    return true;
}

void Daemon::Parts::ask_reload() {
    const HostTime now = monotonic_now();
    const bool is_first = reload_pace.ask();
    if (reload_pace.is_due(now)) return begin_reload();
    if (is_first && !reading.begun())
        spdlog::info("SIGHUP: the files are read in {:.1f} s, as they were a moment ago",
                     seconds_of(reload_pace.wait(now)));
}

void Daemon::Parts::begin_reload() {
    (void)sd_notify(0, "RELOADING=1");
    reload_pace.begin_reading();
    try {
        reading.begin([request = request, held = settings.recorded] { return read_next(request, held); });
    } catch (const std::bad_alloc&) {
        obey_reload(fail(ExitCode::bad_config, "no memory for what the files say"));
    }
}

void Daemon::Parts::end_reload() {
    if (auto next = reading.take()) obey_reload(std::move(*next));
}

void Daemon::Parts::obey_reload(NextResult next) {
    const bool has_changed = take_next(std::move(next));
    reload_pace.obeyed(monotonic_now(), has_changed);
    tell_problems();  // why it was refused, if it was
    (void)sd_notify(0, "READY=1");
}

bool Daemon::Parts::take_next(NextResult next) {
    if (next && next->has_value()) {
        if (std::string why = why_map_ends((*next)->settings); !why.empty())
            next = fail(ExitCode::bad_config, std::move(why));
    }
    if (!next) reload_error = next.error().message;
    if (next && !next->has_value()) {
        ++reloads.unchanged;
        reload_error.clear();
        spdlog::info("SIGHUP: rig, robot and mapping say what holds already; nothing changes");
        return false;
    }
    if (next && go_on_with(**next)) return true;
    spdlog::error("not reloaded");  // why, the problems tell
    return next.has_value();
}

DaemonView Daemon::Parts::view() const {
    const HostTime now = monotonic_now();
    return {.now = now,
            .bus_now = inputs.bus_now(now),
            .started = started,
            .rig = &settings.host.rig,
            .pipeline = &pipeline,
            .inputs = &inputs,
            .is_wall_clock_right = tells_time(wall_now()),
            .interface = &request.interface,
            .is_listen_only = request.is_listen_only,
            .camera = inputs.camera(),
            .used = last_used,
            .log = log->record(),
            .saves = keeper->record(),
            .maps_silent_since = maps_silent_since(now),
            .maps_problem = home->problem(),
            .recorder = recordings.recorder(),
            .recording_refusal = recordings.refusal(),
            .reload_error = reload_error,
            .reloads = {reloads.count, reloads.unchanged, reloads.dropped, reading.begun()},
            .reloaded = reloaded};
}

std::string Daemon::Parts::answer(const std::string& line) {
    if (line == "status") {
        inputs.catch_up();  // the loop may have been busy with an image: what came meanwhile counts
        return status_json(view()).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    }
    if (line == "hello") return R"({"ok":true})";
    if (RecordRequests::is_one(line))
        return recordings.answer(line, settings.recorded, pipeline, monotonic_now());
    return query_refused({ExitCode::usage, "unknown request; there are: hello, status, record, query"})
        .dump();
}

}  // namespace octoskin
