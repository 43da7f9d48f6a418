#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "common/wire/names.hpp"
#include "host/apps/daemon/problems/unused_input.hpp"
#include "host/core/ingest/node_silence.hpp"
#include "host/core/rig/sensor_text.hpp"

namespace octoskin {
namespace {

constexpr const char* kSecondBoard = "look for a second board with the node id, or a program that forges it";

/// Two senders under one sensor's name: their counters, and what happens to the readings.
void add_senders(const DaemonView& view, const HostNode& node, std::size_t index, Problems& problems) {
    const SenderWatch& senders =
        view.pipeline->intake().ranges().senders(node.node_id, static_cast<std::uint8_t>(index));
    if (!view.bus_now || !senders.is_named(*view.bus_now)) return;
    const std::string who = sensor_text(node, index);
    const bool is_disputed = senders.is_disputed(*view.bus_now);
    problems.push_back(
        {.code = ProblemCode::sensor_two_senders,
         .on = who,
         .what = fmt::format(
             "readings of another sender arrive under its name (contradictions {}, strays {}), and {}",
             senders.contradictions(), senders.strays(),
             is_disputed ? "its readings stay out of the map until a second after the last such reading"
                         : "they are distinguished from its own and refused"),
         .remedy = kSecondBoard,
         .key = "contradictions",
         .hidden_by = node_subject(node.node_id)});
}

const char* counter_of(ReadingReason reason) {
    return names_of(ReadingReason{})[static_cast<std::size_t>(reason)];
}

/// "joints_missing. Send joint states ...": the counter's name and its remedy.
std::string with_remedy(ReadingReason reason) {
    return fmt::format("{}.{}", counter_of(reason), remedy_sentence("readings", counter_of(reason)));
}

/// "node 9 'board'".
std::string node_text(const HostNode& node) {
    return fmt::format("{} '{}'", node_subject(node.node_id), node.name);
}

/// `why`: the registry's sentence, which begins with the node's text.
Problem unusable_node(const HostNode& node, const std::string& why) {
    std::string on = node_text(node);
    std::string condition = why.substr(std::min(why.size(), on.size() + 2));
    return {.code = ProblemCode::node_unusable,
            .on = std::move(on),
            .what = condition,
            .detail = condition,
            .subject = node_subject(node.node_id)};
}

/// Answers to SYNC under the node's id define its clock.
void add_answers(const DaemonView& view, const HostNode& node, Problems& problems) {
    const AnswerCheck& answers = view.pipeline->intake().answers(node.node_id);
    if (!view.bus_now || !answers.hears_two(*view.bus_now)) return;
    problems.push_back({.code = ProblemCode::node_two_answers,
                        .on = node_text(node),
                        .what = fmt::format("two answers to one SYNC arrive under its id (sync_contradicted, "
                                            "{}), and only the one that continues its clock is used",
                                            answers.contradictions()),
                        .remedy = kSecondBoard,
                        .key = "sync_contradicted",
                        .hidden_by = node_subject(node.node_id)});
}

/// Contrary reports under the node's id. Such reports decide whether its readings are used.
void add_self_reports(const DaemonView& view, const HostNode& node, Problems& problems) {
    const SelfReportCheck& check = view.pipeline->intake().self_reports(node.node_id);
    if (!view.bus_now || !check.hears_two(*view.bus_now)) return;
    problems.push_back(
        {.code = ProblemCode::node_two_reports,
         .on = node_text(node),
         .what = fmt::format("within a second it alternates between contrary reports of its clock, its "
                             "node_hash, its build or a sensor's capture_bound ({} times)",
                             check.contradictions()),
         .remedy = kSecondBoard,
         .hidden_by = node_subject(node.node_id)});
}

/// After a restart nothing of the node is used until its clock is known again.
void add_restarts(const DaemonView& view, const HostNode& node, Problems& problems) {
    constexpr Nanoseconds kTold{3'000'000'000};
    const NodeRecord& record = view.pipeline->intake().nodes().records().at(node.node_id);
    const bool is_new =
        view.bus_now && record.restarted && std::chrono::abs(*view.bus_now - *record.restarted) < kTold;
    if (!is_new) return;
    problems.push_back(
        {.code = ProblemCode::node_restarts,
         .on = node_text(node),
         .what =
             fmt::format("it restarted (restarts, {}), and nothing of it is used until its clock is known",
                         record.restarts),
         .remedy =
             "if it restarts again and again, check its supply and the cause of its resets, and look for "
             "another sender under its id",
         .key = "restarts",
         .hidden_by = node_subject(node.node_id)});
}

/// Losses of the node, which are no fault of its sensors.
void add_losses(const DaemonView& view, const HostNode& node, Problems& problems) {
    if (!view.bus_now) return;
    const auto loss = view.pipeline->intake().losses(node.node_id, *view.bus_now);
    if (!loss) return;
    problems.push_back(
        {.code = ProblemCode::node_loses_readings,
         .on = node_text(node),
         .what = fmt::format("{:.0f} % of its readings within the last second were refused, most as {}",
                             100.0 * loss->share, with_remedy(loss->most)),
         .key = counter_of(loss->most),
         .hidden_by = node_subject(node.node_id)});
}

/// The register because of which the sensor's readings are withheld, and how to leave that register out of
/// the verification; empty if the node reported none.
std::string register_text(const DaemonView& view, const HostNode& node, std::size_t index) {
    const auto sensor = static_cast<std::uint8_t>(index);
    const auto& health = view.pipeline->intake().ranges().record(node.node_id, sensor).health;
    const NodeRecord& record = view.pipeline->intake().nodes().records().at(node.node_id);
    const auto& report = record.registers.of_sensor(sensor);
    if (!report || health->fault != wire::SensorFault::config_mismatch) return {};
    return ": " + text_of(*report) + "; if that is normal for this part, " +
           leave_out_text(*report, node.name);
}

void add_sensor(const DaemonView& view, const HostNode& node, std::size_t index, Problems& problems) {
    const SensorRecord& sensor =
        view.pipeline->intake().ranges().record(node.node_id, static_cast<std::uint8_t>(index));
    const std::string who = sensor_text(node, index);
    const std::string on = node_subject(node.node_id);
    const bool is_known = sensor.health && !is_unheard(sensor, view.bus_now);
    const bool is_ranging = sensor.health && sensor.health->state == wire::SensorState::ranging;
    if (is_known && !is_ranging && sensor.health->state != wire::SensorState::starting) {
        std::string state =
            fmt::format("{}, {}", wire::name(sensor.health->state), wire::name(sensor.health->fault));
        problems.push_back({.code = ProblemCode::sensor_not_ranging,
                            .on = who,
                            .what = state + register_text(view, node, index),
                            .detail = std::move(state),
                            .subject = who,
                            .hidden_by = on});
    } else if (const auto streak = sensor.fates.streak()) {
        problems.push_back(
            {.code = ProblemCode::sensor_rejected,
             .on = who,
             .what = fmt::format("(nearly) all of its last {} readings were rejected, most as {}",
                                 FateHistory::kKept, with_remedy(*streak)),
             .key = counter_of(*streak),
             .hidden_by = on});
    }
    const CrossChecks* const checks = view.pipeline->builder().cross_checks();
    if (checks == nullptr) return;
    const auto [evidence, camera] = checks->finding(node.node_id, static_cast<std::uint8_t>(index));
    if (!evidence.contradicts()) return;
    problems.push_back({.code = ProblemCode::sensor_contradicts_camera,
                        .on = who,
                        .what = describe(evidence, view.rig->cameras.at(camera).name),
                        .hidden_by = on});
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
            problems.push_back(unusable_node(node, nodes.describe(node.node_id, view.bus_now)));
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

/// Problems of the nodes that send the joint states of the bus, if they are not among those with sensors.
void add_joint_nodes(const DaemonView& view, Problems& problems) {
    const NodeRegistry& nodes = view.pipeline->intake().nodes();
    for (const HostJointSource& joints : view.rig->joint_sources) {
        const wire::NodeId source = joints.node_id;
        if (!nodes.knows(source) || nodes.records().at(source).has_block) continue;
        add_restarts(view, nodes.records().at(source).expected, problems);
        add_answers(view, nodes.records().at(source).expected, problems);
        add_self_reports(view, nodes.records().at(source).expected, problems);
        if (is_refused_for_joints(nodes.verdict(source, view.bus_now)))
            problems.push_back(
                unusable_node(nodes.records().at(source).expected, nodes.describe(source, view.bus_now)));
    }
}

void add_readings(const DaemonView& view, Problems& problems) {
    const auto& readings = view.pipeline->inputs().readings;
    if (readings.in() > 0 && !view.used.reading) {
        problems.push_back({.code = ProblemCode::readings_unused,
                            .what = "no reading could be used yet: " + see_counters("readings", readings),
                            .subject = "readings"});
    } else if (has_stopped(view.used.reading, view.now)) {
        problems.push_back({.code = ProblemCode::readings_stopped,
                            .what = "readings no longer reach the map: " + see_counters("readings", readings),
                            .subject = "readings"});
    }
}

}  // namespace octoskin
