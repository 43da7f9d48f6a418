#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <string>

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

Problem no_joints(const DaemonView& view) {
    Problem problem{.code = ProblemCode::joints_missing, .subject = "joints"};
    const JointSocket* const socket = view.inputs->joints();
    if (socket == nullptr) {
        problem.what = fmt::format("no joint states: none from node {} on the bus (and no --joints)",
                                   view.rig->joints.node_id);
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
        problem.remedy = "send them with `octoskin joints`";
    }
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

void add_joint_jump(const DaemonView& view, Problems& problems) {
    const auto& jumped = view.pipeline->joint_gate().jump().newest();
    if (!jumped || !is_recent(view.used.joint_jump, view.now)) return;
    problems.push_back({.code = ProblemCode::joint_jump,
                        .what = fmt::format(
                            "joint states jump: {} went from {:.3f} to {:.3f} in {:.0f} ms, but the robot "
                            "description allows at most {:.3f} (joint_jump, {}): another program sends joint "
                            "states too, or the velocity of its <limit> is too low",
                            view.rig->joints.joints.at(jumped->joint), jumped->from, jumped->to,
                            1e3 * seconds_of(jumped->passed), jumped->step_max,
                            view.pipeline->inputs().joint_samples.rejected(JointReason::joint_jump)),
                        .key = "joint_jump"});
}

/// Several senders, none of which is used. They differ in their process, or their samples contradict each
/// other.
void add_joint_senders(const DaemonView& view, Problems& problems) {
    add_joint_jump(view, problems);
    const JointSocket* const socket = view.inputs->joints();
    if (socket != nullptr && is_recent(socket->senders().several_at(), view.now)) {
        problems.push_back(
            {.code = ProblemCode::joint_senders,
             .what = fmt::format(
                 "joint states come through the socket from more than one program, and none is "
                 "used until all but one have been silent for a second (second_sender, {}): {}",
                 view.inputs->joints_of_several(), names_of_senders(socket->senders().newest_several())),
             .key = "second_sender"});
        return;
    }
    if (!is_recent(view.used.joint_senders, view.now)) return;
    const std::uint64_t withheld = view.pipeline->inputs().joint_samples.rejected(JointReason::second_sender);
    problems.push_back(
        {.code = ProblemCode::joint_senders,
         .what = socket != nullptr
                     ? fmt::format(
                           "joint states through the socket jump to and fro, as from two arms or as late "
                           "samples without TIME do; none is used until they have not jumped for a second "
                           "(second_sender, {})",
                           withheld)
                     : fmt::format(
                           "two senders send joint states under node {}, and neither is used until they have "
                           "not contradicted each other for a second (second_sender, {}): the joint node and "
                           "another board of that id, or `octoskin joints --can` beside it",
                           view.rig->joints.node_id, withheld),
         .key = "second_sender"});
}

void add_joints_beyond(const DaemonView& view, Problems& problems) {
    const auto& beyond = view.pipeline->joint_gate().beyond();
    if (!beyond || !is_recent(beyond->sampled, view.now)) return;
    problems.push_back(
        {.code = ProblemCode::joint_limits, .what = beyond_text(*beyond, view.rig->joints.joints)});
}

/// Readings between two samples that are too far apart have no pose.
void add_joint_gap(const DaemonView& view, Problems& problems) {
    const auto& gap = view.pipeline->builder().newest_joint_gap();
    constexpr std::uint64_t kSlow = 3;  // fewer are an interruption
    if (!gap || !is_recent(gap->instant, view.now)) return;
    if (view.pipeline->builder().joint_gaps_in_a_row() < kSlow) return;
    problems.push_back({.code = ProblemCode::joint_gap,
                        .what = "readings have no pose (joints_missing). " + gap_text(*gap),
                        .key = "joints_missing"});
}

}  // namespace

bool are_joints_withheld(const DaemonView& view) {
    constexpr Nanoseconds kHold = JointSenders::kHeardFor;
    const auto is_new = [&](const std::optional<HostTime>& at) { return at && view.now - *at < kHold; };
    const JointSocket* const socket = view.inputs->joints();
    return is_new(view.used.joint_senders) || (socket != nullptr && is_new(socket->senders().several_at()));
}

bool are_joints_above_rate(const DaemonView& view) {
    constexpr double kAbout = 1.3;
    const JointSocket* const socket = view.inputs->joints();
    return socket != nullptr && socket->rate_hz(view.now) > kAbout * view.rig->joints.rate_hz;
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
        problems.push_back({.code = ProblemCode::joints_stopped,
                            .what = "joint states have stopped, and readings have no pose",
                            .subject = "joints"});
    }
    if (view.inputs->is_flooded(view.now)) {
        problems.push_back(
            {.code = ProblemCode::joints_flood,
             .what = fmt::format(
                 "joint states come, or came, through the socket faster than they can be taken: {} were "
                 "displaced by newer ones (displaced), {} exceeded the rate of one program, or came from "
                 "more than {} programs (surplus); the rig has {} Hz, and a higher rate is of no use",
                 view.inputs->joints_displaced(), view.inputs->joints()->surplus(), SenderShares::kSendersMax,
                 view.rig->joints.rate_hz),
             .key = "surplus"});
    }
    if (joints.rejected(JointReason::too_frequent) > kFirstSamples) {
        problems.push_back(
            {.code = ProblemCode::joints_too_frequent,
             .what = fmt::format("joint states come, or came, faster than the {} Hz of the rig, and were "
                                 "refused (too_frequent, {})",
                                 view.rig->joints.rate_hz, joints.rejected(JointReason::too_frequent)),
             .remedy = "set joints.rate_hz to the true rate",
             .key = "joints.rate_hz"});
    }
}

}  // namespace octoskin
