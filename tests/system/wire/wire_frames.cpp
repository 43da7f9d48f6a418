// Prints frames of every message, and what a reader of hw/octoskin.dbc must find in each: a line of candump
// -L, then a line of JSON (message, and each signal's value in the DBC's units). The values come from the
// message structs, not from the layout the DBC was made of.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <variant>

#include "common/wire/codec.hpp"
#include "common/wire/names.hpp"
#include "host/io/candump/log_line.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin {
namespace {

using nlohmann::json;
using namespace wire;

template <class E>
json choice(E value) {
    return {{"raw", static_cast<unsigned>(value)}, {"name", name(value)}};
}
double radians(std::int32_t microradians) {
    return microradians / 1e6;
}
double mcps(std::uint16_t raw) {
    return raw / 128.0;
}
std::uint64_t uid_number(const std::array<std::uint8_t, 6>& uid) {
    std::uint64_t number = 0;
    for (std::size_t i = 6; i > 0; --i) {
        number = number * 256 + uid[i - 1];
    }
    return number;
}

json expected(const Range& m) {
    const RangeReading& r = m.reading;
    return {{"sensor", r.sensor},
            {"zone", r.zone},
            {"device_status", r.device_status},
            {"range", r.range_mm},
            {"sigma", r.sigma_quarter_mm / 4},
            {"capture_time", r.capture.value_us},
            {"sequence", r.sequence}};
}
json expected(const Reflex& m) {
    return {{"sensor", m.sensor},
            {"zone", m.zone},
            {"range", m.range_mm},
            {"capture_time", m.capture.value_us},
            {"sequence", m.sequence}};
}
json expected(const BlackBox& m) {
    std::uint64_t bytes = 0;
    for (std::size_t i = m.bytes.size(); i-- > 0;) bytes = bytes * 256 + m.bytes[i];
    return {{"bus", m.bus}, {"dump", m.dump}, {"index", m.index}, {"bytes", bytes}};
}
json expected(const Calibration& m) {
    return {{"sensor", m.sensor},
            {"quantity", choice(m.quantity)},
            {"outcome", choice(m.outcome)},
            {"sequence", m.sequence},
            {"offset", m.offset_quarter_mm / 4.0},
            {"crosstalk", m.crosstalk_raw / 512.0}};
}
json expected(const RangeAux& m) {
    return {{"sensor", m.sensor},
            {"sequence", m.sequence},
            {"peak_signal", mcps(m.signal.peak_signal)},
            {"ambient", mcps(m.signal.ambient)}};
}
json expected(const RangeFd& m) {
    json values = {{"count", m.count}};
    for (std::size_t i = 0; i < m.count; ++i) {
        const auto& [r, signal] = m.entries[i];
        const auto at = [i](const char* field) { return fmt::format("{}_{}", field, i); };
        values.update({{at("sensor"), r.sensor},
                       {at("zone"), r.zone},
                       {at("device_status"), r.device_status},
                       {at("sequence"), r.sequence},
                       {at("range"), r.range_mm},
                       {at("sigma"), r.sigma_quarter_mm / 4.0},
                       {at("peak_signal"), mcps(signal.peak_signal)},
                       {at("ambient"), mcps(signal.ambient)},
                       {at("capture_time"), r.capture.value_us}});
    }
    return values;
}
json expected(const Heartbeat& m) {
    return {{"state", choice(m.state)},
            {"reset_cause", choice(m.reset_cause)},
            {"is_rate_overridden", m.is_rate_overridden ? 1 : 0},
            {"is_time_suspect", m.is_time_suspect ? 1 : 0},
            {"degraded_sensors", m.degraded_sensors},
            {"uid_crc", m.uid_crc},
            {"node_hash_low", m.node_hash_low}};
}
json expected(const InfoUidLow& m) {
    return {{"page", choice(InfoPage::uid_low)}, {"uid_low", uid_number(m.uid)}};
}
json expected(const InfoUidHigh& m) {
    return {{"page", choice(InfoPage::uid_high)}, {"uid_high", uid_number(m.uid)}};
}
json expected(const InfoIdentity& m) {
    return {{"page", choice(InfoPage::identity)},
            {"node_hash", m.node_hash},
            {"sensor_count", m.sensor_count},
            {"board_type", m.board_type}};
}
json expected(const InfoBuild& m) {
    return {{"page", choice(InfoPage::build)}, {"build_id", m.build_id}, {"uptime", m.uptime_s}};
}
json expected(const InfoCounters& m) {
    return {{"page", choice(InfoPage::counters)},
            {"i2c_errors", m.i2c_errors},
            {"reads_disagreed", m.reads_disagreed},
            {"sensor_restarts", m.sensor_restarts}};
}
json expected(const InfoTraffic& m) {
    return {{"page", choice(InfoPage::traffic)},
            {"tx_dropped", m.tx_dropped},
            {"late_dropped", m.late_dropped},
            {"bus_off_count", m.bus_off_count},
            {"rx_rejected", m.rx_rejected}};
}
json expected(const InfoFault& m) {
    return {{"page", choice(InfoPage::fault)},
            {"fault_kind", choice(m.kind)},
            {"fault_count", m.count},
            {"fault_where", m.where},
            {"fault_uptime", m.uptime_s}};
}
json expected(const SensorHealth& m) {
    return {{"sensor", m.sensor},
            {"state", choice(m.state)},
            {"fault", choice(m.fault)},
            {"sent", m.sent},
            {"capture_bound", 64 * m.capture_bound_64us},
            {"rejected", m.rejected},
            {"period_error", m.period_error_permille / 10.0}};
}
json expected(const Sync& m) {
    return {{"sequence", m.sequence}};
}
json expected(const FollowUp& m) {
    return {{"sequence", m.sequence}, {"host_time", m.host_time_us}};
}
json expected(const SyncReport& m) {
    return {{"sequence", m.sequence}, {"heard", m.heard.us}};
}
json expected(const JointPair& m) {
    return {{"index", m.index},
            {"sequence", m.sequence},
            {fmt::format("position_{}", 2 * m.index), radians(m.position_urad[0])},
            {fmt::format("position_{}", 2 * m.index + 1), radians(m.position_urad[1])}};
}
json expected(const JointLast& m) {
    return {{"index", 3},
            {"sequence", m.sequence},
            {"position_6", radians(m.position_urad)},
            {"sample_time", m.sampled.value_us}};
}
json expected(const Mark& m) {
    return {{"kind", choice(m.kind)}, {"host_time", m.host_time_us}};
}
json expected(const Command& m) {
    return {
        {"code", choice(m.code)}, {"sensor", m.sensor}, {"argument", m.argument}, {"sequence", m.sequence}};
}
template <class... Ts>
json expected(const std::variant<Ts...>& message) {
    return std::visit([](const auto& m) { return expected(m); }, message);
}

std::string message_name(const FrameSpec& spec, NodeId node_id) {
    if (spec.party == Party::from_host) {
        return spec.name;
    }
    return node_id == kBroadcastId ? fmt::format("{}_all", spec.name)
                                   : fmt::format("{}_{}", spec.name, node_id);
}

void print(const Message& message, NodeId node_id) {
    const CanFrame frame = encode(message, node_id);
    const FrameSpec& spec = *frame_spec(type_of(message));
    json values = expected(message);
    values["version"] = kProtocolVersion;
    const auto payload = frame.payload();
    const unsigned crc = spec.checksum == Checksum::crc8
                             ? payload.back()
                             : payload[payload.size() - 2] * 256U + payload.back();
    const auto* readings = std::get_if<RangeFd>(&message);
    values[readings == nullptr ? "crc" : fmt::format("crc_of_{}", readings->count)] = crc;
    fmt::print("{}{}\n", candump::format_line({.stamp = {}, .interface = "can0", .frame = frame}),
               json{{"message", message_name(spec, node_id)}, {"signals", values}}.dump());
}

/// The node ids of the shipped rigs that send (or are sent) such a message.
std::vector<NodeId> nodes_of(const Message& message) {
    switch (frame_spec(type_of(message))->party) {
        case Party::from_host:
            return {kHostId};
        case Party::to_node:
            return {1, 2, 3, kBroadcastId};
        case Party::from_node:
            break;
    }
    const FrameType type = type_of(message);
    if (type == FrameType::joint_state) {
        return {3};
    }
    const bool is_everyones =
        type == FrameType::heartbeat || type == FrameType::sync_report || type == FrameType::node_info;
    return is_everyones ? std::vector<NodeId>{1, 2, 3} : std::vector<NodeId>{1, 2};
}

Message with_random_fields(const test::MessageCase& layout, std::mt19937_64& random) {
    Message message = layout.message;
    for (const test::FieldCase& field : layout.fields) {
        const std::uint64_t raw = random() >> (64 - field.bits);
        if (field.is_valid(raw)) {
            field.set(message, raw);
        }
    }
    return message;
}

}  // namespace
}  // namespace octoskin

int main() {
    using namespace octoskin;
    std::mt19937_64 random(20);
    for (const test::MessageCase& layout : test::all_message_cases()) {
        for (const wire::NodeId node_id : nodes_of(layout.message)) {
            print(layout.message, node_id);
            for (int i = 0; i < 20; ++i) {
                print(with_random_fields(layout, random), node_id);
            }
        }
    }
    for (std::uint8_t index = 0; index < 3; ++index) {
        print(wire::JointState(wire::JointPair{index, 7, {-8'388'608, 8'388'607}}), 3);
    }
    return std::fflush(stdout) == 0 ? 0 : 1;
}
