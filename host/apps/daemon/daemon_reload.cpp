#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <new>
#include <optional>
#include <system_error>
#include <utility>

#include "host/apps/daemon/daemon_parts.hpp"
#include "host/apps/daemon/map_files.hpp"
#include "host/io/mapfile/map_file.hpp"

namespace octoskin {

void Daemon::Parts::ask_reload() {
    const HostTime now = monotonic_now();
    const bool is_first = reload_pace.ask();
    if (reload_pace.is_due(now)) return begin_reload();
    if (is_first && !reading.begun())
        spdlog::info("SIGHUP: the files are read in {:.1f} s, because they were read a moment ago",
                     seconds_of(reload_pace.wait(now)));
}

void Daemon::Parts::begin_reload() {
    (void)sd_notify(0, "RELOADING=1");
    reload_pace.begin_reading();
    try {
        reading.begin([request = request, held = settings.recorded] { return read_next(request, held); });
    } catch (const std::bad_alloc&) {
        obey_reload(fail(ExitCode::bad_config,
                         {ErrorCode::no_resources, "no memory to read the rig, robot and mapping files"}));
    }
}

void Daemon::Parts::end_reload() {
    if (auto next = reading.take()) obey_reload(std::move(*next));
}

void Daemon::Parts::obey_reload(NextResult next) {
    const bool has_changed = take_next(std::move(next));
    reload_pace.obeyed(monotonic_now(), has_changed);
    report_problems();  // including the reason if it was refused
    (void)sd_notify(0, "READY=1");
}

bool Daemon::Parts::take_next(NextResult next) {
    if (next && next->has_value()) {
        if (auto why = why_map_ends((*next)->settings)) next = fail(ExitCode::bad_config, std::move(*why));
    }
    if (!next) reload_error = next.error().message();
    if (next && !next->has_value()) {
        ++reloads.unchanged;
        reload_error.clear();
        spdlog::info("SIGHUP: rig, robot and mapping are unchanged");
        return false;
    }
    if (next && resume_with(**next)) return true;
    spdlog::error("not reloaded");  // the problems contain the reason
    return next.has_value();
}

/// False, with nothing changed: there is not enough memory. After the limits are set there is no way back: if
/// a later step lacks memory, the daemon ends, with the map still in the pipeline.
bool Daemon::Parts::resume_with(Next& next) {
    std::optional<FusedMap> recorded =
        recordings.last_map();  // changes by the new limits are not part of the recording
    if (!take_threads(next.settings.host.rig)) return false;
    if (!take_limits(next.settings.mapping.map)) return false;
    recordings.stop(monotonic_now(), "the daemon re-read its files (SIGHUP)", std::move(recorded));
    inputs.prepare_for(next.settings.host.rig);
    const std::uint64_t dropped = settle_pipeline();
    if (!is_placed_as(next.settings.recorded.placement_crc32)) map_time.forget(pipeline);
    next.pipeline.resume_from(pipeline);
    settings = std::move(next.settings);
    pipeline = std::move(next.pipeline);
    pipeline.work_beside(depth_threads.workers());
    watchers.change_rig(settings.host.rig, reloads.count);
    pipeline.observe(&watchers);
    watchers.give_robot(settings.recorded.robot);
    inputs.change_rig(settings.host.rig);
    queries.change_robot(settings.host, miss_units(settings.mapping));
    reload_error.clear();
    reloaded = monotonic_now();
    spdlog::info("reloaded: rig '{}'; the map is kept; {} waiting inputs were not used",
                 settings.host.rig.name, dropped);
    report_warnings(settings);
    return true;
}

/// Why the map cannot be kept with these settings; empty if it can. Another resolution is refused as at the
/// start: the next save would replace the map.
std::optional<Error> Daemon::Parts::why_map_ends(const Settings& next) const {
    const double now = settings.mapping.map.resolution_m;
    const double wanted = next.mapping.map.resolution_m;
    if (wanted == now) return why_no_room(pipeline.map(), next.mapping.map);
    Error other = other_voxels(request.map_folder / kMapFile, now, wanted);
    other.remedy = fmt::format("end octoskin, move {} away and start octoskin to begin with an empty map",
                               kMapFilesText);
    return other;
}

bool Daemon::Parts::take_threads(const HostRig& next) {
    try {
        depth_threads.grow_to(next.cameras.size());
        return true;
    } catch (const std::system_error& error) {
        reload_error = std::string("no thread left for another camera: ") + error.what();
        return false;
    }
}

/// While the pipeline still runs: waiting inputs must not make the map larger than the next start may load.
bool Daemon::Parts::take_limits(const MapConfig& next) {
    try {
        AddressReserve next_reserve(bytes_to_save(next));
        pipeline.limit_map(next);
        reserve = std::move(next_reserve);
        return true;
    } catch (const std::bad_alloc&) {
        reload_error = "there is not enough memory for the map within its new limits beside the old one";
        return false;
    }
}

/// Uses or counts all that waits in the old pipeline; returns how much was not used.
std::uint64_t Daemon::Parts::settle_pipeline() {
    const auto rejected = [this] {
        const PipelineInputs& counted = pipeline.inputs();
        std::uint64_t frames = 0;
        for (const auto& camera : counted.depth_frames) frames += camera.rejected();
        return counted.readings.rejected() + counted.joint_samples.rejected() + frames;
    };
    const std::uint64_t before = rejected();
    pipeline.finish();
    ++reloads.count;
    reloads.dropped += rejected() - before;
    return rejected() - before;
}

}  // namespace octoskin
