#include "host/core/ingest/node_summary.hpp"

#include <iomanip>
#include <sstream>

namespace octoskin {
namespace {

std::optional<NodeSummary::Readings> readings_of(const RangeGate& ranges, const HostNode& node) {
    if (node.sensors.empty()) {
        return std::nullopt;
    }
    NodeSummary::Readings sum;
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        const SensorRecord& record = ranges.record(node.node_id, static_cast<std::uint8_t>(i));
        sum.received += record.received;
        sum.lost += record.sent.lost();
        sum.gaps += record.sequence.gaps();
    }
    return sum;
}

std::optional<Loss> mendable(std::optional<Loss> loss) {
    return loss && loss->is_mendable ? loss : std::nullopt;
}

std::string verdict_text(const NodeSummary& node) {
    if (node.verdict == NodeCondition::usable && !node.has_time) return "no SYNC in the log";
    if (node.verdict == NodeCondition::usable && node.loss) {
        return "loses " + std::to_string(node.loss->rejected) + " of " + std::to_string(node.loss->of) + " " +
               node.loss->unit + ", most as " + node.loss->reason;
    }
    return names_of(NodeCondition{})[static_cast<std::size_t>(node.verdict)];
}

std::vector<std::string> registers_of(const NodeRecord& record) {
    std::vector<std::string> texts;
    for (const wire::RegisterReport& report : record.registers.alike()) texts.push_back(alike_text(report));
    for (std::size_t i = 0; i < record.expected.sensors.size(); ++i) {
        const auto& report = record.registers.of_sensor(static_cast<std::uint8_t>(i));
        if (!report) continue;
        texts.push_back("sensor " + std::to_string(i) + " '" + record.expected.sensors[i].name +
                        "': " + text_of(*report));
    }
    return texts;
}

}  // namespace

std::vector<NodeSummary> summarise(const CanIntake& intake) {
    std::vector<NodeSummary> nodes;
    for (const auto& [id, record] : intake.nodes().records()) {
        nodes.push_back({.node_id = id,
                         .name = record.expected.name,
                         .readings = readings_of(intake.ranges(), record.expected),
                         .clock_relocks = intake.clock(id).relocks(),
                         .verdict = intake.nodes().verdict(id, intake.now()),
                         .has_time = intake.now().has_value(),
                         .reason = intake.nodes().reason(id, intake.now()),
                         .loss = mendable(loss_of(intake.reading_table(id))),
                         .registers = registers_of(record)});
    }
    return nodes;
}

std::string to_text(std::span<const NodeSummary> nodes) {
    std::ostringstream text;
    const auto row = [&](const std::string& name, const auto&... cells) {
        text << std::left << std::setw(20) << name << std::right;
        ((text << std::setw(10) << cells), ...);
    };
    row("node", "readings", "lost", "gaps", "re-locks");
    text << "  verdict\n";
    for (const NodeSummary& node : nodes) {
        const std::string id = std::to_string(node.node_id);
        const std::string name = std::string(id.size() < 3 ? 3 - id.size() : 0, ' ') + id + " " + node.name;
        if (node.readings) {
            row(name, node.readings->received, node.readings->lost, node.readings->gaps, node.clock_relocks);
        } else {
            row(name, "-", "-", "-", node.clock_relocks);
        }
        text << "  " << verdict_text(node) << (node.reason ? ": " + node.reason->text() : "") << "\n";
        for (const std::string& about : node.registers) text << "      " << about << "\n";
    }
    return text.str();
}

}  // namespace octoskin
