#include "hw/rigfile/node_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>

#include "common/config/verified_registers.hpp"
#include "common/wire/messages.hpp"
#include "hw/rigfile/i2c_load.hpp"
#include "hw/rigfile/rig_keys.hpp"
#include "hw/rigfile/sensor_reader.hpp"

namespace octoskin::rig {
namespace {

/// Records the first user of each resource.
class Taken {
  public:
    /// Fails at `table.key` if `thing` is already in use.
    void take(const Table& table, const DeclaredKey auto& key, const std::string& thing) {
        const auto [first, is_new] = first_.try_emplace(thing, table.path_of(key));
        if (!is_new)
            table.fail(key, {ErrorCode::duplicate, "expected a unique value", thing + " again",
                             fmt::format("{} has it", first->second)});
    }

  private:
    std::map<std::string, std::string> first_;
};

/// `verification: {enabled: true, leave_out: [0x47]}`: registers that may read back a different value.
void read_verification(const Table& node, NodeConfig& config) {
    const Value* value = node.find(keys::node::kVerification);
    if (value == nullptr) return;
    const Table table(*value, node.path_of(keys::node::kVerification), keys::kVerification);
    config.verifies_registers = table.flag(keys::verification::kEnabled);
    const Value* list = table.find(keys::verification::kLeaveOut);
    if (list == nullptr) return;
    const std::string path = table.path_of(keys::verification::kLeaveOut);
    std::set<std::uint8_t> left_out;
    for (const Value& item : read_list(*list, path)) {
        const auto index =
            static_cast<std::uint8_t>(read_integer(item, path, keys::verification::kLeaveOut.range));
        if (!is_verified(index)) {
            fail(item, path,
                 {ErrorCode::bad_value, "expected a register that is read back",
                  fmt::format("0x{:02X}, which is not", index)});
        }
        if (!left_out.insert(index).second)
            fail(item, path,
                 {ErrorCode::duplicate, "expected each register once", fmt::format("0x{:02X} again", index)});
    }
    if (left_out.size() > kRegistersLeftOutMax) {
        fail(*list, path,
             {ErrorCode::limit_exceeded, fmt::format("expected at most {} registers", kRegistersLeftOutMax),
              std::to_string(left_out.size()), "`enabled: false` leaves all of them out"});
    }
    config.left_out_count = static_cast<std::uint8_t>(left_out.size());
    std::ranges::copy(left_out, config.left_out.begin());
}

void read_ready_jitter(const Table& table, NodeConfig& config) {
    config.ready_jitter_us = table.integer<std::uint16_t>(keys::node::kReadyJitter);
    if (!config.holds_phases || config.ready_jitter_us <= kReadyJitterOfPhasesMaxUs) return;
    table.fail(
        keys::node::kReadyJitter,
        {ErrorCode::conflict,
         fmt::format("expected at most {} with holds_phases, because a sensor's phase cannot be measured "
                     "where ranges differ more in length",
                     kReadyJitterOfPhasesMaxUs),
         std::to_string(config.ready_jitter_us), "use one of the two"});
}

NodeConfig read_node_settings(const Table& table, const NodeContext& context, const Board& board) {
    NodeConfig config;
    config.node_id = table.integer<std::uint8_t>(keys::node::kNodeId);
    config.board_type = board.board_type;
    config.uses_can_fd = context.bus.uses_can_fd;
    config.nominal_bitrate = context.bus.nominal_bitrate;
    config.data_bitrate = context.bus.data_bitrate;
    config.i2c_hz = table.integer<std::uint32_t>(keys::node::kI2cHz);
    config.is_io_2v8 = table.choice(keys::node::kIoLevel);
    config.reads_twice = table.flag(keys::node::kReadsTwice);
    config.stream_gate = table.choice(keys::node::kStreamGate);
    config.aux_every = table.integer<std::uint8_t>(keys::node::kAuxEvery);
    config.zone_guard_us = table.integer<std::uint16_t>(keys::node::kZoneGuard);
    config.holds_phases = table.flag(keys::node::kHoldsPhases);
    config.refuses_commands = table.flag(keys::node::kRefusesCommands);
    read_ready_jitter(table, config);
    read_verification(table, config);
    if (config.uses_can_fd && !board.supports_can_fd) {
        table.fail(keys::node::kBoard,
                   {ErrorCode::conflict, "expected a board with CAN FD, which `bus` requires",
                    board.name + ", which has classical CAN only"});
    }
    return config;
}

void refuse_shared_wiring(const Table& sensor, const SensorConfig& config, Taken& taken) {
    taken.take(sensor, keys::sensor::kAddress,
               fmt::format("address 0x{:02X} on bus {}", config.address, config.bus));
    taken.take(sensor, keys::sensor::kXshutLine, fmt::format("xshut_line {}", config.xshut_line));
}

/// A zone is written only while no range can begin. Without such a pause the sensor would stay in its first
/// zone.
void refuse_zones_without_a_pause(const Table& sensor, const NodeConfig& node, const SensorConfig& config) {
    if (config.zone_count < 2) return;
    const std::int64_t pause_ms = (zone_pause(node, config).count() + 999) / 1'000;
    if (config.inter_measurement_ms >= config.timing_budget_ms + pause_ms) return;
    sensor.fail(
        keys::sensor::kInterMeasurement,
        {ErrorCode::conflict,
         fmt::format("expected at least timing_budget_ms + {} = {} with {} zones, because a zone must be "
                     "written before the next range can begin",
                     pause_ms, config.timing_budget_ms + pause_ms, config.zone_count),
         std::to_string(config.inter_measurement_ms),
         "use a longer inter_measurement_ms, a shorter timing_budget_ms, or one zone"});
}

void read_sensors(const Table& node_table, const NodeContext& context, Node& node) {
    const Value& list = node_table.require(keys::node::kSensors);
    const std::string path = node_table.path_of(keys::node::kSensors);
    const auto& items = read_list(list, path);
    const std::size_t sensors_max =
        std::min<std::size_t>(node.board.sensors_max, keys::node::kSensors.count.max);
    if (items.size() < keys::node::kSensors.count.min || items.size() > sensors_max) {
        fail(list, path,
             {ErrorCode::limit_exceeded,
              fmt::format("expected {} to {} sensors on a {}", keys::node::kSensors.count.min, sensors_max,
                          node.board.name),
              std::to_string(items.size())});
    }
    Taken taken;
    std::array<std::size_t, 256> sensors_on_bus{};
    for (std::size_t i = 0; i < items.size(); ++i) {
        const std::string sensor_path = fmt::format("{}[{}]", path, i);
        const Value value = context.sensor_defaults && items[i].kind == Value::Kind::table
                                ? merge(*context.sensor_defaults, items[i])
                                : items[i];
        const Table table = sensor_table(value, sensor_path);
        SensorEntry entry = read_sensor(table, context.robot, context.base_link, node.board);
        taken.take(table, keys::sensor::kName, fmt::format("name '{}'", entry.sensor.name));
        refuse_shared_wiring(table, entry.config, taken);
        refuse_zones_without_a_pause(table, node.config, entry.config);
        if (++sensors_on_bus[entry.config.bus] > node.board.sensors_per_bus_max) {
            table.fail(keys::sensor::kBus, {ErrorCode::limit_exceeded,
                                            fmt::format("expected at most {} sensors on a bus of a {}",
                                                        node.board.sensors_per_bus_max, node.board.name),
                                            fmt::format("more on bus {}", entry.config.bus)});
        }
        node.config.sensors[i] = entry.config;
        node.config.sensor_count = static_cast<std::uint8_t>(i + 1);
        node.sensors.push_back(std::move(entry.sensor));
    }
}

/// `data_ready_buses: [0, 2]`: buses whose sensors' GPIO1 are wired to the board's input for that bus.
void read_data_ready_buses(const Table& table, Node& node) {
    const Value* list = table.find(keys::node::kDataReadyBuses);
    if (list == nullptr) return;
    const std::string path = table.path_of(keys::node::kDataReadyBuses);
    if (!node.board.has_data_ready_lines) {
        fail(*list, path,
             {ErrorCode::conflict, "expected a board with data-ready lines",
              node.board.name + ", which has none"});
    }
    const auto sensors = std::span(node.config.sensors).first(node.config.sensor_count);
    for (const Value& item : read_list(*list, path)) {
        const auto bus = static_cast<std::uint8_t>(
            read_integer(item, path, {keys::node::kDataReadyBuses.range.min, node.board.i2c_bus_count - 1}));
        const auto bit = static_cast<std::uint8_t>(1U << bus);
        if ((node.config.data_ready_buses & bit) != 0) {
            fail(item, path, {ErrorCode::duplicate, "expected each bus once", fmt::format("{} again", bus)});
        }
        if (std::ranges::none_of(sensors, [bus](const SensorConfig& sensor) { return sensor.bus == bus; })) {
            fail(item, path,
                 {ErrorCode::bad_value, "expected a bus with sensors",
                  fmt::format("{}, which has none", bus)});
        }
        node.config.data_ready_buses |= bit;
    }
}

void refuse_jitter_of_whole_periods(const Table& table, const Node& node) {
    const auto sensors = std::span(node.config.sensors).first(node.config.sensor_count);
    const auto shortest = std::ranges::min_element(sensors, {}, &SensorConfig::inter_measurement_ms);
    const std::uint32_t most_us = 1000U * shortest->inter_measurement_ms / kReadyJittersPerPeriodMin;
    if (node.config.ready_jitter_us == kReadyJitterMinUs || node.config.ready_jitter_us <= most_us) return;
    table.fail(keys::node::kReadyJitter,
               {ErrorCode::conflict,
                fmt::format("expected at most {} with an inter_measurement_ms of {}, because the sensor's "
                            "period could not be measured",
                            most_us, shortest->inter_measurement_ms),
                std::to_string(node.config.ready_jitter_us), "use a longer inter_measurement_ms"});
}

void refuse_overloaded_i2c(const Table& table, const Node& node) {
    const bool can_be_faster = node.config.i2c_hz < keys::node::kI2cHz.range.max;
    for (std::uint8_t bus = 0; bus < node.board.i2c_bus_count; ++bus) {
        const double load = i2c_load(node.config, bus);
        if (load <= kI2cLoadMax) continue;
        table.fail(keys::node::kSensors,
                   {ErrorCode::overload,
                    fmt::format("expected an I2C load of at most {:.0f} %", 100.0 * kI2cLoadMax),
                    fmt::format("{:.0f} % on bus {}", 100.0 * load, bus),
                    fmt::format("use a longer inter_measurement_ms{} fewer sensors on this bus{}",
                                can_be_faster ? "," : " or", can_be_faster ? ", or a faster i2c_hz" : "")});
    }
}

Node read_node(const Table& table, const NodeContext& context) {
    Node node;
    node.name = table.text(keys::node::kName);
    node.board = read_board(table.require(keys::node::kBoard), table.path_of(keys::node::kBoard));
    node.config = read_node_settings(table, context, node.board);
    if (table.find(keys::node::kPinnedBuildId))
        node.pinned_build_id = table.integer<std::uint32_t>(keys::node::kPinnedBuildId);
    read_sensors(table, context, node);
    read_data_ready_buses(table, node);
    refuse_jitter_of_whole_periods(table, node);
    refuse_overloaded_i2c(table, node);
    return node;
}

}  // namespace

Board read_board(const Value& value, const std::string& path) {
    if (value.kind == Value::Kind::scalar) {
        return read_board(load_document(existing_file(value, path), Quotes::withheld), "");
    }
    const Table table(value, path, keys::kBoard);
    Board board;
    board.name = table.text(keys::board::kName);  // the shipped boards' files are found by this name
    board.board_type = table.integer<std::uint8_t>(keys::board::kBoardType);
    board.i2c_bus_count = table.integer<std::uint8_t>(keys::board::kI2cBusCount);
    board.xshut_line_count = table.integer<std::uint8_t>(keys::board::kXshutLineCount);
    board.sensors_max = table.integer<std::uint8_t>(keys::board::kSensorsMax);
    board.sensors_per_bus_max = table.integer<std::uint8_t>(keys::board::kSensorsPerBusMax);
    board.supports_can_fd = table.flag(keys::board::kSupportsCanFd);
    board.has_data_ready_lines = table.flag(keys::board::kHasDataReadyLines);
    return board;
}

std::vector<Node> read_nodes(const Value& value, const std::string& path, const NodeContext& context) {
    const auto& items = read_list(value, path);
    constexpr Range<std::size_t> kCount = keys::kNodes.count;
    if (items.size() < kCount.min || items.size() > kCount.max) {
        fail(value, path,
             {ErrorCode::limit_exceeded, fmt::format("expected {} to {} nodes", kCount.min, kCount.max),
              std::to_string(items.size())});
    }
    std::vector<Node> nodes;
    Taken taken;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Table table(items[i], fmt::format("{}[{}]", path, i), keys::kNode);
        nodes.push_back(read_node(table, context));
        taken.take(table, keys::node::kName, fmt::format("name '{}'", nodes.back().name));
        taken.take(table, keys::node::kNodeId, fmt::format("node_id {}", nodes.back().config.node_id));
    }
    return nodes;
}

}  // namespace octoskin::rig
