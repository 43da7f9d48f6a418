// How the node handles received frames.
#include <algorithm>

#include "common/wire/codec.hpp"
#include "firmware/core/node.hpp"

namespace octoskin::node {

namespace {

// The clock wraps after 71 minutes; comparisons hold over half of that.
constexpr std::uint16_t kIdentifySecondsMax = 1'800;

}  // namespace

void Node::on_frame(const wire::CanFrame& frame, NodeTime received) {
    if (!is_for_us(frame)) return;
    const auto decoded = wire::decode(frame);
    if (!decoded) {
        ++rx_rejected_;
        return;
    }
    if (const auto* sync = std::get_if<wire::Sync>(&decoded->message)) {
        if (is_safe()) return;
        // Answered at once, not after FOLLOW_UP: the recorded time is the node's own, and a lost frame costs
        // less.
        sync_report_ = wire::SyncReport{.sequence = sync->sequence, .heard = received};
    } else if (const auto* command = std::get_if<wire::Command>(&decoded->message)) {
        on_command(*command, received);
    } else {
        on_own_id_heard(received);
    }
}

/// SYNC, commands to this node or to all, and frames that another node sends under this node's id. All other
/// frames are not even decoded.
bool Node::is_for_us(const wire::CanFrame& frame) const noexcept {
    if (frame.is_extended || frame.is_error) return false;
    const wire::FrameSpec* spec = wire::frame_spec(wire::type_of(frame.can_id));
    if (spec == nullptr) return false;
    const wire::NodeId id = wire::node_of(frame.can_id);
    switch (spec->party) {
        case wire::Party::from_host:
            return spec->type == wire::FrameType::sync && id == wire::kHostId;
        case wire::Party::from_node:
            return id == config_.node_id;
        case wire::Party::to_node:
            return id == config_.node_id || id == wire::kBroadcastId;
    }
    return false;
}

void Node::on_own_id_heard(NodeTime now) {
    const bool is_news = !own_id_heard_;
    own_id_heard_ = now;
    if (is_news) apply_order_to_range(now);
}

void Node::apply_order_to_range(NodeTime now) {
    for (std::uint8_t i = 0; i < sensor_count_; ++i) {
        const bool is_commanded = ((commanded_to_range_ >> i) & 1U) != 0;
        if (is_commanded && !own_id_heard_) {
            sensors_[i]->order_start(now);
        } else {
            sensors_[i]->order_stop(now);
        }
    }
}

void Node::on_command(const wire::Command& command, NodeTime now) {
    if (last_command_ && last_command_->command == command) return;  // the same frame repeated
    last_command_ = {.command = command, .received = now};
    if (config_.refuses_commands) return refuse(command, now);
    const bool is_done = is_safe() ? perform_in_safe_mode(command, now) : perform(command, now);
    if (!is_done) ++rx_rejected_;
}

/// The rig requires it: a device on the bus must not be able to stop a sensor. NODE_INFO reports the refusal.
/// A calibration command is answered like one that cannot be started. At most ten answers a second are sent,
/// however many commands arrive.
void Node::refuse(const wire::Command& command, NodeTime now) {
    ++rx_rejected_;
    if (refused_command_) {
        refused_command_->received = now;
    } else {
        refused_command_ = {.command = command, .received = now};
    }
    is_refusal_unreported_ = true;
    const bool is_calibration = command.code == wire::CommandCode::calibrate_offset ||
                                command.code == wire::CommandCode::calibrate_crosstalk;
    if (is_calibration && command.sensor != wire::kAllSensors) calibration_.refuse(command);
}

/// The commands of safe mode: start, identify, send_info and reset.
bool Node::perform_in_safe_mode(const wire::Command& command, NodeTime now) {
    switch (command.code) {
        case wire::CommandCode::start:
            leave_safe_mode(RunMode::normal, now);
            return true;
        case wire::CommandCode::identify:
        case wire::CommandCode::reset:
        case wire::CommandCode::send_info:
            return perform(command, now);
        case wire::CommandCode::stop:
        case wire::CommandCode::set_rate:
        case wire::CommandCode::reinitialise_sensor:
        case wire::CommandCode::send_black_box:
            return false;
        case wire::CommandCode::calibrate_offset:
        case wire::CommandCode::calibrate_crosstalk:
            return perform(command, now);  // refuses it: no sensor is at work
    }
    return false;
}

bool Node::perform(const wire::Command& command, NodeTime now) {
    const Selection selection = selected(command.sensor);
    switch (command.code) {
        case wire::CommandCode::start:
            commanded_to_range_ |= mask_of(selection);
            apply_order_to_range(now);
            return !selection.is_empty();
        case wire::CommandCode::stop:
            commanded_to_range_ &= ~mask_of(selection);
            apply_order_to_range(now);
            return !selection.is_empty();
        case wire::CommandCode::set_rate:
            return set_rate(selection, command.argument, now);
        case wire::CommandCode::reinitialise_sensor:
            for (std::uint8_t i = selection.first; i < selection.end; ++i) {
                sensors_[i]->order_reinitialise(now);
            }
            return !selection.is_empty();
        case wire::CommandCode::identify:
            if (ports_.indicator == nullptr) return false;
            identify_until_ = now + Microseconds{1'000'000} * std::min(command.argument, kIdentifySecondsMax);
            blink_at_ = now;
            return true;
        case wire::CommandCode::reset:
            is_reset_requested_ = true;
            return true;
        case wire::CommandCode::send_info:
            announcer_.request_all();
            return true;
        case wire::CommandCode::send_black_box:
            return request_black_box(selection, now);
        case wire::CommandCode::calibrate_offset:
        case wire::CommandCode::calibrate_crosstalk:
            return calibrate(command, now);
    }
    return false;
}

/// One sensor at a time: a person holds the target.
bool Node::calibrate(const wire::Command& command, NodeTime now) {
    if (command.sensor == wire::kAllSensors) return false;
    if (calibration_.answers_again(command)) return true;
    const bool is_possible = !own_id_heard_ && command.sensor < sensor_count_ &&
                             !calibration_.is_under_way() &&
                             sensors_[command.sensor]->order_calibration(order_of(command), now);
    if (is_possible) {
        calibration_.accept(command);
    } else {
        calibration_.refuse(command);
    }
    return is_possible;
}

bool Node::request_black_box(const Selection& selection, NodeTime now) {
    for (std::uint8_t i = selection.first; i < selection.end; ++i) {
        black_box_.on_request(config_.sensors[i].bus, now);
    }
    return !selection.is_empty();
}

/// Each sensor checks whether the period fits its budget. The command counts as refused unless all of them
/// can follow.
bool Node::set_rate(const Selection& selection, std::uint16_t period_ms, NodeTime now) {
    const std::optional<Microseconds> period =
        period_ms == 0 ? std::nullopt : std::optional(Microseconds{std::int64_t{period_ms} * 1'000});
    bool is_followed = !selection.is_empty();
    for (std::uint8_t i = selection.first; i < selection.end; ++i) {
        if (!sensors_[i]->order_period(period, now)) is_followed = false;
    }
    return is_followed;
}

Node::Selection Node::selected(std::uint8_t sensor) const noexcept {
    if (sensor == wire::kAllSensors) return {.first = 0, .end = sensor_count_};
    if (sensor >= sensor_count_) return {};
    return {.first = sensor, .end = static_cast<std::uint8_t>(sensor + 1U)};
}

std::uint64_t Node::mask_of(const Selection& selection) noexcept {
    return (std::uint64_t{1} << selection.end) - (std::uint64_t{1} << selection.first);
}

}  // namespace octoskin::node
