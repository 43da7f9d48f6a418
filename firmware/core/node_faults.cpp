// The present faults of the node and its sensors, for NODE_INFO's fault page. The page has room for one, so
// they take turns.
#include <algorithm>
#include <utility>

#include "firmware/core/node.hpp"

namespace octoskin::node {

namespace {

constexpr std::uint8_t saturated8(std::uint32_t value) {
    return static_cast<std::uint8_t>(std::min<std::uint32_t>(value, 255));
}

/// Each register that is read back has an index of one byte.
wire::RegisterReport report_of(std::uint8_t subject, const vl53l1x::RegisterDifference& difference) {
    return {.subject = subject,
            .index = static_cast<std::uint8_t>(difference.index),
            .written = difference.expected,
            .read = difference.found};
}

}  // namespace

template <class Visitor>
void Node::visit_present_faults(Visitor visit) const {
    const auto tell = [&](wire::FaultKind kind, std::uint32_t where) {
        visit(wire::InfoFault{.kind = kind, .count = saturated8(run_.resets), .where = where});
    };
    if (refused_command_) {
        tell(wire::FaultKind::commands_refused, static_cast<std::uint32_t>(refused_command_->command.code));
    }
    for (std::uint8_t i = 0; i < sensor_count_; ++i) {
        const Sensor& sensor = *sensors_[i];
        const bool is_ranging = sensor.state() == wire::SensorState::ranging;
        if (!is_ranging && sensor.fault() == wire::SensorFault::xshut_stuck)
            tell(wire::FaultKind::xshut_stuck, config_.sensors[i].xshut_line);
    }
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        if (buses_[bus] && buses_[bus]->has_parked()) tell(wire::FaultKind::stray_sensor, bus);
    }
    for (std::uint8_t i = 0; i < sensor_count_; ++i) {
        if (const auto difference = sensors_[i]->register_to_report())
            tell(wire::FaultKind::register_fixed, report_of(i, *difference).where());
    }
    for (const AlikeDifferences::CommonDifference& reported : alike_.learnt())
        tell(wire::FaultKind::register_alike, report_of(reported.parts, reported.difference).where());
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        if (buses_[bus] && buses_[bus]->hint().is_ignored()) tell(wire::FaultKind::data_ready_ignored, bus);
    }
    for (std::uint8_t i = 0; i < sensor_count_; ++i) {
        if (sensors_[i]->was_boot_late()) tell(wire::FaultKind::boot_late, i);
    }
}

/// The page has room for one fault. The first is sent at once, the others by `forward_faults`.
void Node::note_fault_change() {
    constexpr std::uint32_t kOffset = 2'166'136'261U;  // FNV-1a
    constexpr std::uint32_t kPrime = 16'777'619U;
    std::uint32_t seen = kOffset;
    std::uint32_t count = 0;
    visit_present_faults([&](const wire::InfoFault& fault) {
        seen = (seen ^ static_cast<std::uint32_t>(fault.kind)) * kPrime;
        seen = (seen ^ fault.where) * kPrime;
        ++count;
    });
    if (seen == faults_seen_) return;
    faults_seen_ = seen;
    faults_unreported_ = count;
    announcer_.request_info(wire::InfoPage::fault);
}

/// After a change each fault is sent once, ten a second: 34 sensors may each have one. A refused command is
/// reported out of turn; the page sent once a second keeps its turns.
void Node::forward_faults() {
    is_refusal_due_ = std::exchange(is_refusal_unreported_, false);
    if (faults_unreported_ > 0 || is_refusal_due_) announcer_.request_info(wire::InfoPage::fault);
}

void Node::note_fault_reported() noexcept {
    if (std::exchange(is_refusal_due_, false)) return;
    ++fault_turn_;
    if (faults_unreported_ > 0) --faults_unreported_;
}

/// One fault in each turn; the recorded one takes part.
wire::InfoFault Node::fault_to_report() const noexcept {
    wire::InfoFault fault{.kind = run_.fault,
                          .count = saturated8(run_.resets),
                          .where = run_.where,
                          .uptime_s = saturated8(run_.fault_uptime_ms / 1'000)};
    const std::uint32_t present = fault_count();
    if (present == 0) return fault;
    const bool is_recorded = run_.fault != wire::FaultKind::none;
    const std::uint32_t turn =
        is_refusal_due_ ? 0 : fault_turn_ % (present + (is_recorded ? 1U : 0U));  // commands_refused is first
    std::uint32_t index = 0;
    visit_present_faults([&](const wire::InfoFault& at_present) {
        if (index++ == turn) fault = at_present;
    });
    return fault;
}

std::uint32_t Node::fault_count() const noexcept {
    std::uint32_t count = 0;
    visit_present_faults([&count](const wire::InfoFault&) { ++count; });
    return count;
}

}  // namespace octoskin::node
