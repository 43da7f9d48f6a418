#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {
namespace {

/// Without nodes the daemon's own SYNC only defines a time from each SYNC to the next, which then looks like
/// a time jump. No other device shares that time, and a problem that comes and goes would fill the log.
bool is_time_shared(const DaemonView& view) {
    const auto& nodes = view.pipeline->intake().nodes().records();
    const bool has_node =
        std::ranges::any_of(nodes, [](const auto& node) { return node.second.heartbeat.has_value(); });
    const bool has_joints = view.inputs->joints() != nullptr && view.inputs->joints()->samples() > 0;
    return has_node || has_joints || view.is_listen_only;
}

std::string why_no_exchange(const DaemonView& view) {
    if (view.is_listen_only)
        return "the time is not known: no host on the bus sends SYNC and FOLLOW_UP (--listen-only sends "
               "none)";
    return fmt::format(
        "the time is not known yet: nodes are active, but no SYNC of this host reached the bus "
        "(can.not_sent, {})",
        view.inputs->can().counts().not_sent);
}

}  // namespace

/// Each frame's time stamp comes from this clock: with an impossible wall time no frame has a time.
void add_wall_clock(const DaemonView& view, Problems& problems) {
    if (view.is_wall_clock_right) return;
    problems.push_back(
        {"wall clock",
         "this machine's clock shows a time before 1970 or after 2199, and frames get their time stamps from "
         "it: set it (`sudo timedatectl set-time '2026-01-31 12:00:00'`, or `set-ntp true`)"});
}

void add_link(const DaemonView& view, Problems& problems) {
    if (view.inputs->can().state() != LinkState::up) {
        const std::string text = fmt::format(
            "CAN {}: {}", names_of(LinkState{})[static_cast<std::size_t>(view.inputs->can().state())],
            view.inputs->can().why());
        problems.push_back({text, text, "CAN"});
    }
    const CanLink::Counts counts = view.inputs->can().counts();
    if (counts.dropped > 0) {
        problems.push_back(
            {"kernel", fmt::format("{}: the kernel dropped frames: this machine is, or was, too busy",
                                   *view.interface)});
    }
}

void add_other_hosts(const DaemonView& view, Problems& problems) {
    constexpr Nanoseconds kForeignHold{3'000'000'000};
    const auto foreign = view.inputs->foreign_sync();
    if (!view.is_listen_only && foreign && view.now - *foreign < kForeignHold) {
        problems.push_back(
            {"another host",
             "another host sends SYNC or FOLLOW_UP on this bus: only one may (start this one with "
             "--listen-only)"});
    }
    constexpr Nanoseconds kLeapTold{60'000'000'000};
    if (view.used.time_back && view.now - *view.used.time_back < kLeapTold) {
        problems.push_back(
            {"time back",
             fmt::format(
                 "the bus time went back (times_back, {}) within the last minute: the host that sends SYNC "
                 "restarted, or there are two; joint states and readings continue from there",
                 view.pipeline->times_back())});
    }
    if (view.used.time_ahead && view.now - *view.used.time_ahead < kLeapTold) {
        problems.push_back(
            {"time ahead",
             fmt::format("the bus time jumped ahead (times_ahead, {}) within the last minute: another host "
                         "sends SYNC, or its clock was set; the age of the map does not change",
                         view.pipeline->times_ahead())});
    }
}

void add_clock(const DaemonView& view, Problems& problems) {
    const auto fault = view.pipeline->intake().host_clock().fault();
    if (!is_time_shared(view)) {
        problems.push_back(
            {"no time",
             fault == HostClockFault::no_exchange
                 ? "the time is not known yet: no SYNC of this host reached the bus, and no node is active"
                 : "the time is not known: no node is active that would share it",
             "time"});
    } else if (fault == HostClockFault::no_exchange) {
        problems.push_back({"no time", why_no_exchange(view), "time"});
    } else if (fault == HostClockFault::stamps_jumped) {
        problems.push_back({"time jumped",
                            "the time is in doubt: the time stamps of received frames went back, or ahead by "
                            "over 0.14 s: the bus was silent, or this machine's clock was set. The next SYNC "
                            "with its FOLLOW_UP resolves it",
                            "time"});
    } else if (fault == HostClockFault::exchanges_disagree) {
        problems.push_back(
            {"time disagrees",
             "the time is in doubt: the newest SYNC with its FOLLOW_UP differs from the earlier ones by over "
             "20 ms: a clock was set, or a frame got a late time stamp. Two in a row that agree resolve it",
             "time"});
    }
}

}  // namespace octoskin
