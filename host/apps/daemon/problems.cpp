#include <fmt/format.h>

#include <algorithm>

#include "common/wire/names.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/status.hpp"
#include "host/core/rig/sensor_text.hpp"

namespace octoskin {
namespace {

using Problems = std::vector<Problem>;

/// Each frame's stamp is this clock's: while it shows nonsense no frame has a time.
void add_wall_clock(const DaemonView& view, Problems& problems) {
    if (view.is_wall_clock_right) return;
    problems.push_back({"wall clock",
                        "this machine's clock shows a time before 1970 or after 2199, and frames get their "
                        "stamps from it: set it (`sudo timedatectl set-time '2026-01-31 12:00:00'`, or "
                        "`set-ntp true`)"});
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
            {"kernel", fmt::format("{}: frames were lost in the kernel: this machine is, or was, too busy",
                                   *view.interface)});
    }
}

/// Of those that the rig lists there is nothing to say: they are meant to be so.
void add_links_without_body(const DaemonView& view, Problems& problems) {
    std::string names;
    for (const LinkWithoutBody& link : view.rig->links_without_body) {
        if (!link.is_listed) names += (names.empty() ? "" : ", ") + link.link;
    }
    if (names.empty()) return;
    problems.push_back(
        {"links without body",
         fmt::format(
             "robot: {}: without a body (links_unknown): what the sensors see of it comes into the map, "
             "and a query answers unknown instead of free; give it capsules, or list it in "
             "robot.links_without_body of the rig",
             names)});
}

/// Where no node is, our own SYNC tells a time from each to the next, and then looks like a jump: that is no
/// time that anybody shares, and coming and going it would fill the log.
bool is_time_shared(const DaemonView& view) {
    const auto& nodes = view.pipeline->intake().nodes().records();
    const bool has_node =
        std::ranges::any_of(nodes, [](const auto& node) { return node.second.heartbeat.has_value(); });
    const bool has_joints = view.inputs->joints() != nullptr && view.inputs->joints()->samples() > 0;
    return has_node || has_joints || view.is_listen_only;
}

void add_other_hosts(const DaemonView& view, Problems& problems) {
    constexpr Nanoseconds kForeignHold{3'000'000'000};
    const auto foreign = view.inputs->foreign_sync();
    if (!view.is_listen_only && foreign && view.now - *foreign < kForeignHold) {
        problems.push_back(
            {"another host",
             "another host sends SYNC on this bus: only one may (start this one with --listen-only)"});
    }
    constexpr Nanoseconds kLeapTold{60'000'000'000};
    if (view.used.time_back && view.now - *view.used.time_back < kLeapTold) {
        problems.push_back(
            {"time back",
             fmt::format(
                 "the bus's time went back (times_back, {}) within the last minute: the host that sends "
                 "SYNC began anew, or there are two; joint states and readings go on from there",
                 view.pipeline->times_back())});
    }
    if (view.used.time_ahead && view.now - *view.used.time_ahead < kLeapTold) {
        problems.push_back(
            {"time ahead",
             fmt::format("the bus's time leapt ahead (times_ahead, {}) within the last minute: another host "
                         "sends SYNC, or its clock was set; the map stays as old as it was",
                         view.pipeline->times_ahead())});
    }
}

std::string why_no_exchange(const DaemonView& view) {
    if (view.is_listen_only)
        return "the time is not known: nobody on the bus sends SYNC and FOLLOW_UP (--listen-only sends none)";
    return fmt::format(
        "the time is not known yet: nodes are heard, but no SYNC of ours came onto the bus (can.not_sent, "
        "{})",
        view.inputs->can().counts().not_sent);
}

void add_clock(const DaemonView& view, Problems& problems) {
    const auto fault = view.pipeline->intake().host_clock().fault();
    if (!is_time_shared(view)) {
        problems.push_back({"no time",
                            fault == HostClockFault::no_exchange
                                ? "the time is not known yet: no SYNC of ours came onto the bus, and no node "
                                  "is heard"
                                : "the time is not known: no node is heard that would share it",
                            "time"});
    } else if (fault == HostClockFault::no_exchange) {
        problems.push_back({"no time", why_no_exchange(view), "time"});
    } else if (fault == HostClockFault::stamps_jumped) {
        problems.push_back({"time jumped",
                            "the time is in doubt: the stamps of what was received went back, or ahead by "
                            "over 0.14 s: the bus was silent, or this machine's clock was set. The next "
                            "SYNC with its FOLLOW_UP settles it",
                            "time"});
    } else if (fault == HostClockFault::exchanges_disagree) {
        problems.push_back({"time disagrees",
                            "the time is in doubt: the newest SYNC with its FOLLOW_UP tells another than "
                            "those before, by over 20 ms: a clock was set, or a frame was stamped late. Two "
                            "in a row that agree settle it",
                            "time"});
    }
}

std::string node_subject(wire::NodeId node) {
    return "node " + std::to_string(node);
}

/// Two senders under one sensor's name: what was counted of them, and what becomes of its readings.
void add_senders(const DaemonView& view, const HostNode& node, std::size_t index, Problems& problems) {
    const SenderWatch& senders =
        view.pipeline->intake().ranges().senders(node.node_id, static_cast<std::uint8_t>(index));
    if (!view.bus_now || !senders.is_named(*view.bus_now)) return;
    const std::string who = sensor_text(node, index);
    const bool is_disputed = senders.is_disputed(*view.bus_now);
    problems.push_back(
        {who + " senders",
         fmt::format("{}: another sender's readings come under its name (contradictions {}, strays {}): {}. "
                     "Which board has the node id twice, or who forges it?",
                     who, senders.contradictions(), senders.strays(),
                     is_disputed ? "its readings stay out of the map until a second after the last of them"
                                 : "they are told from its own and refused"),
         {},
         node_subject(node.node_id)});
}

/// What it loses is not its sensors' fault.
void add_losses(const DaemonView& view, const HostNode& node, Problems& problems) {
    if (!view.bus_now) return;
    const auto loss = view.pipeline->intake().losses(node.node_id, *view.bus_now);
    if (!loss) return;
    const std::string on = node_subject(node.node_id);
    problems.push_back(
        {on + " loses",
         fmt::format("{} '{}': {:.0f} % of its readings within the last second were refused, most as {}", on,
                     node.name, 100.0 * loss->share,
                     names_of(ReadingReason{})[static_cast<std::size_t>(loss->most)]),
         {},
         on});
}

/// Which register the sensor is withheld for, and how to have it left out; empty if its node named none.
std::string register_text(const DaemonView& view, const HostNode& node, std::size_t index) {
    const auto sensor = static_cast<std::uint8_t>(index);
    const auto& health = view.pipeline->intake().ranges().record(node.node_id, sensor).health;
    const NodeRecord& record = view.pipeline->intake().nodes().records().at(node.node_id);
    const auto& report = record.registers.of_sensor(sensor);
    if (!report || health->fault != wire::SensorFault::config_mismatch) return {};
    return ": " + text_of(*report) + "; if that is how this part is, " + leave_out_text(*report, node.name);
}

void add_sensor(const DaemonView& view, const HostNode& node, std::size_t index, Problems& problems) {
    const SensorRecord& sensor =
        view.pipeline->intake().ranges().record(node.node_id, static_cast<std::uint8_t>(index));
    const std::string who = sensor_text(node, index);
    const std::string on = node_subject(node.node_id);
    const bool is_ranging = sensor.health && sensor.health->state == wire::SensorState::ranging;
    if (sensor.health && !is_ranging && sensor.health->state != wire::SensorState::starting) {
        const std::string text = fmt::format("{}: {}, {}", who, wire::name(sensor.health->state),
                                             wire::name(sensor.health->fault));
        problems.push_back({text, text + register_text(view, node, index), who, on});
    } else if (const auto streak = sensor.fates.streak()) {
        problems.push_back(
            {who + " streak",
             fmt::format("{}: (nearly) all of its last {} readings were rejected, most as {}", who,
                         FateHistory::kKept, names_of(ReadingReason{})[static_cast<std::size_t>(*streak)]),
             {},
             on});
    }
    const SensorWitness* const witness = view.pipeline->builder().witness();
    if (witness == nullptr) return;
    const SensorEvidence& evidence = witness->evidence(node.node_id, static_cast<std::uint8_t>(index));
    if (evidence.contradicts())
        problems.push_back({who + " camera", fmt::format("{}: {}", who, describe(evidence)), {}, on});
}

void add_nodes(const DaemonView& view, Problems& problems) {
    const NodeRegistry& nodes = view.pipeline->intake().nodes();
    for (const HostNode& node : view.rig->nodes) {
        const NodeVerdict verdict = nodes.verdict(node.node_id, view.bus_now);
        if (verdict != NodeVerdict::usable) {
            const std::string text = nodes.describe(node.node_id, view.bus_now);
            problems.push_back({text, text, node_subject(node.node_id)});
            continue;
        }
        add_losses(view, node, problems);
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            add_senders(view, node, i, problems);
            add_sensor(view, node, i, problems);
        }
    }
}

/// Why the joint states of the bus are refused, where their node is none of those that have sensors.
void add_joint_node(const DaemonView& view, Problems& problems) {
    const wire::NodeId source = view.rig->joints.node_id;
    const NodeRegistry& nodes = view.pipeline->intake().nodes();
    if (!nodes.knows(source) || nodes.records().at(source).has_block) return;
    if (!is_refused_for_joints(nodes.verdict(source, view.bus_now))) return;
    const std::string text = nodes.describe(source, view.bus_now);
    problems.push_back({text, text, node_subject(source)});
}

bool has_stopped(const std::optional<HostTime>& last, HostTime now) {
    constexpr Nanoseconds kPatience{800'000'000};
    return last && now - *last > kPatience;
}

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
        return fmt::format("no joint states: what comes through the socket is refused ({}); wanted: {}",
                           refused, kJointTextWanted);
    if (view.inputs->joints_of_several() > 0) {
        return fmt::format(
            "no joint states: those that come through the socket are of more than one program "
            "(second_sender, {})",
            view.inputs->joints_of_several());
    }
    if (view.pipeline->accounts().frames.rejected(FrameReason::joint_no_host_time) > 0) {
        return "no joint states: those that come through the socket have no time on the bus's clock "
               "(joint_no_host_time): nobody sends SYNC and FOLLOW_UP on it";
    }
    return "no joint states: none comes through the socket (`octoskin joints`)";
}

/// Where to look, and the most frequent reason, which is why as often as not.
template <class Reject>
std::string see_counters(const char* unit, const Account<Reject>& account) {
    constexpr auto kNames = names_of(Reject{});
    std::size_t most = 0;
    for (std::size_t i = 1; i < kNames.size(); ++i) {
        if (account.rejected(static_cast<Reject>(i)) > account.rejected(static_cast<Reject>(most))) most = i;
    }
    const std::uint64_t count = account.rejected(static_cast<Reject>(most));
    const std::string where = fmt::format("see the counters of {}", unit);
    return count == 0 ? where
                      : fmt::format("{} (most often {}, {} of {})", where, kNames[most], count, account.in());
}

/// "process 4711 (python3, user 1000) and process 4712 (octoskin, user 1000)".
std::string names_of_senders(const std::vector<JointSenders::Heard>& senders) {
    std::string text;
    for (const JointSenders::Heard& heard : senders)
        text += (text.empty() ? "" : " and ") + describe(heard.sender, heard.program);
    return text;
}

bool is_recent(const std::optional<HostTime>& at, HostTime now) {
    constexpr Nanoseconds kTold{3'000'000'000};  // longer than a person's look, or a script's, takes
    return at && now - *at < kTold;
}

void add_joint_jump(const DaemonView& view, Problems& problems) {
    const auto& jumped = view.pipeline->joint_jump().newest();
    if (!jumped || !is_recent(view.used.joint_jump, view.now)) return;
    problems.push_back(
        {"joint jump",
         fmt::format("joint states jump: {} went from {:.3f} to {:.3f} in {:.0f} ms, where the robot "
                     "description lets it move by {:.3f} at most (joint_jump, {}): another program tells "
                     "joint states too, or the velocity of its <limit> is too low",
                     view.rig->joints.joints.at(jumped->joint), jumped->from, jumped->to,
                     1e3 * seconds_of(jumped->passed), jumped->step_max,
                     view.pipeline->accounts().joint_samples.rejected(JointReason::joint_jump))});
}

/// Whose word does not count while another's is heard, by what tells the two apart.
void add_joint_senders(const DaemonView& view, Problems& problems) {
    add_joint_jump(view, problems);
    const JointSocket* const socket = view.inputs->joints();
    if (socket != nullptr && is_recent(socket->senders().several_at(), view.now)) {
        problems.push_back(
            {"joint senders",
             fmt::format("joint states come through the socket from more than one program, and none is used "
                         "until all but one were silent for a second (second_sender, {}): {}",
                         view.inputs->joints_of_several(),
                         names_of_senders(socket->senders().newest_several()))});
        return;
    }
    if (!is_recent(view.used.joint_senders, view.now)) return;
    const std::uint64_t withheld =
        view.pipeline->accounts().joint_samples.rejected(JointReason::second_sender);
    problems.push_back(
        {"joint senders",
         socket != nullptr
             ? fmt::format("joint states of two arms come through the socket by turns, and neither is used "
                           "until that was over for a second (second_sender, {})",
                           withheld)
             : fmt::format("two senders tell joint states under node {}, and neither is used until they have "
                           "not contradicted each other for a second (second_sender, {}): the joint node and "
                           "another board of that id, or `octoskin joints --can` beside it",
                           view.rig->joints.node_id, withheld)});
}

void add_joints(const DaemonView& view, Problems& problems) {
    constexpr std::uint64_t kFirstSamples = 5;  // of a source: nothing is known of it yet
    const auto& joints = view.pipeline->accounts().joint_samples;
    add_joint_senders(view, problems);
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
                 "joint states come, or came, through the socket quicker than they can be taken: {} gave "
                 "way to newer ones (displaced), {} were more than one program may send (surplus); the rig "
                 "has "
                 "{} Hz, more is of no use",
                 view.inputs->joints_displaced(), view.inputs->joints()->surplus(),
                 view.rig->joints.rate_hz)});
    }
    if (joints.rejected(JointReason::too_frequent) > kFirstSamples) {
        problems.push_back(
            {"joints too frequent",
             fmt::format("joint states come, or came, quicker than the {} Hz of the rig, and were refused "
                         "(too_frequent, {}): put the true rate into joints.rate_hz",
                         view.rig->joints.rate_hz, joints.rejected(JointReason::too_frequent))});
    }
}

void add_readings(const DaemonView& view, Problems& problems) {
    const auto& readings = view.pipeline->accounts().readings;
    if (readings.in() > 0 && !view.used.reading) {
        problems.push_back({"readings unused",
                            "no reading could be used yet: " + see_counters("readings", readings),
                            "readings"});
    } else if (has_stopped(view.used.reading, view.now)) {
        problems.push_back({"readings stopped",
                            "readings come onto the map no more: " + see_counters("readings", readings),
                            "readings"});
    }
}

/// For two seconds and still: a machine that is busy for a moment is not worth a word.
bool is_left_behind(const DaemonView& view) {
    constexpr Nanoseconds kLong{2'000'000'000};
    constexpr Nanoseconds kStill{1'000'000'000};
    const auto& last = view.used.depth_left_out;
    if (!last) return false;
    const Nanoseconds ago = view.now - *last;
    const Nanoseconds lasted = *last - *view.used.depth_left_out_since;
    return ago < kStill && lasted > kLong;
}

void add_camera(const DaemonView& view, Problems& problems) {
    if (!view.camera || !view.rig->camera) return;
    const double rate_hz = view.rig->camera->rate_hz;
    const auto& frames = view.pipeline->accounts().depth_frames;
    const bool is_used = view.used.depth_frame && !has_stopped(view.used.depth_frame, view.now);
    const std::size_t others = problems.size();
    if (auto problem = camera_problem(*view.camera, rate_hz, view.now)) {
        problems.push_back(std::move(*problem));
    } else if (frames.in() > 0 && !is_used && view.inputs->has_bus_fallen_silent(view.now)) {
        problems.push_back({"depth beside silent bus",
                            "camera: its frames are not used, because the bus is silent: no node tells "
                            "where the robot is (joints_missing)"});
    } else if (view.is_listen_only && !view.inputs->foreign_clock().ahead(view.now)) {
        problems.push_back({"camera untimed",
                            "camera: its frames have no time: the clock of the host that sends SYNC is not "
                            "known, or in doubt "
                            "(three FOLLOW_UPs must agree)"});
    } else if (frames.in() > 0 && frames.rejected(DepthReason::wrong_size) == frames.in()) {
        const CameraIntrinsics& wanted = view.rig->camera->intrinsics;
        problems.push_back(
            {"depth of another size",
             fmt::format("camera: none of its images is {} x {}, as the rig has them (wrong_size): "
                         "`octoskin cameras` lists its modes, camera.width_px and camera.height_px of "
                         "the rig must be one's",
                         wanted.width, wanted.height)});
    } else if (frames.in() > 0 && !view.used.depth_frame) {
        problems.push_back(
            {"depth unused", "no depth frame could be used yet: " + see_counters("depth frames", frames)});
    } else if (has_stopped(view.used.depth_frame, view.now)) {
        problems.push_back({"depth stopped", "depth frames come onto the map no more: " +
                                                 see_counters("depth frames", frames)});
    }
    if (problems.size() > others) problems.back().subject = "camera";
    if (is_left_behind(view)) {
        problems.push_back(
            {"depth left out",
             "camera: its images come quicker than this machine can work on them, and some are left out "
             "(queue_overflow): a coarser resolution_m, or a mode with a lower rate or fewer pixels",
             "camera"});
    }
    if (auto problem = camera_rate_problem(*view.camera, rate_hz)) problems.push_back(std::move(*problem));
}

void add_map(const DaemonView& view, Problems& problems) {
    const FusedMap& map = *view.pipeline->maps().fused();
    if (map.counters().no_room > 0) {
        problems.push_back(
            {"map full",
             fmt::format("the map is full ({} MiB): it takes no new space, {} updates found no room "
                         "(no_room); raise map.memory_max_mib in the mapping file",
                         map.config().memory_max_mib, map.counters().no_room)});
    }
    if (map.counters().no_memory > 0) {
        problems.push_back({"map without memory",
                            fmt::format("the system had no memory for new space of the map: {} updates were "
                                        "refused (no_memory); lower map.memory_max_mib in the mapping file, "
                                        "or give the service more",
                                        map.counters().no_memory)});
    }
    if (!view.maps_problem.empty()) problems.push_back({"maps folder", view.maps_problem, "maps"});
    if (!view.saves.error.empty())
        problems.push_back({"map not saved", "the map is not saved: " + view.saves.error});
    if (view.recorder != nullptr && !view.recorder->error().empty()) {
        problems.push_back({"recording failed", "the recording has failed: " + view.recorder->error()});
    } else if (view.recorder != nullptr && !view.recorder->is_complete()) {
        problems.push_back({"recording incomplete",
                            "the recording lacks something, and its replay gives another map: "
                            "recording.lost_commits and lost_depth (the disk was too slow, there was no "
                            "memory, or depth lay beyond 32.767 m)"});
    }
    if (!view.recording_refusal.empty())
        problems.push_back(
            {"recording refused", "the newest recording did not begin: " + view.recording_refusal});
    if (!view.reload_error.empty())
        problems.push_back({"reload " + view.reload_error,
                            "the newest reload was refused, and the old settings hold: " + view.reload_error,
                            "reload"});
}

}  // namespace

std::optional<Problem> camera_problem(const CameraRecord& camera, double rate_hz, HostTime now) {
    constexpr Nanoseconds kFirstFrame{5'000'000'000};
    // Before "not open": one that is opened again and again for nothing is both, by turns.
    if (!camera.newest && now - camera.begun > kFirstFrame) {
        const std::string since =
            camera.frames > 0
                ? fmt::format("{} frames came, none with a time that could be told", camera.frames)
                : "no frame has ever come";
        return Problem{"camera never",
                       "camera: " + since + (camera.is_open ? ", and it is open" : ": " + camera.why)};
    }
    if (!camera.is_open) return Problem{"camera: " + camera.why, "camera: " + camera.why};
    const double true_rate_hz = camera.rate_hz > 0.0 ? camera.rate_hz : rate_hz;
    const Nanoseconds period{static_cast<std::int64_t>(1e9 / true_rate_hz)};
    if (camera.newest && now - *camera.newest > 3 * period) {
        if (camera.newest_untimed && now - *camera.newest_untimed <= 3 * period) {
            return Problem{
                "camera untimed",
                "camera: frames come, none for three periods with a time that could be told: they come "
                "late; is this machine too busy?"};
        }
        return Problem{"camera silent", "camera: no frame for three periods"};
    }
    return std::nullopt;
}

std::optional<Problem> camera_rate_problem(const CameraRecord& camera, double rate_hz) {
    constexpr double kAbout = 1.5;  // 30 Hz where 25 are wanted is nothing to write of
    const bool is_other = camera.rate_hz > kAbout * rate_hz || camera.rate_hz * kAbout < rate_hz;
    if (camera.rate_hz <= 0.0 || !is_other) return std::nullopt;
    return Problem{"camera rate",
                   fmt::format("camera: its mode of the rig's size has {} frames a second, the rig {}: "
                               "`octoskin cameras` lists its modes, camera.rate_hz of the rig is to be one's",
                               camera.rate_hz, rate_hz)};
}

std::vector<Problem> problems(const DaemonView& view) {
    Problems problems;
    add_wall_clock(view, problems);
    add_link(view, problems);
    add_other_hosts(view, problems);
    add_links_without_body(view, problems);
    if (!view.is_settling()) {
        add_clock(view, problems);
        add_nodes(view, problems);
        add_joint_node(view, problems);
        add_joints(view, problems);
        add_readings(view, problems);
        add_camera(view, problems);
    }
    add_map(view, problems);
    return problems;
}

}  // namespace octoskin
