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
#include "hw/rigfile/sensor_reader.hpp"

namespace octoskin::rig {
namespace {

constexpr std::size_t kNodesMax = 61;
constexpr std::uint32_t kI2cHzMax = 400'000;

/// Records the first user of each resource.
class Taken {
  public:
    /// Fails at `table.key` if `thing` is already in use.
    void take(const Table& table, std::string_view key, const std::string& thing) {
        const auto [first, is_new] = first_.try_emplace(thing, table.path_of(key));
        if (!is_new)
            table.fail(
                key, fmt::format("expected a unique value, found {} again: {} has it", thing, first->second));
    }

  private:
    std::map<std::string, std::string> first_;
};

/// `verification: {enabled: true, leave_out: [0x47]}`: registers that may read back a different value.
void read_verification(const Table& node, NodeConfig& config) {
    const Value* value = node.find("verification");
    if (value == nullptr) return;
    const Table table(*value, node.path_of("verification"), {"enabled", "leave_out"});
    config.verifies_registers = table.flag("enabled", config.verifies_registers);
    const Value* list = table.find("leave_out");
    if (list == nullptr) return;
    const std::string path = table.path_of("leave_out");
    std::set<std::uint8_t> left_out;
    for (const Value& item : read_list(*list, path)) {
        const auto index = static_cast<std::uint8_t>(read_integer(item, path, {0, kVerifiedRegisterMax}));
        if (!is_verified(index)) {
            fail(item, path,
                 fmt::format("expected a register that is read back, found 0x{:02X}: it is not", index));
        }
        if (!left_out.insert(index).second)
            fail(item, path, fmt::format("expected each register once, found 0x{:02X} again", index));
    }
    if (left_out.size() > kRegistersLeftOutMax) {
        fail(*list, path,
             fmt::format("expected at most {} registers, found {}: `enabled: false` leaves all of them out",
                         kRegistersLeftOutMax, left_out.size()));
    }
    config.left_out_count = static_cast<std::uint8_t>(left_out.size());
    std::ranges::copy(left_out, config.left_out.begin());
}

void read_ready_jitter(const Table& table, NodeConfig& config) {
    config.ready_jitter_us = table.integer<std::uint16_t>(
        "ready_jitter_us", {kReadyJitterMinUs, kReadyJitterMaxUs}, config.ready_jitter_us);
    if (!config.holds_phases || config.ready_jitter_us <= kReadyJitterOfPhasesMaxUs) return;
    table.fail("ready_jitter_us",
               fmt::format("expected at most {} with holds_phases, found {}: where ranges differ more in "
                           "length a sensor's phase cannot be measured; use one of the two",
                           kReadyJitterOfPhasesMaxUs, config.ready_jitter_us));
}

NodeConfig read_node_settings(const Table& table, const NodeContext& context, const Board& board) {
    NodeConfig config;
    config.node_id = table.integer<std::uint8_t>("node_id", {1, kUnconfiguredNodeId - 1});
    config.board_type = board.board_type;
    config.uses_can_fd = context.bus.uses_can_fd;
    config.nominal_bitrate = context.bus.nominal_bitrate;
    config.data_bitrate = context.bus.data_bitrate;
    config.i2c_hz = table.integer<std::uint32_t>("i2c_hz", {10'000, kI2cHzMax}, config.i2c_hz);
    config.is_io_2v8 = table.choice<bool>("io_level", {{"2v8", true}, {"1v8", false}}, true);
    config.reads_twice = table.flag("reads_twice", config.reads_twice);
    config.stream_gate = table.choice<StreamGate>(
        "stream_gate",
        {{"off", StreamGate::off}, {"differs", StreamGate::differs}, {"advanced", StreamGate::advanced}},
        config.stream_gate);
    config.aux_every = table.integer<std::uint8_t>("aux_every", {0, 255}, config.aux_every);
    config.zone_guard_us = table.integer<std::uint16_t>("zone_guard_us", {0, 20'000}, config.zone_guard_us);
    config.holds_phases = table.flag("holds_phases", config.holds_phases);
    config.refuses_commands = table.flag("refuses_commands", config.refuses_commands);
    read_ready_jitter(table, config);
    read_verification(table, config);
    if (config.uses_can_fd && !board.supports_can_fd) {
        table.fail("board",
                   fmt::format("expected a board with CAN FD, as `bus` asks for; {} has classical CAN only",
                               board.name));
    }
    return config;
}

void refuse_shared_wiring(const Table& sensor, const SensorConfig& config, Taken& taken) {
    taken.take(sensor, "address", fmt::format("address 0x{:02X} on bus {}", config.address, config.bus));
    taken.take(sensor, "xshut_line", fmt::format("xshut_line {}", config.xshut_line));
}

/// A zone is written only while no range can begin. Without such a pause the sensor would stay in its first
/// zone.
void refuse_zones_without_a_pause(const Table& sensor, const NodeConfig& node, const SensorConfig& config) {
    if (config.zone_count < 2) return;
    const std::int64_t pause_ms = (zone_pause(node, config).count() + 999) / 1'000;
    if (config.inter_measurement_ms >= config.timing_budget_ms + pause_ms) return;
    sensor.fail(
        "inter_measurement_ms",
        fmt::format(
            "expected at least timing_budget_ms + {} = {} with {} zones, found {}: a zone must be written "
            "before the next range can begin; use a longer inter_measurement_ms, a shorter "
            "timing_budget_ms, or one zone",
            pause_ms, config.timing_budget_ms + pause_ms, config.zone_count, config.inter_measurement_ms));
}

void read_sensors(const Table& node_table, const NodeContext& context, Node& node) {
    const Value& list = node_table.require("sensors");
    const std::string path = node_table.path_of("sensors");
    const auto& items = read_list(list, path);
    const std::size_t sensors_max = std::min<std::size_t>(node.board.sensors_max, kNodeSensorsMax);
    if (items.empty() || items.size() > sensors_max) {
        fail(list, path,
             fmt::format("expected 1 to {} sensors on a {}, found {}", sensors_max, node.board.name,
                         items.size()));
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
        taken.take(table, "name", fmt::format("name '{}'", entry.sensor.name));
        refuse_shared_wiring(table, entry.config, taken);
        refuse_zones_without_a_pause(table, node.config, entry.config);
        if (++sensors_on_bus[entry.config.bus] > node.board.sensors_per_bus_max) {
            table.fail("bus",
                       fmt::format("expected at most {} sensors on a bus of a {}, found more on bus {}",
                                   node.board.sensors_per_bus_max, node.board.name, entry.config.bus));
        }
        node.config.sensors[i] = entry.config;
        node.config.sensor_count = static_cast<std::uint8_t>(i + 1);
        node.sensors.push_back(std::move(entry.sensor));
    }
}

/// `data_ready_buses: [0, 2]`: buses whose sensors' GPIO1 are wired to the board's input for that bus.
void read_data_ready_buses(const Table& table, Node& node) {
    const Value* list = table.find("data_ready_buses");
    if (list == nullptr) return;
    const std::string path = table.path_of("data_ready_buses");
    if (!node.board.has_data_ready_lines) {
        fail(*list, path,
             fmt::format("expected a board with data-ready lines; {} has none", node.board.name));
    }
    const auto sensors = std::span(node.config.sensors).first(node.config.sensor_count);
    for (const Value& item : read_list(*list, path)) {
        const auto bus =
            static_cast<std::uint8_t>(read_integer(item, path, {0, node.board.i2c_bus_count - 1}));
        const auto bit = static_cast<std::uint8_t>(1U << bus);
        if ((node.config.data_ready_buses & bit) != 0) {
            fail(item, path, fmt::format("expected each bus once, found {} again", bus));
        }
        if (std::ranges::none_of(sensors, [bus](const SensorConfig& sensor) { return sensor.bus == bus; })) {
            fail(item, path, fmt::format("expected a bus with sensors, found {}, which has none", bus));
        }
        node.config.data_ready_buses |= bit;
    }
}

void refuse_jitter_of_whole_periods(const Table& table, const Node& node) {
    const auto sensors = std::span(node.config.sensors).first(node.config.sensor_count);
    const auto shortest = std::ranges::min_element(sensors, {}, &SensorConfig::inter_measurement_ms);
    const std::uint32_t most_us = 1000U * shortest->inter_measurement_ms / kReadyJittersPerPeriodMin;
    if (node.config.ready_jitter_us == kReadyJitterMinUs || node.config.ready_jitter_us <= most_us) return;
    table.fail("ready_jitter_us",
               fmt::format("expected at most {} with an inter_measurement_ms of {}, found {}: the "
                           "sensor's period could not be measured; use a longer one",
                           most_us, shortest->inter_measurement_ms, node.config.ready_jitter_us));
}

void refuse_overloaded_i2c(const Table& table, const Node& node) {
    for (std::uint8_t bus = 0; bus < node.board.i2c_bus_count; ++bus) {
        const double load = i2c_load(node.config, bus);
        if (load <= kI2cLoadMax) continue;
        table.fail(
            "sensors",
            fmt::format("expected an I2C load of at most {:.0f} %, found {:.0f} % on bus {}: use a longer "
                        "inter_measurement_ms{} fewer sensors on this bus{}",
                        100.0 * kI2cLoadMax, 100.0 * load, bus, node.config.i2c_hz < kI2cHzMax ? "," : " or",
                        node.config.i2c_hz < kI2cHzMax ? ", or a faster i2c_hz" : ""));
    }
}

Node read_node(const Table& table, const NodeContext& context) {
    Node node;
    node.name = table.folder_name("name");
    node.board = read_board(table.require("board"), table.path_of("board"));
    node.config = read_node_settings(table, context, node.board);
    if (table.find("pinned_build_id")) {
        node.pinned_build_id = table.integer<std::uint32_t>("pinned_build_id", {0, 0xFFFF'FFFF});
    }
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
    const Table table(value, path,
                      {"name", "board_type", "i2c_bus_count", "xshut_line_count", "sensors_max",
                       "sensors_per_bus_max", "supports_can_fd", "has_data_ready_lines"});
    Board board;
    board.name = table.folder_name("name");  // the shipped boards' files are found by this name
    board.board_type = table.integer<std::uint8_t>("board_type", {0, 255});
    board.i2c_bus_count = table.integer<std::uint8_t>("i2c_bus_count", {1, kNodeBusesMax});
    board.xshut_line_count = table.integer<std::uint8_t>("xshut_line_count", {1, kNodeXshutLinesMax});
    board.sensors_max = table.integer<std::uint8_t>("sensors_max", {1, kNodeSensorsMax});
    board.sensors_per_bus_max = table.integer<std::uint8_t>("sensors_per_bus_max", {1, kNodeSensorsMax});
    board.supports_can_fd = table.flag("supports_can_fd");
    board.has_data_ready_lines = table.flag("has_data_ready_lines", false);
    return board;
}

std::vector<Node> read_nodes(const Value& value, const std::string& path, const NodeContext& context) {
    const auto& items = read_list(value, path);
    if (items.empty() || items.size() > kNodesMax) {
        fail(value, path, fmt::format("expected 1 to {} nodes, found {}", kNodesMax, items.size()));
    }
    std::vector<Node> nodes;
    Taken taken;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Table table(
            items[i], fmt::format("{}[{}]", path, i),
            {"name", "node_id", "board", "i2c_hz", "io_level", "reads_twice", "stream_gate", "aux_every",
             "zone_guard_us", "holds_phases", "data_ready_buses", "ready_jitter_us", "verification",
             "refuses_commands", "pinned_build_id", "sensors"});
        nodes.push_back(read_node(table, context));
        taken.take(table, "name", fmt::format("name '{}'", nodes.back().name));
        taken.take(table, "node_id", fmt::format("node_id {}", nodes.back().config.node_id));
    }
    return nodes;
}

}  // namespace octoskin::rig
