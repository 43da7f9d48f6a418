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

std::string why_no_joints(const DaemonView& view) {
    const JointSocket* const socket = view.inputs->joints();
    if (socket == nullptr) {
        return fmt::format("no joint states: none from node {} on the bus (and no --joints)",
                           view.rig->joints.node_id);
    }
    if (const std::string refused = refused_lines(*socket); !refused.empty())
        return fmt::format(
            "no joint states: the lines that come through the socket are refused ({}, the newest of {}); "
            "expected: {}",
            refused, describe(socket->newest_refused().value()), kJointTextWanted);
    if (view.inputs->joints_of_several() > 0) {
        return fmt::format(
            "no joint states: several programs send them through the socket (second_sender, {}); let only "
            "one send",
            view.inputs->joints_of_several());
    }
    if (view.pipeline->inputs().frames.rejected(FrameReason::joint_no_host_time) > 0) {
        return "no joint states: those that come through the socket have no time on the bus clock "
               "(joint_no_host_time): no host sends SYNC and FOLLOW_UP on the bus";
    }
    return "no joint states: none comes through the socket; send them with `octoskin joints`";
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
    problems.push_back(
        {"joint jump",
         fmt::format("joint states jump: {} went from {:.3f} to {:.3f} in {:.0f} ms, but the robot "
                     "description allows at most {:.3f} (joint_jump, {}): another program sends joint states "
                     "too, or the velocity of its <limit> is too low",
                     view.rig->joints.joints.at(jumped->joint), jumped->from, jumped->to,
                     1e3 * seconds_of(jumped->passed), jumped->step_max,
                     view.pipeline->inputs().joint_samples.rejected(JointReason::joint_jump))});
}

/// Senders that are not used while another one is active, by the means that distinguishes the two.
void add_joint_senders(const DaemonView& view, Problems& problems) {
    add_joint_jump(view, problems);
    const JointSocket* const socket = view.inputs->joints();
    if (socket != nullptr && is_recent(socket->senders().several_at(), view.now)) {
        problems.push_back(
            {"joint senders",
             fmt::format("joint states come through the socket from more than one program, and none is used "
                         "until all but one have been silent for a second (second_sender, {}): {}",
                         view.inputs->joints_of_several(),
                         names_of_senders(socket->senders().newest_several()))});
        return;
    }
    if (!is_recent(view.used.joint_senders, view.now)) return;
    const std::uint64_t withheld = view.pipeline->inputs().joint_samples.rejected(JointReason::second_sender);
    problems.push_back(
        {"joint senders",
         socket != nullptr
             ? fmt::format(
                   "joint states through the socket jump to and fro, as those of two arms or of late samples "
                   "without TIME; none is used until this has not happened for a second (second_sender, {})",
                   withheld)
             : fmt::format("two senders send joint states under node {}, and neither is used until they have "
                           "not contradicted each other for a second (second_sender, {}): the joint node and "
                           "another board of that id, or `octoskin joints --can` beside it",
                           view.rig->joints.node_id, withheld)});
}

void add_joints_beyond(const DaemonView& view, Problems& problems) {
    const auto& beyond = view.pipeline->joint_gate().beyond();
    if (!beyond || !is_recent(beyond->sampled, view.now)) return;
    problems.push_back({"joints beyond limits", beyond_text(*beyond, view.rig->joints.joints)});
}

/// Readings between two samples that are too far apart have no pose.
void add_joint_gap(const DaemonView& view, Problems& problems) {
    const auto& gap = view.pipeline->builder().newest_joint_gap();
    constexpr std::uint64_t kSlow = 3;  // fewer are an interruption
    if (!gap || !is_recent(gap->instant, view.now)) return;
    if (view.pipeline->builder().joint_gaps_in_a_row() < kSlow) return;
    problems.push_back({"joint gap", "readings have no pose (joints_missing). " + gap_text(*gap)});
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
    constexpr std::uint64_t kFirstSamples = 5;  // of a source: its rate is not known yet
    const auto& joints = view.pipeline->inputs().joint_samples;
    add_joint_senders(view, problems);
    add_joints_beyond(view, problems);
    add_joint_gap(view, problems);
    if (joints.in() == 0) {
        problems.push_back({"no joints", why_no_joints(view), "joints"});
    } else if (!view.used.joint_sample) {
        problems.push_back({"joints unused",
                            "no joint state could be used: " + see_counters("joint samples", joints),
                            "joints"});
    } else if (has_stopped(view.used.joint_sample, view.now)) {
        problems.push_back({"joints stopped", "joint states have stopped: readings have no pose", "joints"});
    }
    if (view.inputs->is_flooded(view.now)) {
        problems.push_back(
            {"joints flood",
             fmt::format(
                 "joint states come, or came, through the socket faster than they can be taken: {} were "
                 "displaced by newer ones (displaced), {} were more than one program may send, or came from "
                 "more than {} programs (surplus); the rig has {} Hz, and a higher rate is of no use",
                 view.inputs->joints_displaced(), view.inputs->joints()->surplus(), SenderShares::kSendersMax,
                 view.rig->joints.rate_hz)});
    }
    if (joints.rejected(JointReason::too_frequent) > kFirstSamples) {
        problems.push_back(
            {"joints too frequent",
             fmt::format("joint states come, or came, faster than the {} Hz of the rig, and were refused "
                         "(too_frequent, {}): set joints.rate_hz to the true rate",
                         view.rig->joints.rate_hz, joints.rejected(JointReason::too_frequent))});
    }
}

}  // namespace octoskin
