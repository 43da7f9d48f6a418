#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "host/apps/daemon/daemon_parts.hpp"
#include "host/apps/daemon/ending.hpp"
#include "host/apps/daemon/map_files.hpp"

namespace octoskin {

/// After the sockets: a second daemon must not touch the folder.
Status<AppError> Daemon::Parts::take_folder() {
    auto taken = MapHome::take(request.map_folder);
    if (!taken) return unexpected(taken.error());
    saver.emplace(NamedFolder(taken->folder()));
    home.emplace(std::move(taken).value());
    report_load(load_patience(saver->saved_bytes()));
    auto saved = saver->load(settings.mapping, settings.recorded.mapping_crc32());
    if (!saved) return unexpected(saved.error());
    if (saved->has_value()) resume_with(std::move(**saved));
    return Done{};
}

/// Its ages grow by the time since it was saved, here and until its first measurement.
void Daemon::Parts::resume_with(KeptMap kept) {
    for (const std::string& warning : kept.warnings) spdlog::warn("{}", warning);
    if (kept.is_whole && !is_placed_as(kept.placement_crc32)) kept.map_time.reset();
    const auto passed_s = map_time.begin_with(kept.map, kept.map_time);
    spdlog::info("continuing with the saved map: {} known voxels, {}", kept.map.known_voxels(),
                 passed_s ? fmt::format("{} s older", *passed_s) : "all of them stale");
    pipeline.begin_with(std::move(kept.map));
}

/// Whether measurements with that placement lie in the map where present ones do. If not, the contents may
/// lie elsewhere for the robot: all of it is stale until it is seen again.
bool Daemon::Parts::is_placed_as(std::uint32_t placement_crc32) const {
    if (placement_crc32 == settings.recorded.placement_crc32) return true;
    spdlog::warn(
        "the rig or the robot's URDF places base, sensors or camera elsewhere than when the map was made: "
        "all of the map is stale until it is seen again; to begin with an empty map, end octoskin, move {} "
        "away and start it",
        kMapFilesText);
    return false;
}

/// The last measurement may be long ago.
SnapshotOrigin Daemon::Parts::make_ready_to_save(FusedMap& copy) {
    const HostTime bus = inputs.reckoned_bus_now(monotonic_now());
    map_time.note(copy, bus);
    return {.mapping_crc32 = settings.recorded.mapping_crc32(),
            .placement_crc32 = settings.recorded.placement_crc32,
            .map_time = map_time.advance_time(copy, bus)};
}

/// At the place where a person looks for the maps.
void Daemon::Parts::go_where_home_is(std::optional<OpenFolder> next) {
    if (!next) return;
    saver->move_to(NamedFolder(std::move(*next)));
    spdlog::warn("{}: the maps' folder was removed and made again: the map is still saved there",
                 home->where());
}

/// Since when the maps' folder has not answered; empty: it answers, or may only be slow.
std::optional<HostTime> Daemon::Parts::maps_silent_since(HostTime now) const {
    constexpr Nanoseconds kLookMax{3'000'000'000};
    const auto& looking = home->looking_since();
    if (looking && now - *looking > kLookMax) return looking;
    const auto saving = saver->record().saving_since;
    if (!saving) return std::nullopt;
    const Nanoseconds save_max = end_patience(pipeline.map().memory_bytes()) + kEndMargin;
    return now - *saving > save_max ? saving : std::nullopt;
}

std::size_t Daemon::Parts::bytes_to_save(const MapConfig& map) noexcept {
    constexpr std::size_t kShare = 50;
    constexpr std::size_t kBesides = std::size_t{2} << 20U;
    return kBesides + (std::size_t{map.memory_max_mib} << 20U) / kShare;
}

void Daemon::Parts::save_map() {
    // A save that is still running is counted as skipped; the next one is soon.
    (void)saver->save(pipeline.map(), [this](FusedMap& copy) { return make_ready_to_save(copy); });
}

/// Why it could not be saved by `end`; empty: it is saved.
std::string Daemon::Parts::save_last_map(HostTime end) {
    constexpr Nanoseconds kLookMax{500'000'000};
    reserve = {};  // not earlier: the end of a recording would use it
    go_where_home_is(home->look_again(std::min(kLookMax, end - monotonic_now())));
    const auto too_long = [this](const char* what) {
        const auto silent = home->looking_since();
        return silent ? fmt::format("the maps' folder has not answered for {:.1f} s",
                                    seconds_of(monotonic_now() - *silent))
                      : std::string(what);
    };
    if (!saver->finish(end - monotonic_now()))
        return too_long("the disk took too long for the previous save");
    FusedMap last = pipeline.take_map();
    SnapshotOrigin origin;
    try {
        origin = make_ready_to_save(last);
    } catch (const std::bad_alloc&) {  // the next daemon does not know its age: all of it is stale
        origin = {.mapping_crc32 = settings.recorded.mapping_crc32(),
                  .placement_crc32 = settings.recorded.placement_crc32};
    }
    saver->save_last(std::move(last), origin);
    if (!saver->finish(end - monotonic_now())) return too_long("the disk took too long");
    return saver->record().error;
}

}  // namespace octoskin
