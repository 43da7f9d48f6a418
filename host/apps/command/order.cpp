#include "host/apps/command/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "common/wire/frame_type.hpp"
#include "common/wire/names.hpp"
#include "hw/rigfile/joined.hpp"

namespace octoskin::commanding {
namespace {

using wire::CommandCode;

constexpr std::uint16_t kIdentifySeconds = 10;

bool is_offered(CommandCode code) {
    return code != CommandCode::calibrate_offset && code != CommandCode::calibrate_crosstalk;
}

bool takes_sensor(CommandCode code) {
    return code != CommandCode::identify && code != CommandCode::reset && code != CommandCode::send_info;
}

std::optional<std::uint8_t> number_of(const std::string& text) {
    std::uint8_t value = 0;
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, value);
    if (parsed.ec != std::errc{} || parsed.ptr != end) return std::nullopt;
    return value;
}

Result<wire::Command, AppError> command_of(const Wish& wish, std::uint8_t sequence) {
    for (const auto& [code, name] : wire::values_of(CommandCode{})) {
        if (!is_offered(code) || name != wish.code) continue;
        const auto refuse = [](const char* option, const std::string& what, const std::string& remedy) {
            return fail(ExitCode::usage,
                        {.code = ErrorCode::bad_argument, .what = what, .remedy = remedy, .key = option});
        };
        const auto is_not_taken = [&](const char* option, const std::string& why = {}) {
            return refuse(option, "`" + wish.code + "` does not take this option" + why, "leave it out");
        };
        if (wish.period_ms && code != CommandCode::set_rate) return is_not_taken("--period-ms");
        if (wish.seconds && code != CommandCode::identify) return is_not_taken("--seconds");
        if (!wish.sensor.empty() && !takes_sensor(code))
            return is_not_taken("--sensor", ": it concerns the whole node");
        if (code == CommandCode::set_rate && !wish.period_ms)
            return refuse("--period-ms", "`set_rate` needs this option", "0 means the configured period");
        std::uint16_t argument = 0;
        if (code == CommandCode::set_rate) argument = *wish.period_ms;
        if (code == CommandCode::identify) argument = wish.seconds.value_or(kIdentifySeconds);
        return wire::Command{.code = code, .argument = argument, .sequence = sequence};
    }
    return fail(ExitCode::usage, {ErrorCode::unknown_word, "expected a command for a node",
                                  "'" + wish.code + "'", "the commands are " + rig::joined(code_names())});
}

std::string names_of(const rig::Rig& rig) {
    std::vector<std::string> names;
    for (const rig::Node& node : rig.nodes)
        names.push_back(fmt::format("{} ({})", node.name, node.config.node_id));
    return rig::joined(names);
}

Order::Known known_of(const rig::Node& node) {
    Order::Known known{.name = node.name, .node_hash = node_hash(node.config), .sensors = {}};
    for (const rig::Sensor& sensor : node.sensors) known.sensors.push_back(sensor.name);
    return known;
}

/// One order for each addressed node, still without a command.
Result<std::vector<Order>, AppError> recipients(const rig::Rig* rig, const std::string& wanted) {
    const auto number = number_of(wanted);
    if (rig != nullptr) {
        std::vector<Order> found;
        for (const rig::Node& node : rig->nodes) {
            if (wanted != "all" && node.name != wanted && number != node.config.node_id) continue;
            found.push_back({.node_id = node.config.node_id, .known = known_of(node)});
        }
        if (!found.empty()) return found;
        const auto is_wanted = [&](const rig::JointSource& source) { return number == source.node_id; };
        if (std::ranges::any_of(rig->joint_sources, is_wanted))
            return fail(ExitCode::usage,
                        {ErrorCode::bad_argument, "expected a sensor board, which takes commands",
                         fmt::format("node {}, the rig's joint source", *number), "give another node"});
        return fail(ExitCode::usage,
                    {ErrorCode::unknown_name, fmt::format("expected a node of the rig {}", rig->name),
                     "'" + wanted + "'", "it has " + names_of(*rig)});
    }
    if (number && wire::is_allowed(wire::Party::from_node, *number))
        return std::vector<Order>{{.node_id = *number}};
    return fail(ExitCode::usage, {ErrorCode::unknown_name, "expected the number of a node, 1 to 62",
                                  "'" + wanted + "'", "give --rig for the names of nodes"});
}

Status<AppError> aim(Order& order, const std::string& sensor) {
    if (sensor.empty()) return Done{};
    if (order.known) {
        const auto& names = order.known->sensors;
        const auto found = std::find(names.begin(), names.end(), sensor);
        if (found != names.end()) {
            order.command.sensor = static_cast<std::uint8_t>(found - names.begin());
            order.is_sensor_by_name = true;
            return Done{};
        }
    }
    const auto index = number_of(sensor);
    if (index && *index < wire::kAllSensors) {
        order.command.sensor = *index;
        return Done{};
    }
    if (!order.known)
        return fail(ExitCode::usage, {.code = ErrorCode::unknown_name,
                                      .what = "expected the number of a sensor, from 0",
                                      .value = "'" + sensor + "'",
                                      .remedy = "give --rig for the names of sensors",
                                      .key = "--sensor"});
    return fail(ExitCode::usage, {.code = ErrorCode::unknown_name,
                                  .what = "expected a sensor of " + order.whom(),
                                  .value = "'" + sensor + "'",
                                  .remedy = "it has " + rig::joined(order.known->sensors),
                                  .key = "--sensor"});
}

}  // namespace

std::vector<std::string> code_names() {
    std::vector<std::string> names;
    for (const auto& [code, name] : wire::values_of(CommandCode{})) {
        if (is_offered(code)) names.emplace_back(name);
    }
    return names;
}

std::string Order::whom() const {
    return known ? fmt::format("node {} '{}'", node_id, known->name) : fmt::format("node {}", node_id);
}

Result<std::vector<Order>, AppError> orders_of(const rig::Rig* rig, const Wish& wish, std::uint8_t sequence) {
    const auto command = command_of(wish, sequence);
    if (!command) return unexpected(command.error());
    auto orders = recipients(rig, wish.node);
    if (!orders) return unexpected(orders.error());
    for (Order& order : *orders) {
        order.command = *command;
        if (const auto aimed = aim(order, wish.sensor); !aimed) return unexpected(aimed.error());
    }
    return orders;
}

}  // namespace octoskin::commanding
