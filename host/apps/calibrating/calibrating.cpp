#include "host/apps/calibrating/calibrating.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>

namespace octoskin::calibrating {
namespace {

AppError app_error(const socketcan::SocketFault& fault) {
    return {ExitCode::unavailable, fault.message()};
}

}  // namespace

Result<Question, AppError> question_of(const rig::Rig& rig, const Wish& wish, std::uint8_t sequence) {
    std::string names;
    for (const rig::Node& node : rig.nodes) {
        const bool is_only = wish.node.empty() && rig.nodes.size() == 1;
        names += (names.empty() ? "" : ", ") + node.name;
        if (!is_only && node.name != wish.node && std::to_string(node.config.node_id) != wish.node) continue;
        std::string sensors;
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            sensors += (sensors.empty() ? "" : ", ") + node.sensors[i].name;
            if (node.sensors[i].name != wish.sensor) continue;
            return Question{.node_id = node.config.node_id,
                            .node_name = node.name,
                            .node_hash = node_hash(node.config),
                            .sensor = static_cast<std::uint8_t>(i),
                            .sensor_name = wish.sensor,
                            .quantity = wish.quantity,
                            .target_mm = wish.target_mm,
                            .inter_measurement_ms = node.config.sensors[i].inter_measurement_ms,
                            .sequence = sequence};
        }
        return fail(ExitCode::usage,
                    fmt::format("no sensor '{}' on node {}: it has {}", wish.sensor, node.name, sensors));
    }
    if (wish.node.empty()) return fail(ExitCode::usage, "which node? --node takes one of: " + names);
    return fail(ExitCode::usage,
                fmt::format("no node '{}' in rig {}: it has {}", wish.node, rig.name, names));
}

Outside this_machine() {
    const auto now = [] {
        const auto since_boot = std::chrono::steady_clock::now().time_since_epoch();
        return HostTime{std::chrono::duration_cast<Nanoseconds>(since_boot).count()};
    };
    const auto wait = [now](int descriptor, HostTime until) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now()).count();
        pollfd entry{.fd = descriptor, .events = POLLIN, .revents = 0};
        (void)::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 1'000)));
    };
    return {now, wait};
}

Dialogue::Outcome converse(Dialogue& dialogue, socketcan::CanSocket& socket, const Outside& outside) {
    std::optional<wire::CanFrame> unsent;
    while (!dialogue.outcome()) {
        auto received = socket.receive();
        if (!received) return unexpected(app_error(received.error()));
        if (*received) {
            dialogue.on_frame((*received)->entry.frame, outside.now());
        } else {
            outside.wait(socket.descriptor(), dialogue.deadline());
        }
        dialogue.on_time(outside.now());
        if (auto frame = dialogue.take_frame()) unsent = frame;
        if (!unsent) continue;
        const auto sent = socket.send(*unsent);
        if (!sent) return unexpected(app_error(sent.error()));
        if (*sent) unsent.reset();
    }
    return *dialogue.outcome();
}

rig::SensorEdit edit_of(const Question& question, const wire::Calibration& found) {
    const bool is_offset = question.quantity == wire::CalibrationQuantity::offset;
    return {.node = question.node_name,
            .sensor = question.sensor_name,
            .key = is_offset ? "device_offset_mm" : "crosstalk_kcps",
            .value = is_offset ? fmt::format("{:.2f}", found.offset_quarter_mm / 4.0)
                               : fmt::format("{:.6f}", found.crosstalk_raw / 512.0)};
}

}  // namespace octoskin::calibrating
