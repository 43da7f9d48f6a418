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
        const auto refuse = [&wish](const std::string& what) {
            return fail(ExitCode::usage, wish.code + " " + what);
        };
        if (wish.period_ms && code != CommandCode::set_rate) return refuse("takes no --period-ms");
        if (wish.seconds && code != CommandCode::identify) return refuse("takes no --seconds");
        if (!wish.sensor.empty() && !takes_sensor(code))
            return refuse("concerns the whole node: it takes no --sensor");
        if (code == CommandCode::set_rate && !wish.period_ms)
            return refuse("needs --period-ms; 0 means the configured period");
        std::uint16_t argument = 0;
        if (code == CommandCode::set_rate) argument = *wish.period_ms;
        if (code == CommandCode::identify) argument = wish.seconds.value_or(kIdentifySeconds);
        return wire::Command{.code = code, .argument = argument, .sequence = sequence};
    }
    return fail(ExitCode::usage, fmt::format("there is no command '{}'; the commands are {}", wish.code,
                                             rig::joined(code_names())));
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
        if (number && *number == rig->joints.node_id)
            return fail(ExitCode::usage,
                        fmt::format("node {} is the rig's joint source: it takes no commands", *number));
        return fail(ExitCode::usage,
                    fmt::format("no node '{}' in rig {}: it has {}", wanted, rig->name, names_of(*rig)));
    }
    if (number && wire::is_allowed(wire::Party::from_node, *number))
        return std::vector<Order>{{.node_id = *number}};
    return fail(ExitCode::usage,
                fmt::format("no node '{}': without --rig a node is a number, 1 to 62", wanted));
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
        return fail(ExitCode::usage,
                    fmt::format("no sensor '{}': without --rig a sensor is a number, from 0", sensor));
    return fail(ExitCode::usage, fmt::format("no sensor '{}' on {}: it has {}", sensor, order.whom(),
                                             rig::joined(order.known->sensors)));
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
