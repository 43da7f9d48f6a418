#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {

void add_map(const DaemonView& view, Problems& problems) {
    const FusedMap& map = view.pipeline->map();
    if (map.counters().no_room > 0) {
        problems.push_back(
            {"map full", fmt::format("the map is full ({} MiB): it takes no new space, {} updates found no "
                                     "room (no_room); raise map.memory_max_mib in the mapping file",
                                     map.config().memory_max_mib, map.counters().no_room)});
    }
    if (map.counters().no_memory > 0) {
        problems.push_back({"map without memory",
                            fmt::format("the system had no memory for new space of the map: {} updates were "
                                        "refused (no_memory); lower map.memory_max_mib in the mapping file, "
                                        "or give the service more",
                                        map.counters().no_memory)});
    }
    if (view.maps_silent_since) {
        problems.push_back({"maps folder silent",
                            fmt::format("the maps' folder has not answered for {:.0f} s, and the map is not "
                                        "saved: its file system hangs (a network mount, FUSE, a failing "
                                        "disk); mapping, queries and recordings elsewhere continue",
                                        seconds_of(view.now - *view.maps_silent_since))});
    }
    if (!view.maps_problem.empty()) problems.push_back({"maps folder", view.maps_problem, "maps"});
    if (!view.saves.error.empty())
        problems.push_back({"map not saved", "the map is not saved: " + view.saves.error});
    if (view.recorder != nullptr && !view.recorder->error().empty()) {
        problems.push_back({"recording failed", "the recording has failed: " + view.recorder->error()});
    } else if (view.recorder != nullptr && !view.recorder->is_complete()) {
        problems.push_back(
            {"recording incomplete",
             "the recording is incomplete, and its replay gives another map: see recording.lost_commits and "
             "lost_depth (the disk was too slow, there was no memory, or depth was beyond 32.767 m)"});
    }
    constexpr Nanoseconds kWriting{10'000'000'000};
    const auto writing = view.recorder != nullptr ? view.recorder->writing_since() : std::nullopt;
    if (writing && view.now - *writing > kWriting) {
        problems.push_back({"recording silent",
                            fmt::format("the recording's folder {} has not answered for {:.0f} s: new data "
                                        "waits, up to some MiB, and what exceeds that is lost",
                                        view.recorder->folder().string(), seconds_of(view.now - *writing))});
    }
    if (!view.recording_refusal.empty())
        problems.push_back(
            {"recording refused", "the newest recording did not start: " + view.recording_refusal});
    constexpr Nanoseconds kReading{3'000'000'000};
    if (view.reloads.reading_since && view.now - *view.reloads.reading_since > kReading) {
        problems.push_back(
            {"reload silent",
             fmt::format("SIGHUP: reading rig, robot and mapping has taken {:.0f} s: the file system of one "
                         "of them hangs; the old settings stay in force until it ends",
                         seconds_of(view.now - *view.reloads.reading_since))});
    }
    if (!view.reload_error.empty())
        problems.push_back(
            {"reload " + view.reload_error,
             "the newest reload was refused, and the old settings stay in force: " + view.reload_error,
             "reload"});
}

}  // namespace octoskin
