#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {
namespace {

/// Without nodes only the daemon's own SYNC is on the bus. The silence until the next one looks like a time
/// jump, and a problem that comes and goes would fill the log.
bool is_time_shared(const DaemonView& view) {
    const auto& nodes = view.pipeline->intake().nodes().records();
    const bool has_node =
        std::ranges::any_of(nodes, [](const auto& node) { return node.second.heartbeat.has_value(); });
    const bool has_joints = view.inputs->joints() != nullptr && view.inputs->joints()->samples() > 0;
    return has_node || has_joints || view.is_listen_only;
}

Problem no_exchange(const DaemonView& view) {
    if (view.is_listen_only) {
        return {.code = ProblemCode::time_unknown,
                .what = "the time is not known, because no host on the bus sends SYNC and FOLLOW_UP",
                .remedy = "start such a host, or this one without --listen-only"};
    }
    return {
        .code = ProblemCode::time_unknown,
        .what = fmt::format("the time is not known yet: nodes are active, but no SYNC of this host reached "
                            "the bus (can.not_sent, {})",
                            view.inputs->can().counts().not_sent),
        .key = "can.not_sent"};
}

}  // namespace

/// Frames get their time stamps from this machine's clock. While it is impossible, no frame has a time.
void add_wall_clock(const DaemonView& view, Problems& problems) {
    if (view.is_wall_clock_right) return;
    problems.push_back(
        {.code = ProblemCode::wall_clock_wrong,
         .what = "this machine's clock shows a time before 1970 or after 2199, and frames get their time "
                 "stamps from it",
         .remedy = "set it (`sudo timedatectl set-time '2026-01-31 12:00:00'`, or `set-ntp true`)"});
}

void add_link(const DaemonView& view, Problems& problems) {
    if (view.inputs->can().state() != LinkState::up) {
        const auto state = static_cast<std::size_t>(view.inputs->can().state());
        const std::string why = view.inputs->can().why();
        problems.push_back({.code = ProblemCode::can_link,
                            .on = fmt::format("CAN {}", names_of(LinkState{})[state]),
                            .what = why,
                            .detail = why,
                            .subject = "CAN"});
    }
    const CanLink::Counts counts = view.inputs->can().counts();
    if (counts.dropped > 0) {
        problems.push_back({.code = ProblemCode::kernel_dropped,
                            .on = *view.interface,
                            .what = "the kernel dropped frames, because this machine is, or was, too busy"});
    }
}

void add_other_hosts(const DaemonView& view, Problems& problems) {
    constexpr Nanoseconds kForeignHold{3'000'000'000};
    const auto foreign = view.inputs->foreign_sync();
    if (!view.is_listen_only && foreign && view.now - *foreign < kForeignHold) {
        problems.push_back({.code = ProblemCode::another_host,
                            .what = "another host sends SYNC or FOLLOW_UP on this bus, and only one may",
                            .remedy = "start this one with --listen-only"});
    }
    constexpr Nanoseconds kLeapTold{60'000'000'000};
    if (view.used.time_back && view.now - *view.used.time_back < kLeapTold) {
        problems.push_back(
            {.code = ProblemCode::time_back,
             .what = fmt::format(
                 "the bus time went back (times_back, {}) within the last minute: the host that sends SYNC "
                 "restarted, or there are two; joint states and readings continue at the new time",
                 view.pipeline->times_back()),
             .key = "times_back"});
    }
    if (view.used.time_ahead && view.now - *view.used.time_ahead < kLeapTold) {
        problems.push_back(
            {.code = ProblemCode::time_ahead,
             .what = fmt::format(
                 "the bus time jumped ahead (times_ahead, {}) within the last minute: another host sends "
                 "SYNC, or the clock of the host was set; the age of the map does not change",
                 view.pipeline->times_ahead()),
             .key = "times_ahead"});
    }
}

void add_clock(const DaemonView& view, Problems& problems) {
    const auto fault = view.pipeline->intake().host_clock().fault();
    std::optional<Problem> problem;
    if (!is_time_shared(view)) {
        problem = {
            .code = ProblemCode::time_unknown,
            .what = fault == HostClockFault::no_exchange
                        ? "the time is not known yet: no SYNC of this host reached the bus, and no node "
                          "is active"
                        : "the time is not known: no node is active that would share it"};
    } else if (fault == HostClockFault::no_exchange) {
        problem = no_exchange(view);
    } else if (fault == HostClockFault::stamps_jumped) {
        problem = {.code = ProblemCode::time_in_doubt,
                   .what =
                       "the time is in doubt: the time stamps of received frames went back, or ahead by "
                       "over 0.14 s: the bus was silent, or this machine's clock was set. The next SYNC "
                       "with its FOLLOW_UP resolves it",
                   .detail = "stamps"};
    } else if (fault == HostClockFault::exchanges_disagree) {
        problem = {.code = ProblemCode::time_in_doubt,
                   .what =
                       "the time is in doubt: the newest SYNC with its FOLLOW_UP differs from the earlier "
                       "ones by over 20 ms: a clock was set, or a frame got a late time stamp. Two in a "
                       "row that agree resolve it",
                   .detail = "exchanges"};
    }
    if (!problem) return;
    problem->subject = "time";
    problems.push_back(*std::move(problem));
}

}  // namespace octoskin
