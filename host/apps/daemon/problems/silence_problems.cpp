#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/problems/problem_groups.hpp"
#include "host/core/ingest/node_silence.hpp"
#include "host/core/rig/sensor_text.hpp"

namespace octoskin {
namespace {

const SensorRecord& record_of(const DaemonView& view, const HostNode& node, std::size_t index) {
    return view.pipeline->intake().ranges().record(node.node_id, static_cast<std::uint8_t>(index));
}

/// Which frames are lost, and where to look. All readings of a node come in frames of one type, RANGE or
/// RANGE_FD, and all other data in classical frames.
std::string lost_where(const DaemonView& view, const HostNode& node) {
    bool is_classical = false;
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        const auto& newest = record_of(view, node, i).newest;
        is_classical = is_classical || (newest && newest->capture.span_us == wire::kClassicalTimeSpanUs);
    }
    return is_classical ? "RANGE frames are lost: look for a gateway or a filter in between that drops them"
                        : "RANGE_FD frames are lost where classical ones pass: check the FD setting and the "
                          "data bit rate of the adapter, and look for a gateway, a filter or a part in "
                          "between that passes no FD frames";
}

constexpr const char* kLossRemedy =
    "look for a disturbed line (wrong_crc, can.error_frames), a full bus (can.busy_s), and a gateway or an "
    "adapter in between that drops frames";

constexpr const char* kGatewayRemedy = "look for a gateway or a program in between that drops them";

/// "39 of the 45 readings that its node sent within the last 3 s did not arrive (lost, 120)".
std::string lost_text(const SentCount::Loss& loss, const char* sender, std::uint64_t lost_ever) {
    return fmt::format(
        "{} of the {} readings that {} sent within the last {:.0f} s did not arrive (lost, {})", loss.lost,
        loss.sent, sender, seconds_of(loss.within), lost_ever);
}

/// The losses of all sensors of the node together.
std::string lost_of_node(const DaemonView& view, const HostNode& node) {
    SentCount::Loss all;
    std::uint64_t lost_ever = 0;
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        const SentCount& sent = record_of(view, node, i).sent;
        const auto loss = sent.newest_loss(*view.bus_now).value_or(SentCount::Loss{});
        all.lost += loss.lost;
        all.sent += loss.sent;
        all.within = std::max(all.within, loss.within);
        lost_ever += sent.lost();
    }
    return lost_text(all, "it", lost_ever);
}

/// In state safe a node reports nothing about its sensors.
std::string unheard_remedy(const DaemonView& view, const HostNode& node) {
    const auto& heartbeat = view.pipeline->intake().nodes().records().at(node.node_id).heartbeat;
    if (heartbeat && heartbeat->state == wire::NodeState::safe)
        return "its state is safe, after repeated resets: `octoskin command NODE start`, or a minute's wait, "
               "lets it try again";
    return "look for a gateway, a filter or a program in between that drops them, for a bus so full that "
           "only frames of higher priority pass (can.busy_s), and check the node itself";
}

void add_of_node(const DaemonView& view, const HostNode& node, SensorSilence what, Problems& problems) {
    const std::string subject = node_subject(node.node_id);
    const std::string on = fmt::format("{} '{}'", subject, node.name);
    if (what == SensorSilence::unheard) {
        problems.push_back(
            {.code = ProblemCode::node_unheard,
             .on = on,
             .what = "neither readings nor SENSOR_HEALTH of its sensors arrive, but its heartbeats "
                     "do",
             .remedy = unheard_remedy(view, node),
             .subject = subject});
    } else if (what == SensorSilence::no_readings) {
        problems.push_back({.code = ProblemCode::node_readings_lost,
                            .on = on,
                            .what =
                                "none of its readings arrives, though it sends them (lost), but its other "
                                "frames do",
                            .remedy = lost_where(view, node),
                            .key = "lost",
                            .hidden_by = subject});
    } else if (what == SensorSilence::mostly_lost) {
        problems.push_back({.code = ProblemCode::node_readings_lost,
                            .on = on,
                            .what = lost_of_node(view, node),
                            .remedy = kLossRemedy,
                            .key = "lost",
                            .hidden_by = subject});
    }
}

void add_of_sensor(const DaemonView& view, const HostNode& node, const NodeSilence::OfSensor& silent,
                   Problems& problems) {
    const std::string on = node_subject(node.node_id);
    const std::string sensor = sensor_text(node, silent.index);
    const SentCount& sent = record_of(view, node, silent.index).sent;
    if (silent.what == SensorSilence::unheard) {
        problems.push_back({.code = ProblemCode::sensor_unheard,
                            .on = sensor,
                            .what =
                                "neither its readings nor its SENSOR_HEALTH arrive, but the other frames of "
                                "its node do",
                            .remedy = kGatewayRemedy,
                            .subject = sensor,
                            .hidden_by = on});
    } else if (const auto loss = sent.newest_loss(*view.bus_now);
               loss && silent.what == SensorSilence::mostly_lost) {
        problems.push_back({.code = ProblemCode::sensor_readings_lost,
                            .on = sensor,
                            .what = lost_text(*loss, "its node", sent.lost()) +
                                    ", but those of other sensors of the node do",
                            .remedy = kLossRemedy,
                            .key = "lost",
                            .hidden_by = on});
    } else {
        problems.push_back(
            {.code = ProblemCode::sensor_readings_lost,
             .on = sensor,
             .what = fmt::format("none of its readings arrives, though its node sends them (lost, {}), but "
                                 "those of other sensors of the node do",
                                 sent.lost()),
             .remedy = kGatewayRemedy,
             .key = "lost",
             .hidden_by = on});
    }
}

}  // namespace

void add_silence(const DaemonView& view, const HostNode& node, Problems& problems) {
    if (!view.bus_now) return;
    const NodeSilence silence = silence_of(view.pipeline->intake().ranges(), node, *view.bus_now);
    add_of_node(view, node, silence.of_all, problems);
    for (const NodeSilence::OfSensor& sensor : silence.sensors) add_of_sensor(view, node, sensor, problems);
}

}  // namespace octoskin
