#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "common/wire/names.hpp"
#include "host/apps/daemon/problems/unused_input.hpp"
#include "host/core/ingest/node_silence.hpp"
#include "host/core/rig/sensor_text.hpp"

namespace octoskin {
namespace {

/// Two senders under one sensor's name: their counters, and what happens to the readings.
void add_senders(const DaemonView& view, const HostNode& node, std::size_t index, Problems& problems) {
    const SenderWatch& senders =
        view.pipeline->intake().ranges().senders(node.node_id, static_cast<std::uint8_t>(index));
    if (!view.bus_now || !senders.is_named(*view.bus_now)) return;
    const std::string who = sensor_text(node, index);
    const bool is_disputed = senders.is_disputed(*view.bus_now);
    problems.push_back(
        {who + " senders",
         fmt::format("{}: readings of another sender arrive under its name (contradictions {}, strays {}): "
                     "{}. Look for a second board with its node id, or a program that forges it",
                     who, senders.contradictions(), senders.strays(),
                     is_disputed ? "its readings stay out of the map until a second after the last of them"
                                 : "they are distinguished from its own and refused"),
         {},
         node_subject(node.node_id)});
}

/// "joints_missing. Send joint states ...": the counter's name and its remedy.
std::string with_remedy(ReadingReason reason) {
    const char* const name = names_of(ReadingReason{})[static_cast<std::size_t>(reason)];
    return fmt::format("{}.{}", name, remedy_sentence("readings", name));
}

/// Answers to SYNC under the node's id define its clock.
void add_answers(const DaemonView& view, const HostNode& node, Problems& problems) {
    const AnswerCheck& answers = view.pipeline->intake().answers(node.node_id);
    if (!view.bus_now || !answers.hears_two(*view.bus_now)) return;
    const std::string on = node_subject(node.node_id);
    problems.push_back(
        {on + " answers",
         fmt::format("{} '{}': two answers to one SYNC arrive under its id (sync_contradicted, {}), and only "
                     "the one that continues its clock is used. Look for a second board with the node id, or "
                     "a program that forges it",
                     on, node.name, answers.contradictions()),
         {},
         on});
}

/// The reports that decide whether its readings are used.
void add_self_reports(const DaemonView& view, const HostNode& node, Problems& problems) {
    const SelfReportCheck& check = view.pipeline->intake().self_reports(node.node_id);
    if (!view.bus_now || !check.hears_two(*view.bus_now)) return;
    const std::string on = node_subject(node.node_id);
    problems.push_back({on + " reports",
                        fmt::format("{} '{}' alternates between contrary reports within a second ({}): of "
                                    "its clock, its node_hash, its build or a sensor's capture_bound. Look "
                                    "for a second board with the node id, or a program that forges it",
                                    on, node.name, check.contradictions()),
                        {},
                        on});
}

/// After a restart nothing of the node is used until its clock is known again: if it restarts all the time,
/// never.
void add_restarts(const DaemonView& view, const HostNode& node, Problems& problems) {
    constexpr Nanoseconds kTold{3'000'000'000};
    const NodeRecord& record = view.pipeline->intake().nodes().records().at(node.node_id);
    const bool is_new =
        view.bus_now && record.restarted && std::chrono::abs(*view.bus_now - *record.restarted) < kTold;
    if (!is_new) return;
    const std::string on = node_subject(node.node_id);
    problems.push_back({on + " restarts",
                        fmt::format("{} '{}' restarted (restarts, {}): nothing of it is used until its clock "
                                    "is known. If it restarts again and again, check its supply and the "
                                    "cause of its resets, and look for another sender under its id",
                                    on, node.name, record.restarts),
                        {},
                        on});
}

/// Losses of the node, which are no fault of its sensors.
void add_losses(const DaemonView& view, const HostNode& node, Problems& problems) {
    if (!view.bus_now) return;
    const auto loss = view.pipeline->intake().losses(node.node_id, *view.bus_now);
    if (!loss) return;
    const std::string on = node_subject(node.node_id);
    problems.push_back(
        {on + " loses",
         fmt::format("{} '{}': {:.0f} % of its readings within the last second were refused, most as {}", on,
                     node.name, 100.0 * loss->share, with_remedy(loss->most)),
         {},
         on});
}

/// The register for which the sensor is withheld, and how to leave it out; empty if its node reported none.
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
    const bool is_known = sensor.health && !is_unheard(sensor, view.bus_now);
    const bool is_ranging = sensor.health && sensor.health->state == wire::SensorState::ranging;
    if (is_known && !is_ranging && sensor.health->state != wire::SensorState::starting) {
        const std::string text = fmt::format("{}: {}, {}", who, wire::name(sensor.health->state),
                                             wire::name(sensor.health->fault));
        problems.push_back({text, text + register_text(view, node, index), who, on});
    } else if (const auto streak = sensor.fates.streak()) {
        problems.push_back({who + " streak",
                            fmt::format("{}: (nearly) all of its last {} readings were rejected, most as {}",
                                        who, FateHistory::kKept, with_remedy(*streak)),
                            {},
                            on});
    }
    const CrossCheck* const cross_check = view.pipeline->builder().cross_check();
    if (cross_check == nullptr) return;
    const SensorEvidence& evidence = cross_check->evidence(node.node_id, static_cast<std::uint8_t>(index));
    if (evidence.contradicts())
        problems.push_back({who + " camera", fmt::format("{}: {}", who, describe(evidence)), {}, on});
}

}  // namespace

void add_nodes(const DaemonView& view, Problems& problems) {
    const NodeRegistry& nodes = view.pipeline->intake().nodes();
    for (const HostNode& node : view.rig->nodes) {
        const NodeCondition verdict = nodes.verdict(node.node_id, view.bus_now);
        add_restarts(view, node, problems);
        add_answers(view, node, problems);
        add_self_reports(view, node, problems);
        if (verdict != NodeCondition::usable) {
            const std::string text = nodes.describe(node.node_id, view.bus_now);
            problems.push_back({text, text, node_subject(node.node_id)});
            continue;
        }
        add_losses(view, node, problems);
        add_silence(view, node, problems);
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            add_senders(view, node, i, problems);
            add_sensor(view, node, i, problems);
        }
    }
}

/// Problems of the node that sends the joint states of the bus, if it is not one of those with sensors.
void add_joint_node(const DaemonView& view, Problems& problems) {
    const wire::NodeId source = view.rig->joints.node_id;
    const NodeRegistry& nodes = view.pipeline->intake().nodes();
    if (!nodes.knows(source) || nodes.records().at(source).has_block) return;
    add_restarts(view, nodes.records().at(source).expected, problems);
    add_answers(view, nodes.records().at(source).expected, problems);
    add_self_reports(view, nodes.records().at(source).expected, problems);
    if (!is_refused_for_joints(nodes.verdict(source, view.bus_now))) return;
    const std::string text = nodes.describe(source, view.bus_now);
    problems.push_back({text, text, node_subject(source)});
}

void add_readings(const DaemonView& view, Problems& problems) {
    const auto& readings = view.pipeline->inputs().readings;
    if (readings.in() > 0 && !view.used.reading) {
        problems.push_back({"readings unused",
                            "no reading could be used yet: " + see_counters("readings", readings),
                            "readings"});
    } else if (has_stopped(view.used.reading, view.now)) {
        problems.push_back({"readings stopped",
                            "readings no longer reach the map: " + see_counters("readings", readings),
                            "readings"});
    }
}

}  // namespace octoskin
