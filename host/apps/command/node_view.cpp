#include "host/apps/command/node_view.hpp"

#include <fmt/format.h>

#include <type_traits>
#include <variant>

#include "common/wire/names.hpp"
#include "host/core/ingest/register_reports.hpp"

namespace octoskin::commanding {
namespace {

bool is_of_the_rig(const NodeView& view, const Order& order) {
    return order.known && view.heartbeat &&
           view.heartbeat->node_hash_low == (order.known->node_hash & 0xFFFFU);
}

/// The rig's sensor name, only if index and name are known to belong together; otherwise the index.
std::string sensor_name(const NodeView& view, const Order& order, std::size_t index) {
    const bool has_name = is_of_the_rig(view, order) && index < order.known->sensors.size();
    return has_name ? order.known->sensors[index] : fmt::format("{}", index);
}

/// "2 absent (left: no_answer, back: bus_error)"; empty if none is in that state.
std::string sensors_in(wire::SensorState state, const NodeView& view, const Order& order) {
    std::size_t count = 0;
    std::string names;
    for (std::size_t i = 0; i < view.sensors.size(); ++i) {
        const auto& health = view.sensors.at(i);
        if (!health || health->state != state) continue;
        ++count;
        names += (names.empty() ? "" : ", ") + sensor_name(view, order, i);
        if (health->fault != wire::SensorFault::none) names += std::string(": ") + wire::name(health->fault);
    }
    if (count == 0) return {};
    const bool is_dull = state == wire::SensorState::ranging || state == wire::SensorState::stopped;
    return fmt::format("{} {}{}", count, wire::name(state), is_dull ? "" : " (" + names + ")");
}

std::string hex(const wire::InfoUidLow& low, const wire::InfoUidHigh& high) {
    std::string text;
    for (const std::uint8_t byte : low.uid) text += fmt::format("{:02x}", byte);
    for (const std::uint8_t byte : high.uid) text += fmt::format("{:02x}", byte);
    return text;
}

std::string fault_text(const wire::InfoFault& fault) {
    if (fault.kind == wire::FaultKind::none) return "fault none";
    const auto report = wire::RegisterReport::of(fault.where);
    if (fault.kind == wire::FaultKind::register_fixed)
        return fmt::format("fault register_fixed: sensor {}: {}", report.subject, text_of(report));
    if (fault.kind == wire::FaultKind::register_alike) return "fault register_alike: " + alike_text(report);
    return fmt::format("fault {} (where: 0x{:08x}); resets without a command: {}, the last after {} s",
                       wire::name(fault.kind), fault.where, fault.count, fault.uptime_s);
}

}  // namespace

void InfoPages::take(const wire::NodeInfo& page) {
    std::visit(
        [this](const auto& said) {
            using Page = std::decay_t<decltype(said)>;
            if constexpr (std::is_same_v<Page, wire::InfoUidLow>) uid_low = said;
            if constexpr (std::is_same_v<Page, wire::InfoUidHigh>) uid_high = said;
            if constexpr (std::is_same_v<Page, wire::InfoIdentity>) identity = said;
            if constexpr (std::is_same_v<Page, wire::InfoBuild>) build = said;
            if constexpr (std::is_same_v<Page, wire::InfoCounters>) counters = said;
            if constexpr (std::is_same_v<Page, wire::InfoTraffic>) traffic = said;
            if constexpr (std::is_same_v<Page, wire::InfoFault>) fault = said;
        },
        page);
}

bool InfoPages::is_complete() const noexcept {
    return uid_low && uid_high && identity && build && counters && traffic && fault;
}

std::string state_text(const NodeView& view, const Order& order) {
    std::string groups;
    for (const auto& [state, name] : wire::values_of(wire::SensorState{})) {
        const std::string group = sensors_in(state, view, order);
        if (!group.empty()) groups += (groups.empty() ? ": " : ", ") + group;
    }
    return fmt::format("{}{}; {} sensors{}", wire::name(view.state()),
                       view.heartbeat && view.heartbeat->is_rate_overridden ? " at another rate" : "",
                       view.sensor_count(), groups);
}

std::string info_text(const NodeView& view, const Order& order) {
    const InfoPages& info = view.info;
    const char* const rig = !order.known                                         ? ""
                            : info.identity->node_hash == order.known->node_hash ? ", as in the rig"
                                                                                 : ", not as in the rig";
    return fmt::format(
        "  unique id {}, board type {}, build {:08x}\n  node_hash {:08x}{}; up {} s, reset cause {}\n  since "
        "then: {} I2C errors, {} inconsistent readings, {} sensor restarts;\n    {} frames dropped, {} late, "
        "{} times bus-off, {} frames refused\n  {}\n",
        hex(*info.uid_low, *info.uid_high), info.identity->board_type, info.build->build_id,
        info.identity->node_hash, rig, info.build->uptime_s, wire::name(view.heartbeat->reset_cause),
        info.counters->i2c_errors, info.counters->reads_disagreed, info.counters->sensor_restarts,
        info.traffic->tx_dropped, info.traffic->late_dropped, info.traffic->bus_off_count,
        info.traffic->rx_rejected, fault_text(*info.fault));
}

std::string difference_text(const NodeView& view, const Order& order) {
    if (!order.known || !view.heartbeat || is_of_the_rig(view, order)) return {};
    return fmt::format(
        "its configuration is not that of the rig file (low half of node_hash {:04x}, the rig has {:04x})",
        view.heartbeat->node_hash_low, order.known->node_hash & 0xFFFFU);
}

}  // namespace octoskin::commanding
