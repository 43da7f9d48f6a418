// What the node sends, in which order. Each message is composed when the controller takes it, so a full
// mailbox delays messages but never makes them old. Messages about one instant (readings, REFLEX,
// SYNC_REPORT) have an age limit.
#include <algorithm>
#include <bit>
#include <limits>
#include <variant>

#include "common/wire/codec.hpp"
#include "firmware/core/node.hpp"

namespace octoskin::node {

namespace {

constexpr int kFramesPerPoll = 8;

template <class To>
constexpr To saturated(std::uint32_t value) {
    return static_cast<To>(std::min<std::uint32_t>(value, std::numeric_limits<To>::max()));
}

std::uint32_t reading_count(const wire::CanFrame& frame) {
    const auto decoded = wire::decode(frame);
    if (!decoded) return 0;
    if (const auto* several = std::get_if<wire::RangeFd>(&decoded->message)) return several->count;
    return std::holds_alternative<wire::Range>(decoded->message) ? 1 : 0;
}

std::optional<std::uint8_t> reflex_sensor(const wire::CanFrame& frame) {
    const auto decoded = wire::decode(frame);
    if (!decoded) return std::nullopt;
    const auto* reflex = std::get_if<wire::Reflex>(&decoded->message);
    return reflex != nullptr ? std::optional(reflex->sensor) : std::nullopt;
}

}  // namespace

/// A frame counts as the number of its readings, so that every accepted reading is accounted for; a frame
/// without readings counts as one. If a REFLEX was given up, its event is unknown to the host: the next
/// reading may report it anew.
void Node::count_given_up() {
    for (int i = 0; i < kFramesPerPoll; ++i) {
        const auto frame = ports_.can.take_given_up();
        if (!frame) return;
        const std::uint32_t readings = reading_count(*frame);
        given_up_ += readings;
        if (readings == 0) ++others_given_up_;
        if (const auto sensor = reflex_sensor(*frame); sensor && *sensor < sensor_count_)
            reflexes_[*sensor]->rearm();
    }
}

/// Messages that are too old are dropped and counted. If a REFLEX is dropped, the next reading may begin the
/// event anew. So what is still too close when the bus is back is reported at once.
void Node::drop_late(NodeTime now) {
    queue_.drop_late(now);
    if (sync_report_ && elapsed(sync_report_->heard, now) > policy_.report_age_max) {
        sync_report_.reset();
        ++others_late_;
    }
    for (std::uint64_t due = reflex_due_; due != 0; due &= due - 1) {
        const auto sensor = static_cast<std::size_t>(std::countr_zero(due));
        if (elapsed(reflex_events_[sensor].since, now) <= policy_.report_age_max) continue;
        reflex_due_ &= ~(std::uint64_t{1} << sensor);
        reflexes_[sensor]->rearm();
        ++others_late_;
    }
}

void Node::transmit(NodeTime now) {
    tokens_.refill(now);
    reflex_tokens_.refill(now);
    drop_late(now);
    has_unsent_ = false;
    if (bus_off_.is_off()) return;  // messages are composed after the return, so that they are new
    // A node without a valid id of its own must not send.
    if (!wire::is_allowed(wire::Party::from_node, config_.node_id)) return;
    for (int i = 0; i < kFramesPerPoll; ++i) {
        if (!send_most_urgent(now)) return;
    }
    has_unsent_ = true;
}

/// In the order of the identifiers, as the bus arbitrates them.
bool Node::send_most_urgent(NodeTime now) {
    if (reflex_due_ != 0 && !own_id_heard_) {
        if (!send_reflex()) return false;
    } else if (announcer_.is_heartbeat_due()) {
        if (!send(heartbeat())) return false;
        announcer_.heartbeat_sent();
        calibration_.on_heartbeat_sent();
    } else if (sync_report_) {
        if (!send(*sync_report_)) return false;
        sync_report_.reset();
    } else if (!own_id_heard_ && queue_.is_ready(now)) {  // else they become too old, and are counted
        if (!send(queue_.front())) return false;
        queue_.pop();
    } else if (const auto sensor = announcer_.health_due()) {
        if (!send(health(*sensor))) return false;
        announcer_.health_sent(*sensor);
        note_reported(*sensor);
    } else if (const auto page = announcer_.info_page_due()) {
        if (!send(info(*page))) return false;
        announcer_.info_sent(*page);
        if (*page == wire::InfoPage::fault) note_fault_reported();
    } else if (queue_.aux()) {
        if (!send(*queue_.aux())) return false;
        queue_.pop_aux();
    } else if (const auto answer = calibration_.due()) {
        if (!send(*answer)) return false;
        calibration_.sent();
    } else if (const auto piece = black_box_.due()) {
        if (!send(*piece)) return false;
        black_box_.sent(now);
    } else {
        return false;
    }
    return true;
}

/// Whatever else was sent recently. REFLEX has as many tokens of its own as events are possible. It waits for
/// one only if something is wrong, and then cannot flood the bus.
bool Node::send_reflex() {
    const auto sensor = static_cast<std::size_t>(std::countr_zero(reflex_due_));
    wire::Reflex event = reflex_events_[sensor].message;
    event.sequence = reflex_sequence_;
    if (!reflex_tokens_.has_token() || !ports_.can.send(wire::encode(event, config_.node_id))) {
        has_unsent_ = true;
        return false;
    }
    reflex_tokens_.take();
    ++frames_sent_;
    reflex_due_ &= reflex_due_ - 1;  // clears its lowest bit, this sensor's
    reflex_sequence_ = static_cast<std::uint8_t>((reflex_sequence_ + 1U) % wire::kSequenceCount);
    return true;
}

bool Node::send(const wire::Message& message) {
    const bool goes_first = std::holds_alternative<wire::Heartbeat>(message);
    const bool has_token = goes_first ? tokens_.has_token() : tokens_.has_spare_token();
    if (!has_token || !ports_.can.send(wire::encode(message, config_.node_id))) {
        has_unsent_ = true;
        return false;
    }
    tokens_.take();
    ++frames_sent_;
    return true;
}

wire::Heartbeat Node::heartbeat() const noexcept {
    const auto all = sensors();
    const auto degraded =
        std::count_if(all.begin(), all.end(), [](const auto& sensor) { return sensor->is_degraded(); });
    const bool is_overridden = std::any_of(all.begin(), all.end(),
                                           [](const auto& sensor) { return sensor->is_period_overridden(); });
    return {.state = state(),
            .reset_cause = reset_cause_,
            .is_rate_overridden = is_overridden,
            .degraded_sensors = static_cast<std::uint8_t>(degraded),
            .uid_crc = uid_crc_,
            .node_hash_low = static_cast<std::uint16_t>(node_hash_ & 0xFFFFU)};
}

wire::NodeInfo Node::info(wire::InfoPage page) const noexcept {
    const auto uid_half = [this](std::size_t first) {
        std::array<std::uint8_t, 6> half{};
        std::copy_n(identity_.uid.begin() + static_cast<std::ptrdiff_t>(first), half.size(), half.begin());
        return half;
    };
    const NodeCounts counted = counts();
    switch (page) {
        case wire::InfoPage::uid_low:
            return wire::InfoUidLow{uid_half(0)};
        case wire::InfoPage::uid_high:
            return wire::InfoUidHigh{uid_half(6)};
        case wire::InfoPage::identity:
            return wire::InfoIdentity{.node_hash = node_hash_,
                                      .sensor_count = config_.sensor_count,
                                      .board_type = config_.board_type};
        case wire::InfoPage::build:
            return wire::InfoBuild{.build_id = identity_.build_id,
                                   .uptime_s = saturated<std::uint16_t>(uptime_ms_ / 1'000)};
        case wire::InfoPage::counters:
            return wire::InfoCounters{.i2c_errors = saturated<std::uint16_t>(counted.i2c_errors),
                                      .reads_disagreed = saturated<std::uint16_t>(counted.reads_disagreed),
                                      .sensor_restarts = saturated<std::uint16_t>(counted.sensor_restarts)};
        case wire::InfoPage::traffic:
            return wire::InfoTraffic{
                .tx_dropped =
                    saturated<std::uint16_t>(counted.displaced + counted.given_up + counted.others_given_up),
                .late_dropped = saturated<std::uint16_t>(counted.late + counted.others_late),
                .bus_off_count = saturated<std::uint8_t>(counted.bus_off),
                .rx_rejected = saturated<std::uint8_t>(counted.rx_rejected)};
        case wire::InfoPage::fault:
            return fault_to_report();
    }
    return fault_to_report();
}

wire::SensorHealth Node::health(std::uint8_t sensor) const noexcept {
    const Sensor& about = *sensors_[sensor];
    const std::int32_t error = std::clamp<std::int32_t>(about.period_error_permille(), -128, 127);
    return {.sensor = sensor,
            .state = about.state(),
            .fault = about.fault(),
            .sent = queue_.sent(sensor),
            .capture_bound_64us = bound_on_wire(bound_to_report(sensor)),
            .rejected = static_cast<std::uint8_t>(about.counts().rejected & 0xFFU),
            .period_error_permille = static_cast<std::int8_t>(error)};
}

Microseconds Node::bound_to_report(std::uint8_t sensor) const noexcept {
    const ReportedSensor& reported = reported_[sensor];
    return reported.bound_since.count() > 0 ? reported.bound_since : reported.bound;
}

void Node::note_reported(std::uint8_t sensor) noexcept {
    reported_[sensor] = {.state = sensors_[sensor]->state(),
                         .fault = sensors_[sensor]->fault(),
                         .bound = bound_to_report(sensor),
                         .bound_since = Microseconds{0}};
}

std::uint8_t Node::bound_on_wire(Microseconds bound) const noexcept {
    // A classical frame rounds the time down by up to one step of its field.
    const std::int64_t step = wire::kClassicalTimeStepUs;
    const std::int64_t rounding = config_.uses_can_fd ? 0 : step;
    return static_cast<std::uint8_t>(
        std::min<std::int64_t>((bound.count() + rounding + step - 1) / step, 255));
}

}  // namespace octoskin::node
