#include "host/apps/command/dialogue.hpp"

#include <fmt/format.h>

#include <utility>
#include <variant>

#include "common/wire/codec.hpp"
#include "common/wire/names.hpp"
#include "host/apps/command/effect.hpp"
#include "host/apps/node_session/first_heartbeat.hpp"
#include "host/apps/node_session/obstacle.hpp"

namespace octoskin::commanding {
namespace {

using wire::CommandCode;

/// The time for all seven pages of NODE_INFO. Unrequested, at most two pages arrive in it.
constexpr Nanoseconds kInfoWithin{300'000'000};
constexpr Nanoseconds kSentWithin{1'000'000'000};
/// A node discards after 20 ms a frame that it cannot send.
constexpr Nanoseconds kRest{100'000'000};
constexpr Nanoseconds kEffectWithin{5'000'000'000};
constexpr Nanoseconds kUptimeRetry{500'000'000};
constexpr std::uint16_t kUptimeMinS = 3;
constexpr int kUptimeWaitsMax = 8;  // the uptime of a node that keeps resetting does not grow
constexpr int kAsksMax = 3;
constexpr std::uint8_t kCountFull = 255;

Error no_sensor(std::uint8_t wanted, std::uint8_t count) {
    if (count == 0) return {ErrorCode::unknown_name, "it has no sensors", {}, "leave out --sensor"};
    return {ErrorCode::unknown_name, fmt::format("expected a sensor from 0 to {}", count - 1),
            fmt::format("{}", wanted), "give the number of one of its sensors"};
}

}  // namespace

Dialogue::Dialogue(Order order, HostTime now)
    : order_(std::move(order)), deadline_(now + kHeartbeatWithin), commanded_(now) {}

void Dialogue::give_up(ExitCode exit, Error error) {
    error.key = order_.whom();
    outcome_ = fail(exit, std::move(error));
}

void Dialogue::on_frame(const wire::CanFrame& frame, HostTime now) {
    if (outcome_) return;
    const auto decoded = wire::decode(frame);
    if (!decoded) {
        if (const auto why = other_version(frame, decoded.error(), order_.node_id))
            give_up(ExitCode::bad_config, *why);
        return;
    }
    const bool is_command = std::holds_alternative<wire::Command>(decoded->message);
    if (is_command || decoded->node_id != order_.node_id) return;
    take(decoded->message);
    const auto& fault = view_.info.fault;
    if (fault && fault->kind == wire::FaultKind::commands_refused)
        return give_up(ExitCode::failed, commands_refused());
    advance(now);
}

void Dialogue::take(const wire::Message& message) {
    if (const auto* heartbeat = std::get_if<wire::Heartbeat>(&message)) {
        view_.heartbeat = *heartbeat;
    } else if (const auto* page = std::get_if<wire::NodeInfo>(&message)) {
        view_.info.take(*page);
    } else if (const auto* health = std::get_if<wire::SensorHealth>(&message)) {
        if (health->sensor < view_.sensors.size()) view_.sensors.at(health->sensor) = *health;
    } else if (std::holds_alternative<wire::BlackBox>(message)) {
        has_sent_black_box_ = true;
    }
}

void Dialogue::advance(HostTime now) {
    switch (step_) {
        case Step::awaiting_heartbeat:
            if (view_.heartbeat) on_first_heartbeat(now);
            return;
        case Step::asking_before:
            if (view_.info.is_complete()) command(now);
            return;
        case Step::asking_after:
            if (view_.info.is_complete() && view_.heartbeat) judge(now);
            return;
        case Step::awaiting_effect:
            if (is_in_effect(order_, view_, has_sent_black_box_)) succeed();
            return;
        case Step::awaiting_uptime:
        case Step::commanding:
        case Step::awaiting_rest:
            return;
    }
}

void Dialogue::on_first_heartbeat(HostTime now) {
    if (order_.is_sensor_by_name && view_.state() == wire::NodeState::bad_config)
        return give_up(ExitCode::bad_config, *obstacle(wire::NodeState::bad_config));
    if (order_.is_sensor_by_name && !difference_text(view_, order_).empty())
        return give_up(
            ExitCode::bad_config,
            {.code = ErrorCode::mismatch,
             .what = fmt::format("its configuration is not that of the rig file, so the name may mean "
                                 "another sensor: expected the low half of node_hash to be {:04x}",
                                 order_.known->node_hash & 0xFFFFU),
             .value = fmt::format("{:04x}", view_.heartbeat->node_hash_low),
             .remedy = "flash the node, or give the sensor's number"});
    ask(Step::asking_before, now);
}

void Dialogue::ask(Step step, HostTime now) {
    step_ = step;
    asks_ = 0;
    ask_again(now);
}

/// Discards what arrived before this request.
void Dialogue::ask_again(HostTime now) {
    ++asks_;
    view_.info = {};
    send(CommandCode::send_info);
    deadline_ = now + kSentWithin;
}

/// Never the same frame twice in succession: a node treats it as a repetition.
void Dialogue::send(CommandCode code) {
    wire::Command command = order_.command;
    if (code != command.code) command = {.code = code};
    command.sequence = static_cast<std::uint8_t>(order_.command.sequence + sends_++);
    to_send_ = wire::encode(command, order_.node_id);
}

void Dialogue::on_sent(HostTime now) {
    if (step_ == Step::commanding) {
        commanded_ = now;
        step_ = Step::awaiting_rest;
        deadline_ = now + kRest;
    } else if (step_ == Step::asking_before || step_ == Step::asking_after) {
        deadline_ = now + kInfoWithin;
    }
}

void Dialogue::command(HostTime now) {
    if (order_.command.sensor != wire::kAllSensors && order_.command.sensor >= view_.sensor_count())
        return give_up(ExitCode::usage, no_sensor(order_.command.sensor, view_.sensor_count()));
    const bool is_young = view_.info.build->uptime_s < kUptimeMinS;
    if (order_.command.code == CommandCode::reset && is_young && uptime_waits_ < kUptimeWaitsMax) {
        ++uptime_waits_;
        step_ = Step::awaiting_uptime;
        deadline_ = now + kUptimeRetry;
        return;
    }
    before_ = view_;
    step_ = Step::commanding;
    send(order_.command.code);
    deadline_ = now + kSentWithin;
}

void Dialogue::judge(HostTime now) {
    if (order_.command.code == CommandCode::reset) return judge_reset(now);
    const std::uint8_t refused_before = before_.info.traffic->rx_rejected;
    if (view_.info.traffic->rx_rejected > refused_before) {
        Error error = refusal(order_, before_);
        error.what = fmt::format("it refuses {}: {}", wire::name(order_.command.code), error.what);
        return give_up(ExitCode::failed, std::move(error));
    }
    if (refused_before == kCountFull)
        return give_up(ExitCode::failed,
                       {.code = ErrorCode::limit_exceeded,
                        .what = fmt::format("whether it refused {} is unknown: its counter of refused frames "
                                            "must be below its maximum",
                                            wire::name(order_.command.code)),
                        .value = fmt::format("{}", kCountFull),
                        .remedy = "the command 'reset' restarts it"});
    step_ = Step::awaiting_effect;
    deadline_ = commanded_ + kEffectWithin;
    advance(now);
}

/// An uptime shorter than the one before means that the node has restarted.
void Dialogue::judge_reset(HostTime now) {
    if (view_.info.build->uptime_s < before_.info.build->uptime_s) return succeed();
    if (now >= commanded_ + kEffectWithin) return on_no_effect();
    step_ = Step::awaiting_rest;
    deadline_ = now + kRest;
}

void Dialogue::succeed() {
    const std::string difference = difference_text(view_, order_);
    std::string text = fmt::format("{}: {}: {}\n", order_.whom(), wire::name(order_.command.code),
                                   state_text(view_, order_));
    if (order_.command.code == CommandCode::send_info) text += info_text(view_, order_);
    if (!difference.empty()) text += "  " + difference + "\n";
    outcome_ = text;
}

void Dialogue::on_no_effect() {
    const auto why = obstacle(view_.state());
    give_up(ExitCode::failed, {.code = why ? why->code : ErrorCode::no_answer,
                               .what = fmt::format("it did not refuse {}, but 5 s later it has no effect",
                                                   wire::name(order_.command.code)),
                               .value = state_text(view_, order_),
                               .remedy = why ? why->reason() : ""});
}

void Dialogue::on_time(HostTime now) {
    if (outcome_ || now < deadline_) return;
    switch (step_) {
        case Step::awaiting_heartbeat:
            return give_up(ExitCode::unavailable, no_heartbeat());
        case Step::awaiting_uptime:
            return ask(Step::asking_before, now);
        case Step::commanding:
            return give_up(ExitCode::unavailable, {.code = ErrorCode::no_device,
                                                   .what = "the interface sent nothing for 1 s",
                                                   .remedy = "check that its bus is connected and powered"});
        case Step::awaiting_rest:
            view_ = {};
            return ask(Step::asking_after, now);
        case Step::asking_before:
            if (asks_ < kAsksMax) return ask_again(now);
            return give_up(
                ExitCode::unavailable,
                {.code = ErrorCode::no_answer,
                 .what = "its heartbeats arrive, but no answer",
                 .remedy = "check that this interface may send (not listen-only), and that this is "
                           "a sensor board: a joint source takes no commands"});
        case Step::asking_after:
            if (asks_ < kAsksMax || now < commanded_ + kEffectWithin) return ask_again(now);
            return give_up(ExitCode::io_failed,
                           {.code = ErrorCode::no_answer,
                            .what = fmt::format("silent since {}", wire::name(order_.command.code)),
                            .remedy = "wait for its light, or read its serial line"});
        case Step::awaiting_effect:
            return on_no_effect();
    }
}

std::optional<wire::CanFrame> Dialogue::take_frame() {
    return std::exchange(to_send_, std::nullopt);
}

}  // namespace octoskin::commanding
