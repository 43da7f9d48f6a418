#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/problems/unused_input.hpp"
#include "host/core/pipeline/joint_text.hpp"

namespace octoskin {
namespace {

/// "wrong_count 5, time_off 1"; empty if nothing was refused.
std::string refused_lines(const JointSocket& socket) {
    constexpr auto kNames = names_of(JointTextFault{});
    std::string text;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        const std::uint64_t count = socket.faults().at(i);
        if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kNames.at(i), count);
    }
    return text;
}

/// For samples that come through the socket.
constexpr const char* kSendThem =
    "send them with `octoskin joints`, or start `octoskin bridge`, which takes them from ROS 2";

/// "node 61" or "nodes 61, 62".
std::string nodes_text(const HostRig& rig) {
    std::vector<int> nodes;
    for (const HostJointSource& source : rig.joint_sources) nodes.push_back(source.node_id);
    return fmt::format("{} {}", nodes.size() == 1 ? "node" : "nodes", fmt::join(nodes, ", "));
}

Problem no_joints(const DaemonView& view) {
    Problem problem{.code = ProblemCode::joints_missing, .subject = "joints"};
    const JointSocket* const socket = view.inputs->joints();
    if (socket == nullptr) {
        problem.what =
            fmt::format("no joint states: none from {} on the bus (and no --joints)", nodes_text(*view.rig));
    } else if (const std::string refused = refused_lines(*socket); !refused.empty()) {
        problem.what = fmt::format(
            "no joint states, because the lines that come through the socket are refused ({}, the "
            "newest of {})",
            refused, describe(socket->newest_refused().value()));
        problem.remedy = fmt::format("expected is {}", kJointTextWanted);
    } else if (view.inputs->joints_of_several() > 0) {
        problem.what = fmt::format(
            "no joint states, because several programs send them through the socket "
            "(second_sender, {})",
            view.inputs->joints_of_several());
        problem.remedy = "let only one program send them";
        problem.key = "second_sender";
    } else if (view.pipeline->inputs().frames.rejected(FrameReason::joint_no_host_time) > 0) {
        problem.what =
            "no joint states: those that come through the socket have no time on the bus clock "
            "(joint_no_host_time), because no host sends SYNC and FOLLOW_UP on the bus";
        problem.key = "joint_no_host_time";
    } else {
        problem.what = "no joint states: none comes through the socket";
        problem.remedy = kSendThem;
    }
    return problem;
}

Problem stopped_joints(const InputCounters<JointReason>& joints) {
    Problem problem{.code = ProblemCode::joints_stopped,
                    .what = "joint states have stopped, and readings have no pose",
                    .subject = "joints"};
    const std::uint64_t refused = joints.rejected(JointReason::wrong_count);
    if (refused == 0) return problem;
    problem.what +=
        fmt::format("; refused because they have more joints than the rig (wrong_count, {})", refused);
    problem.key = "wrong_count";
    return problem;
}

/// "process 4711 (python3, user 1000) and process 4712 (octoskin, user 1000)".
std::string names_of_senders(const std::vector<JointSenders::Heard>& senders) {
    std::string text;
    for (const JointSenders::Heard& heard : senders)
        text += (text.empty() ? "" : " and ") + describe(heard.sender, heard.program);
    return text;
}

bool is_recent(const std::optional<HostTime>& at, HostTime now) {
    constexpr Nanoseconds kTold{3'000'000'000};  // longer than a person or a script waits between looks
    return at && now - *at < kTold;
}

double highest_rate_hz(const HostRig& rig) {
    return std::ranges::max(rig.joint_sources, {}, &HostJointSource::rate_hz).rate_hz;
}

/// Of several sources the node; with one source there is nothing to tell apart.
std::string on_of(const DaemonView& view, std::size_t source) {
    const auto& sources = view.rig->joint_sources;
    return sources.size() > 1 ? fmt::format("joints of node {}", sources[source].node_id) : std::string();
}

bool is_local(const DaemonView& view, std::size_t source) {
    return view.rig->joint_sources[source].is_local;
}

/// The source whose senders contradicted each other last, or most often so far.
std::size_t contradicted_source(const DaemonView& view) {
    const CanIntake& intake = view.pipeline->intake();
    std::size_t found = 0;
    for (std::size_t i = 0; i < view.rig->joint_sources.size(); ++i) {
        const JointSenderCheck& senders = intake.joint_senders(i);
        if (view.bus_now && senders.hears_two(*view.bus_now)) return i;
        if (senders.contradictions() > intake.joint_senders(found).contradictions()) found = i;
    }
    return found;
}

/// The senders of that source of the socket that had several last; null if none had.
const JointSenders* newest_several(const JointSocket* socket) {
    const JointSenders* newest = nullptr;
    for (std::size_t i = 0; socket != nullptr && i < socket->joints().sources.size(); ++i) {
        const JointSenders& senders = socket->senders(i);
        if (senders.several_at() && (newest == nullptr || senders.several_at() > newest->several_at()))
            newest = &senders;
    }
    return newest;
}

void add_joint_jump(const DaemonView& view, Problems& problems) {
    const auto found = newest_jump(view);
    if (!found || !is_recent(view.used.joint_jump, view.now)) return;
    const JointJumped* const jumped = found->jumped;
    problems.push_back(
        {.code = ProblemCode::joint_jump,
         .what = fmt::format(
             "joint states jump: {} went from {:.3f} to {:.3f} in {:.0f} ms, but the robot "
             "description allows at most {:.3f} (joint_jump, {}): another program sends joint "
             "states too, or the velocity of its <limit> is too low",
             found->name, jumped->from, jumped->to, 1e3 * seconds_of(jumped->passed), jumped->step_max,
             view.pipeline->inputs().joint_samples.rejected(JointReason::joint_jump)),
         .key = "joint_jump"});
}

/// Several senders, none of which is used. They differ in their process, or their samples contradict each
/// other.
void add_joint_senders(const DaemonView& view, Problems& problems) {
    add_joint_jump(view, problems);
    const JointSocket* const socket = view.inputs->joints();
    if (const JointSenders* const several = newest_several(socket);
        several != nullptr && is_recent(several->several_at(), view.now)) {
        problems.push_back(
            {.code = ProblemCode::joint_senders,
             .what =
                 fmt::format("joint states come through the socket from more than one program, and none is "
                             "used until all but one have been silent for a second (second_sender, {}): {}",
                             view.inputs->joints_of_several(), names_of_senders(several->newest_several())),
             .key = "second_sender"});
        return;
    }
    if (!is_recent(view.used.joint_senders, view.now)) return;
    const std::uint64_t withheld = view.pipeline->inputs().joint_samples.rejected(JointReason::second_sender);
    const std::size_t source = contradicted_source(view);
    problems.push_back(
        {.code = ProblemCode::joint_senders,
         .what = is_local(view, source)
                     ? fmt::format(
                           "joint states through the socket jump to and fro, as from two arms or as late "
                           "samples without TIME do; none is used until they have not jumped for a second "
                           "(second_sender, {})",
                           withheld)
                     : fmt::format(
                           "two senders send joint states under node {}, and neither is used until they have "
                           "not contradicted each other for a second (second_sender, {}): the joint node and "
                           "another board of that id, or `octoskin joints --can` beside it",
                           view.rig->joint_sources.at(source).node_id, withheld),
         .key = "second_sender"});
}

void add_joints_beyond(const DaemonView& view, Problems& problems) {
    for (std::size_t i = 0; i < view.rig->joint_sources.size(); ++i) {
        const auto& beyond = view.pipeline->joint_gate(i).beyond();
        if (!beyond || !is_recent(beyond->sampled, view.now)) continue;
        problems.push_back({.code = ProblemCode::joint_limits,
                            .on = on_of(view, i),
                            .what = beyond_text(*beyond, view.rig->joint_sources[i].joints)});
    }
}

/// Readings between two samples that are too far apart have no pose.
void add_joint_gap(const DaemonView& view, Problems& problems) {
    constexpr std::uint64_t kSlow = 3;  // fewer are an interruption
    const RobotTracker& robot = view.pipeline->builder().robot();
    for (std::size_t i = 0; i < view.rig->joint_sources.size(); ++i) {
        const auto& gap = robot.newest_gap(i);
        if (!gap || !is_recent(gap->instant, view.now) || robot.gaps_in_a_row(i) < kSlow) continue;
        problems.push_back({.code = ProblemCode::joint_gap,
                            .on = on_of(view, i),
                            .what = "readings have no pose (joints_missing). " + gap_text(*gap),
                            .key = "joints_missing"});
    }
}

/// What of the counters may be why a source has no samples that are used.
void add_cause(const DaemonView& view, std::size_t source, Problem& problem) {
    const JointSocket* const socket = view.inputs->joints();
    const std::string refused = socket != nullptr ? refused_lines(*socket) : std::string();
    if (is_local(view, source) && !refused.empty()) {
        problem.what += fmt::format("; lines through the socket were refused ({}, the newest of {})", refused,
                                    describe(socket->newest_refused().value()));
        problem.remedy = fmt::format("expected is {}", kJointTextWanted);
        return;
    }
    if (is_local(view, source)) problem.remedy = kSendThem;
    const auto& joints = view.pipeline->inputs().joint_samples;
    if (joints.rejected() > 0) problem.what += "; of all sources " + see_counters("joint samples", joints);
}

/// Of several sources, one that is silent while others send.
void add_silent_sources(const DaemonView& view, Problems& problems) {
    const auto& sources = view.rig->joint_sources;
    const RobotTracker& robot = view.pipeline->builder().robot();
    for (std::size_t i = 0; i < sources.size() && sources.size() > 1; ++i) {
        const auto newest = robot.newest_sample(i);
        if (newest && !has_stopped(newest, view.bus_reckoned)) continue;
        Problem problem{
            .code = newest ? ProblemCode::joints_stopped : ProblemCode::joints_missing,
            .on = on_of(view, i),
            .what = fmt::format(
                "no joint states of {} {}: sensors that they move are not placed (joints_missing), "
                "and all is left out where bodies that they move can be",
                fmt::join(sources[i].joints, ", "), newest ? "any more" : "yet"),
            .key = "joints_missing"};
        add_cause(view, i, problem);
        problems.push_back(std::move(problem));
    }
}

}  // namespace

std::optional<JumpOfJoint> newest_jump(const DaemonView& view) {
    std::optional<JumpOfJoint> newest;
    for (std::size_t i = 0; i < view.rig->joint_sources.size(); ++i) {
        const auto& jumped = view.pipeline->joint_gate(i).jump().newest();
        if (jumped && (!newest || jumped->sampled > newest->jumped->sampled))
            newest = {view.rig->joint_sources[i].joints.at(jumped->joint), &*jumped};
    }
    return newest;
}

bool are_joints_withheld(const DaemonView& view) {
    constexpr Nanoseconds kHold = JointSenders::kHeardFor;
    const auto is_new = [&](const std::optional<HostTime>& at) { return at && view.now - *at < kHold; };
    const JointSenders* const several = newest_several(view.inputs->joints());
    return is_new(view.used.joint_senders) || (several != nullptr && is_new(several->several_at()));
}

bool are_joints_above_rate(const DaemonView& view) {
    constexpr double kAbout = 1.3;
    const JointSocket* const socket = view.inputs->joints();
    if (socket == nullptr) return false;
    const auto& sources = socket->joints().sources;
    for (std::size_t i = 0; i < sources.size(); ++i)
        if (socket->rate_hz(i, view.now) > kAbout * sources[i].rate_hz) return true;
    return false;
}

void add_joints(const DaemonView& view, Problems& problems) {
    constexpr std::uint64_t kFirstSamples = 5;  // of a new source, whose rate is not known yet
    const auto& joints = view.pipeline->inputs().joint_samples;
    add_joint_senders(view, problems);
    add_joints_beyond(view, problems);
    add_joint_gap(view, problems);
    if (joints.in() == 0) {
        problems.push_back(no_joints(view));
    } else if (!view.used.joint_sample) {
        problems.push_back({.code = ProblemCode::joints_unused,
                            .what = "no joint state could be used: " + see_counters("joint samples", joints),
                            .subject = "joints"});
    } else if (has_stopped(view.used.joint_sample, view.now)) {
        problems.push_back(stopped_joints(joints));
    } else {
        add_silent_sources(view, problems);
    }
    if (view.inputs->is_flooded(view.now)) {
        problems.push_back(
            {.code = ProblemCode::joints_flood,
             .what = fmt::format(
                 "joint states come, or came, through the socket faster than they can be taken: {} were "
                 "displaced by newer ones (displaced), {} exceeded the rate of one program, or came from "
                 "more than {} programs (surplus); the rig has {:g} Hz, and a higher rate is of no use",
                 view.inputs->joints_displaced(), view.inputs->joints()->surplus(), SenderShares::kSendersMax,
                 highest_rate_hz(*view.rig)),
             .key = "surplus"});
    }
    if (joints.rejected(JointReason::too_frequent) > kFirstSamples) {
        problems.push_back(
            {.code = ProblemCode::joints_too_frequent,
             .what = fmt::format("joint states come, or came, faster than the {:g} Hz of the rig, and were "
                                 "refused (too_frequent, {})",
                                 highest_rate_hz(*view.rig), joints.rejected(JointReason::too_frequent)),
             .remedy = "set joints.rate_hz to the true rate",
             .key = "joints.rate_hz"});
    }
}

}  // namespace octoskin
