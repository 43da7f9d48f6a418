#include "host/apps/calibration/dialogue.hpp"

#include <fmt/format.h>

#include <utility>
#include <variant>

#include "common/wire/codec.hpp"
#include "host/apps/node_session/first_heartbeat.hpp"
#include "host/apps/node_session/obstacle.hpp"
#include "host/core/rig/sensor_text.hpp"

namespace octoskin::calibrating {
namespace {

using wire::CalibrationOutcome;

constexpr Nanoseconds kAnswerWithin{1'000'000'000};
constexpr Nanoseconds kEndWithin{10'000'000'000};
constexpr std::int64_t kPeriodsMax =
    130;  // 60 ranges, at worst at half the rate, and 3 periods without a range
constexpr int kAsksMax = 3;

Error error_of(CalibrationOutcome outcome) {
    switch (outcome) {
        case CalibrationOutcome::refused:
            return {
                ErrorCode::bad_argument,
                "the node refuses: another calibration is running on it, it does not range (safe mode, no "
                "valid configuration), or its rig makes it refuse all commands (refuses_commands)"};
        case CalibrationOutcome::not_brought_up:
            return {ErrorCode::no_device, "the sensor could not be initialised", "", "see its SENSOR_HEALTH"};
        case CalibrationOutcome::device_failed:
            return {ErrorCode::no_device, "the sensor failed during the calibration", "",
                    "see its SENSOR_HEALTH"};
        case CalibrationOutcome::no_result:
            return {ErrorCode::no_data, "the sensor gave no range for 2 s and for 3 of its periods"};
        case CalibrationOutcome::no_target:
            return {ErrorCode::no_data, "the sensor had no valid target in more than 10 of 50 ranges", "",
                    "is the target grey and in front of the sensor, and is the room dark?"};
        case CalibrationOutcome::out_of_range:
            return {ErrorCode::out_of_range, "the ranges are more than one metre off", "",
                    "is the target at the distance of --target-mm?"};
        case CalibrationOutcome::under_way:
        case CalibrationOutcome::done:
            break;
    }
    return {ErrorCode::unsupported, "the calibration ended with an outcome that this program does not know"};
}

}  // namespace

Dialogue::Dialogue(Question question, HostTime now)
    : question_(std::move(question)), deadline_(now + kHeartbeatWithin) {}

std::string Dialogue::whom() const {
    return sensor_text(question_.node_id, question_.node_name, question_.sensor, question_.sensor_name);
}

void Dialogue::give_up(ExitCode exit, Error error) {
    error.key = whom();
    outcome_ = fail(exit, std::move(error));
}

void Dialogue::on_frame(const wire::CanFrame& frame, HostTime now) {
    if (outcome_) return;
    const auto decoded = wire::decode(frame);
    if (!decoded) {
        if (const auto why = other_version(frame, decoded.error(), question_.node_id))
            give_up(ExitCode::bad_config, *why);
        return;
    }
    if (decoded->node_id != question_.node_id) return;
    if (const auto* heartbeat = std::get_if<wire::Heartbeat>(&decoded->message)) {
        on_heartbeat(*heartbeat, now);
    } else if (const auto* said = std::get_if<wire::Calibration>(&decoded->message)) {
        on_calibration(*said, now);
    } else if (const auto* page = std::get_if<wire::NodeInfo>(&decoded->message)) {
        const auto* fault = std::get_if<wire::InfoFault>(page);
        if (fault != nullptr && fault->kind == wire::FaultKind::commands_refused)
            give_up(ExitCode::failed, commands_refused());
    }
}

void Dialogue::on_heartbeat(const wire::Heartbeat& heartbeat, HostTime now) {
    if (auto why = obstacle(heartbeat.state)) return give_up(ExitCode::failed, std::move(*why));
    if (step_ != Step::awaiting_heartbeat) return;
    const std::uint32_t expected = question_.node_hash & 0xFFFFU;
    if (heartbeat.node_hash_low != expected) {
        return give_up(
            ExitCode::bad_config,
            {.code = ErrorCode::mismatch,
             .what = fmt::format("its configuration is not that of the rig file: expected the low half of "
                                 "node_hash to be {:04x}",
                                 expected),
             .value = fmt::format("{:04x}", heartbeat.node_hash_low),
             .remedy = "flash it first"});
    }
    ask(now);
}

/// Sends the same command each time. A node that has begun only answers again; it does not begin again.
void Dialogue::ask(HostTime now) {
    ++asks_;
    const auto code = question_.quantity == wire::CalibrationQuantity::offset
                          ? wire::CommandCode::calibrate_offset
                          : wire::CommandCode::calibrate_crosstalk;
    to_send_ = wire::encode(wire::Command{.code = code,
                                          .sensor = question_.sensor,
                                          .argument = question_.target_mm,
                                          .sequence = question_.sequence},
                            question_.node_id);
    step_ = Step::awaiting_answer;
    deadline_ = now + kAnswerWithin;
}

void Dialogue::on_calibration(const wire::Calibration& said, HostTime now) {
    const bool is_ours = said.sensor == question_.sensor && said.quantity == question_.quantity &&
                         said.sequence == question_.sequence;
    if (!is_ours || step_ == Step::awaiting_heartbeat) return;
    if (said.outcome == CalibrationOutcome::done) {
        outcome_ = said;
    } else if (said.outcome == CalibrationOutcome::under_way) {
        step_ = Step::awaiting_end;
        const auto periods = std::chrono::milliseconds(kPeriodsMax * question_.inter_measurement_ms);
        deadline_ = now + kEndWithin + periods;
    } else {
        give_up(ExitCode::failed, error_of(said.outcome));
    }
}

void Dialogue::on_time(HostTime now) {
    if (outcome_ || now < deadline_) return;
    switch (step_) {
        case Step::awaiting_heartbeat:
            return give_up(ExitCode::unavailable, no_heartbeat());
        case Step::awaiting_answer:
            if (asks_ < kAsksMax) return ask(now);
            return give_up(ExitCode::unavailable,
                           {.code = ErrorCode::no_answer,
                            .what = "the node does not answer",
                            .remedy = "its firmware may be older than the command; flash it"});
        case Step::awaiting_end:
            return give_up(ExitCode::io_failed,
                           {ErrorCode::time_limit, "the calibration began, but its result never arrived"});
    }
}

std::optional<wire::CanFrame> Dialogue::take_frame() {
    return std::exchange(to_send_, std::nullopt);
}

}  // namespace octoskin::calibrating
