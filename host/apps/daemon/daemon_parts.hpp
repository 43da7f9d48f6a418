// The parts of the daemon, for the three files with its functions: daemon.cpp (its life and its answers),
// daemon_map.cpp (loading and saving the map), daemon_reload.cpp (SIGHUP).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/daemon/address_reserve.hpp"
#include "host/apps/daemon/boot_clock.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/daemon.hpp"
#include "host/apps/daemon/depth_threads.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/home_watch.hpp"
#include "host/apps/daemon/inputs.hpp"
#include "host/apps/daemon/map_saver.hpp"
#include "host/apps/daemon/next_settings.hpp"
#include "host/apps/daemon/problem_log.hpp"
#include "host/apps/daemon/query_server.hpp"
#include "host/apps/daemon/record_requests.hpp"
#include "host/apps/daemon/register_log.hpp"
#include "host/apps/daemon/reload_pace.hpp"
#include "host/apps/daemon/side_task.hpp"
#include "host/apps/daemon/status.hpp"
#include "host/apps/daemon/thread_faults.hpp"
#include "host/apps/daemon/watch_server.hpp"

namespace octoskin {

/// The loop comes first: each watcher is destroyed before it.
struct Daemon::Parts {
    Parts(DaemonRequest request_in, Settings settings_in, Pipeline pipeline_in,
          std::shared_ptr<const LogQueue> log_in)
        : log(std::move(log_in)),
          request(std::move(request_in)),
          settings(std::move(settings_in)),
          pipeline(std::move(pipeline_in)),
          reserve(bytes_to_save(settings.mapping.map)),
          inputs(request, settings.host.rig, loop, pipeline, recordings),
          queries(settings.host, miss_units(settings.mapping)),
          started(monotonic_now()) {}

    int run_loop();
    void stop_recording();
    Status<AppError> take_sockets();
    Status<AppError> take_folder();
    void watch();
    void attend();
    void report_problems();
    void give_map_to_watchers();
    /// Once a second, and when a problem appears or goes.
    void give_status_to_watchers(const DaemonView& now, const std::vector<Problem>& problems);
    [[nodiscard]] bool take_watcher(const std::string& request, int connection);
    void go_where_home_is(std::optional<OpenFolder> next);
    [[nodiscard]] std::optional<HostTime> maps_silent_since(HostTime now) const;
    void resume_with(KeptMap kept);
    /// The origin of a copy of the map for the next start; first advances the copy to the present time.
    [[nodiscard]] SnapshotOrigin make_ready_to_save(FusedMap& copy);
    void save_map();
    std::string save_last_map(HostTime end);
    std::uint64_t settle_pipeline();
    [[nodiscard]] std::optional<Error> why_map_ends(const Settings& next) const;
    [[nodiscard]] bool is_placed_as(std::uint32_t placement_crc32) const;
    /// The address space that a save of such a map takes in addition, for its list of bricks.
    [[nodiscard]] static std::size_t bytes_to_save(const MapConfig& map) noexcept;
    [[nodiscard]] bool take_limits(const MapConfig& next);
    [[nodiscard]] bool take_threads(const HostRig& next);
    [[nodiscard]] bool resume_with(Next& next);
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
    ThreadFaults faults;  ///< destroyed after all that have a thread
    Pipeline pipeline;
    AddressReserve reserve;  ///< for the last save
    DepthThreads depth_threads{loop,
                               [this] { pipeline.on_worker_done(); }};  ///< destroyed before the pipeline
    WatchServer watchers{settings.host.rig};  ///< destroyed before the pipeline that it observes
    HostTime status_given;                    ///< to the watchers
    std::vector<std::string> problems_given;
    RecordRequests recordings;  ///< releases the pipeline before it is destroyed
    Inputs inputs;
    std::optional<HomeWatch> home;
    std::optional<MapSaver> saver;
    std::unique_ptr<ControlSocket> control;
    QueryServer queries;
    HostTime started;
    std::string reload_error;
    ReloadCounts reloads;
    std::optional<HostTime> reloaded;
    ReloadPace reload_pace;
    SideTask<NextResult> reading;  ///< reads the files after SIGHUP
    ProblemLog problem_log;
    RegisterLog register_log;
    LastUsed last_used;
    MapTime map_time;

    std::vector<EventSource> sources;
};

/// Logs the warnings about the rig and the robot.
void report_warnings(const Settings& settings);

}  // namespace octoskin
