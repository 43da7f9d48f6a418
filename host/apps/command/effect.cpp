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

Error refusal(const Order& order, const NodeView& view) {
    if (view.state() == wire::NodeState::safe) {
        Error error = *obstacle(wire::NodeState::safe);
        error.what = "it takes only start, identify, reset and send_info: " + error.what;
        return error;
    }
    if (order.command.code == CommandCode::identify)
        return {ErrorCode::unsupported, "it has no light to blink"};
    if (view.state() == wire::NodeState::bad_config) return *obstacle(wire::NodeState::bad_config);
    if (view.sensor_count() == 0) return {ErrorCode::no_content, "it has no sensors"};
    if (order.command.code == CommandCode::set_rate)
        return {.code = ErrorCode::out_of_range,
                .what = "expected at least the timing budget and 5 ms of each of its sensors",
                .value = fmt::format("{} ms", order.command.argument),
                .remedy = "give a longer --period-ms",
                .others = "Sensors for which it is enough use the new rate"};
    return {.code = ErrorCode::conflict,
            .what = "the reason is unknown",
            .remedy = "look at its state, and check that no other host commands it"};
}

}  // namespace octoskin::commanding
