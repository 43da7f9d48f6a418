#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {

void add_map(const DaemonView& view, Problems& problems) {
    const FusedMap& map = view.pipeline->map();
    if (map.counters().no_room > 0) {
        problems.push_back(
            {.code = ProblemCode::map_full,
             .what = fmt::format("the map is full ({} MiB) and takes no new space; {} updates found no room "
                                 "(no_room)",
                                 map.config().memory_max_mib, map.counters().no_room),
             .remedy = "raise map.memory_max_mib in the mapping file",
             .key = "map.memory_max_mib"});
    }
    if (map.counters().no_memory > 0) {
        problems.push_back(
            {.code = ProblemCode::map_no_memory,
             .what = fmt::format("the system had no memory for new space of the map; {} updates were refused "
                                 "(no_memory)",
                                 map.counters().no_memory),
             .remedy = "lower map.memory_max_mib in the mapping file, or give the service more memory",
             .key = "map.memory_max_mib"});
    }
    if (view.maps_silent_since) {
        problems.push_back(
            {.code = ProblemCode::maps_folder_silent,
             .what =
                 fmt::format("the maps' folder has not answered for {:.0f} s, and the map is not saved: its "
                             "file system hangs (a network mount, FUSE, a failing disk); mapping, queries "
                             "and recordings elsewhere continue",
                             seconds_of(view.now - *view.maps_silent_since))});
    }
    if (!view.maps_problem.empty())
        problems.push_back({.code = ProblemCode::maps_folder, .what = view.maps_problem, .subject = "maps"});
    if (!view.saves.error.empty()) {
        problems.push_back(
            {.code = ProblemCode::map_not_saved, .what = "the map is not saved: " + view.saves.error});
    }
    if (view.recorder != nullptr && !view.recorder->error().empty()) {
        problems.push_back({.code = ProblemCode::recording_failed,
                            .what = "the recording has failed: " + view.recorder->error()});
    } else if (view.recorder != nullptr && !view.recorder->is_complete()) {
        problems.push_back(
            {.code = ProblemCode::recording_incomplete,
             .what = "the recording is incomplete, and its replay gives another map",
             .remedy = "see recording.lost_commits and lost_depth (the disk was too slow, there was no "
                       "memory, or depth was beyond 32.767 m)",
             .key = "recording.lost_commits"});
    }
    constexpr Nanoseconds kWriting{10'000'000'000};
    const auto writing = view.recorder != nullptr ? view.recorder->writing_since() : std::nullopt;
    if (writing && view.now - *writing > kWriting) {
        problems.push_back({.code = ProblemCode::recording_silent,
                            .what = fmt::format(
                                "the recording's folder {} has not answered for {:.0f} s: new data waits, up "
                                "to some MiB, and what exceeds that is lost",
                                view.recorder->folder().string(), seconds_of(view.now - *writing))});
    }
    if (!view.recording_refusal.empty()) {
        problems.push_back({.code = ProblemCode::recording_refused,
                            .what = "the newest recording did not start: " + view.recording_refusal});
    }
    constexpr Nanoseconds kReading{3'000'000'000};
    if (view.reloads.reading_since && view.now - *view.reloads.reading_since > kReading) {
        problems.push_back(
            {.code = ProblemCode::reload_silent,
             .what =
                 fmt::format("SIGHUP: reading rig, robot and mapping has taken {:.0f} s: the file system of "
                             "one of them hangs; the old settings stay in force until the reading ends",
                             seconds_of(view.now - *view.reloads.reading_since))});
    }
    if (!view.reload_error.empty()) {
        problems.push_back({.code = ProblemCode::reload_refused,
                            .what = "the newest reload was refused, and the old settings stay in force: " +
                                    view.reload_error,
                            .detail = view.reload_error,
                            .subject = "reload"});
    }
}

}  // namespace octoskin
