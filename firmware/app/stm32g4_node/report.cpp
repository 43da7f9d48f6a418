#include "firmware/app/stm32g4_node/report.hpp"

#include <string_view>

#include "common/wire/names.hpp"
#include "firmware/port/stm32g4/text_line.hpp"

namespace octoskin::stm32g4 {

namespace {

constexpr Microseconds kLossesPause{10'000'000};
// Time between two checks of the sensors.
constexpr Microseconds kSensorsPause{50'000};

std::string_view words(ClockSource source) {
    switch (source) {
        case ClockSource::crystal:
            return " MHz from the crystal";
        case ClockSource::internal:
            return " MHz without the crystal: CAN is silent";
        case ClockSource::unlocked:
            return " MHz, without the PLL: CAN is silent";
    }
    return "?";
}

std::string_view words(NodeConfigError error) {
    switch (error) {
        case NodeConfigError::truncated:
            return "truncated";
        case NodeConfigError::wrong_magic:
            return "missing";
        case NodeConfigError::wrong_length:
            return "of impossible length";
        case NodeConfigError::wrong_crc:
            return "damaged";
        case NodeConfigError::wrong_version:
            return "of another version";
        case NodeConfigError::invalid_field:
            return "complete, but a field is impossible";
    }
    return "?";
}

/// "register 47 written 0B, reads 0C"
void add(TextLine& line, const vl53l1x::RegisterDifference& difference) {
    line.text("register ").hex(difference.index, 2).text(" written ").hex(difference.expected, 2);
    line.text(", reads ").hex(difference.found, 2);
}

}  // namespace

void Report::started(std::uint32_t build_id, wire::ResetCause cause, const Clocks& clocks) {
    has_crystal_ = clocks.source == ClockSource::crystal;
    TextLine line;
    line.text("octoskin ").hex(build_id, 8).text(": reset ").text(wire::name(cause));
    line.text(", ").number(clocks.core_hz / 1'000'000);
    serial_.say(line.text(words(clocks.source)).view());
}

void Report::start_up_failing(std::uint32_t seconds) {
    TextLine line;
    line.text("start-up failed too often: nothing for ").number(seconds);
    serial_.say(line.text(" s, then once more").view());
}

void Report::crystal_runs() {
    serial_.say("the crystal runs now: starting anew");
}

void Report::fault(const Fault& fault) {
    TextLine line;
    line.text("fault ").text(wire::name(fault.kind)).text(" at ").hex(fault.where, 8);
    line.text(" from ").hex(fault.called_from, 8).text(", status ").hex(fault.status, 8);
    line.text(", address ").hex(fault.address, 8);
    serial_.say(line.text(", after us ").number(fault.uptime.us).view());
}

void Report::config_accepted(const NodeConfig& config) {
    TextLine line;
    line.text("node ").number(config.node_id).text(": ").number(config.sensor_count).text(" sensors, CAN ");
    line.number(config.nominal_bitrate / 1000);
    if (config.uses_can_fd) line.text("/").number(config.data_bitrate / 1000);
    serial_.say(line.text(" kbit/s, hash ").hex(node_hash(config), 8).view());
}

void Report::config_refused(NodeConfigError error) {
    TextLine line;
    line.text("configuration block at 0807F800 is ").text(words(error));
    serial_.say(line.text(": no ranging; flash one").view());
}

void Report::config_unsuitable(const NodeConfig& config) {
    TextLine line;
    line.text("configuration block of node ").number(config.node_id).text(", board type ");
    serial_.say(line.number(config.board_type).text(", is not for this board: no ranging").view());
}

void Report::can_dead() {
    serial_.say("the CAN controller does not start: CAN is silent, tried again each second");
}

void Report::update(const node::Node& node, const CanController& can, NodeTime now) {
    const wire::NodeState state = node.state();
    if (state_ != state) {
        TextLine line;
        serial_.say(line.text("state ").text(wire::name(state)).view());
    }
    const std::uint32_t bus_off_count = node.bus_off_count();
    if (bus_off_count_ != bus_off_count) {
        TextLine line;
        serial_.say(line.text("CAN bus-off, ").number(bus_off_count).text(" since start").view());
    }
    if (const std::uint32_t failed = can.counts().failed; failed != can_failed_) {
        TextLine line;
        serial_.say(line.text("CAN controller failed, ").number(failed).text(" since start").view());
        can_failed_ = failed;
    }
    const std::uint8_t ignored = node.ignored_data_ready();
    if (ignored_data_ready_ != ignored) {
        TextLine line;
        serial_.say(line.text("noisy data-ready lines, ignored: buses ").hex(ignored, 1).view());
    }
    state_ = state;
    ignored_data_ready_ = ignored;
    bus_off_count_ = bus_off_count;
    report_losses(can.counts(), now);
    report_sensors(node, now);
    show(state, can.is_started());
}

/// Reports at most one changed sensor per check, since the serial port is slow.
void Report::report_sensors(const node::Node& node, NodeTime now) {
    sensors_pause_.update(now);
    if (!sensors_pause_.is_over()) return;
    sensors_pause_.begin(now, kSensorsPause);
    const auto sensors = node.sensors();
    bool has_reported = false;
    has_trouble_ = false;
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        const node::Sensor& sensor = *sensors[i];
        const auto trouble = sensor.trouble();
        has_trouble_ = has_trouble_ || trouble;
        if (has_reported || trouble == troubles_[i]) continue;
        troubles_[i] = trouble;
        has_reported = true;
        TextLine line;
        line.text("sensor ").number(static_cast<std::uint32_t>(i)).text(": ");
        line.text(wire::name(sensor.state()));
        if (trouble) line.text(", ").text(wire::name(trouble->fault));
        if (trouble && trouble->difference) add(line.text(", "), *trouble->difference);
        serial_.say(line.view());
    }
    if (!has_reported) report_common_differences(node);
}

/// At most one per check.
void Report::report_common_differences(const node::Node& node) {
    const auto alike = node.alike();
    if (common_reported_ >= alike.size()) return;
    TextLine line;
    add(line, alike[common_reported_++].difference);
    serial_.say(line.text(", alike on several sensors: their readings are still sent").view());
}

/// Without another node to acknowledge, frames are lost every second: reported at most once per
/// `kLossesPause`.
void Report::report_losses(const CanCounts& counts, NodeTime now) {
    const bool is_news =
        counts.given_up != reported_.given_up || counts.receive_lost != reported_.receive_lost;
    losses_pause_.update(now);
    if (!is_news || !losses_pause_.is_over()) return;
    TextLine line;
    line.text("CAN: ").number(counts.given_up).text(" frames not acknowledged, ");
    serial_.say(line.number(counts.receive_lost).text(" not received, since start").view());
    reported_ = counts;
    losses_pause_.begin(now, kLossesPause);
}

/// Shows one problem at a time: the one to repair first.
void Report::show(wire::NodeState state, bool is_can_started) {
    const bool is_ranging = state == wire::NodeState::ranging || state == wire::NodeState::starting;
    if (!has_crystal_) {
        light_.show(Flashes::no_crystal);
    } else if (state == wire::NodeState::bad_config) {
        light_.show(Flashes::bad_config);
    } else if (state == wire::NodeState::can_fault || !is_can_started) {
        light_.show(Flashes::can_fault);
    } else if (!is_ranging || has_trouble_) {
        light_.show(Flashes::no_ranges);
    } else {
        light_.show(Flashes::all_is_well);
    }
}

}  // namespace octoskin::stm32g4
