#include "host/apps/command/effect.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/wire/names.hpp"
#include "host/apps/node_session/obstacle.hpp"

namespace octoskin::commanding {
namespace {

using wire::CommandCode;
using wire::SensorState;
using Health = std::optional<wire::SensorHealth>;

}  // namespace

bool is_in_effect(const Order& order, const NodeView& now, bool has_sent_black_box) {
    // True if none of the command's sensors is known to be in this state. An unknown sensor may be in any
    // state.
    const auto none_is = [&](SensorState state) {
        return !now.any_of(order.command,
                           [state](const Health& health) { return !health || health->state == state; });
    };
    const wire::NodeState state = now.state();
    const bool is_for_all = order.command.sensor == wire::kAllSensors;
    switch (order.command.code) {
        case CommandCode::start:
            return (state == wire::NodeState::ranging || state == wire::NodeState::can_fault) &&
                   none_is(SensorState::stopped) && none_is(SensorState::starting);
        case CommandCode::stop:
            return (!is_for_all || state == wire::NodeState::stopped) && none_is(SensorState::ranging) &&
                   none_is(SensorState::starting);
        case CommandCode::reinitialise_sensor:
            return none_is(SensorState::starting);
        case CommandCode::set_rate:
            return now.heartbeat.has_value();  // the configured rate is not flagged as overridden
        case CommandCode::send_black_box:
            return has_sent_black_box;
        case CommandCode::identify:
        case CommandCode::send_info:
        case CommandCode::reset:
        case CommandCode::calibrate_offset:
        case CommandCode::calibrate_crosstalk:
            return true;
    }
    return true;
}

std::string refusal(const Order& order, const NodeView& view) {
    if (view.state() == wire::NodeState::safe)
        return std::string("it takes only start, identify, reset and send_info: ") +
               obstacle(wire::NodeState::safe);
    if (order.command.code == CommandCode::identify) return "it has no light to blink";
    if (view.state() == wire::NodeState::bad_config) return obstacle(wire::NodeState::bad_config);
    if (view.sensor_count() == 0) return "it has no sensors";
    if (order.command.code == CommandCode::set_rate)
        return fmt::format(
            "{} ms is less than the timing budget and 5 ms of at least one of its sensors; sensors for which "
            "it is enough use the new rate",
            order.command.argument);
    return "the reason is unknown: look at its state, and check that no other host commands it";
}

}  // namespace octoskin::commanding
