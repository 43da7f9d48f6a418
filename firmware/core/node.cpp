#include "firmware/core/node.hpp"

#include <algorithm>
#include <utility>

#include "common/wire/crc.hpp"
#include "firmware/core/frame_budget.hpp"
#include "firmware/core/time_bracket.hpp"
#include "firmware/drivers/vl53l1x/timing.hpp"

namespace octoskin::node {

namespace {

constexpr Microseconds kBlinkHalfPeriod{250'000};

// A full transmit mailbox gives no event here: try again soon.
constexpr Microseconds kTransmitRetry{1'000};

/// A setting that the sensor would always refuse is not a fault of the sensor.
bool is_usable(const SensorConfig& sensor, std::size_t bus_count) noexcept {
    return sensor.bus < bus_count &&
           vl53l1x::range_timeouts(sensor.distance_mode, sensor.timing_budget_ms).has_value() &&
           vl53l1x::is_period_long_enough(sensor.timing_budget_ms, sensor.inter_measurement_ms);
}

bool is_usable(const NodeConfig& config, std::size_t bus_count, std::uint8_t board_type) noexcept {
    if (!is_valid(config) || config.board_type != board_type) return false;
    const auto sensors = std::span(config.sensors).first(config.sensor_count);
    return std::all_of(sensors.begin(), sensors.end(),
                       [=](const SensorConfig& sensor) { return is_usable(sensor, bus_count); });
}

Policy with_jitter(Policy policy, const NodeConfig& config) noexcept {
    const Microseconds spread{config.ready_jitter_us - kReadyJitterMinUs};
    policy.ready_jitter = policy.timer_jitter + (spread + Microseconds{1}) / 2;
    return policy;
}

vl53l1x::Verification verification_of(const NodeConfig& config) noexcept {
    vl53l1x::Verification verification;
    if (!config.verifies_registers) verification.switch_off();
    for (const std::uint8_t index : std::span(config.left_out).first(config.left_out_count))
        verification.leave_out(index);
    return verification;
}

vl53l1x::Options device_options(const NodeConfig& config, const vl53l1x::Verification& verification,
                                const Policy& policy) noexcept {
    vl53l1x::Options options;
    options.verification = &verification;
    options.is_io_2v8 = config.is_io_2v8;
    options.reads_twice = config.reads_twice;
    options.i2c_hz = config.i2c_hz;
    options.i2c_lateness_us = static_cast<std::uint32_t>(policy.i2c_lateness.count());
    return options;
}

NodeTime earlier(NodeTime time, const std::optional<NodeTime>& other) noexcept {
    return other ? earlier_of(time, *other) : time;
}

}  // namespace

Node::Node(const NodeConfig& config, const Identity& identity, const Ports& ports, NodeTime now,
           const Policy& policy)
    : config_(config),
      identity_(identity),
      ports_(ports),
      policy_(with_jitter(policy, config)),
      is_config_usable_(is_usable(config, ports.buses.size(), identity.board_type)),
      node_hash_(is_config_usable_ ? node_hash(config) : 0),
      uid_crc_(crc16(identity.uid)),
      phase_clock_(now),
      queue_(config.uses_can_fd, config.aux_every, policy_),
      announcer_(is_config_usable_ ? config.sensor_count : std::uint8_t{0}, policy_, now),
      tokens_(frame_budgets(config).others, now),
      reflex_tokens_(frame_budgets(config).reflex, now),
      black_box_(recorders_, policy_),
      bus_off_(policy_),
      uptime_counted_(now),
      feed_at_(now) {
    start_run(now);
}

void Node::create_sensors(NodeTime now) {
    if (!is_config_usable_) return;
    const RangingRules rules{.stream_gate = config_.stream_gate,
                             .zone_guard = Microseconds{config_.zone_guard_us},
                             .i2c_hz = config_.i2c_hz,
                             .holds_phases = config_.holds_phases};
    sensor_count_ = config_.sensor_count;
    verification_ = verification_of(config_);
    for (std::size_t i = 0; i < sensor_count_; ++i) {
        const SensorConfig& sensor = config_.sensors[i];
        const vl53l1x::Options options = device_options(config_, verification_, policy_);
        auto& recorder = recorders_[sensor.bus];
        if (!recorder) recorder.emplace(*ports_.buses[sensor.bus]);
        BusRecorder& bus = *recorder;
        auto& worker = buses_[sensor.bus];
        if (!worker) worker.emplace(bus, config_.i2c_hz, options, policy_, data_ready_hint(sensor.bus));
        const SensorSurroundings surroundings{.bus = worker->shared_bus(),
                                              .default_address = worker->default_address(),
                                              .xshut = ports_.xshut,
                                              .clock = phase_clock_};
        sensors_[i].emplace(sensor, surroundings, options, rules, policy_, now);
        worker->add(*sensors_[i]);
        reflexes_[i].emplace(sensor.reflex_below_mm, policy_);
    }
    commanded_to_range_ = (std::uint64_t{1} << sensor_count_) - 1;
}

DataReadyHint Node::data_ready_hint(std::uint8_t bus) const noexcept {
    const bool has_line = (config_.data_ready_buses >> bus & 1U) != 0;
    return {has_line ? ports_.data_ready : nullptr, bus, policy_};
}

void Node::poll(NodeTime now) {
    phase_clock_.advance(now);
    supervise_can(now);
    count_given_up();
    advance_buses(now);
    collect_readings(now);
    collect_calibration();
    note_health_changes(now);
    end_what_has_expired(now);
    blink(now);
    announcer_.update(now);
    transmit(now);
    feed_watchdog(now);
}

void Node::advance_buses(NodeTime now) {
    for (auto& bus : buses_) {
        if (bus) bus->poll(now);
    }
}

void Node::collect_readings(NodeTime now) {
    for (std::uint8_t i = 0; i < sensor_count_; ++i) {
        const auto reading = sensors_[i]->take_reading();
        if (!reading) continue;
        reported_[i].bound_since = std::max(reported_[i].bound_since, reading->capture_bound);
        ++accepted_;
        watch_reflex(i, *reading, now);
        queue_.push(i, *reading, now);
    }
}

void Node::collect_calibration() {
    if (!calibration_.is_under_way()) return;
    if (const auto result = sensors_[calibration_.sensor()]->take_calibration()) calibration_.end(*result);
}

void Node::watch_reflex(std::uint8_t sensor, const Reading& reading, NodeTime now) {
    if (!reflexes_[sensor]->begins(reading, now)) return;
    reflex_events_[sensor] = {.message = {.sensor = sensor,
                                          .zone = reading.zone,
                                          .range_mm = range_on_wire(reading),
                                          .capture = wire::classical_residue(reading.capture)},
                              .since = now};
    reflex_due_ |= std::uint64_t{1} << sensor;
}

void Node::note_health_changes(NodeTime now) {
    // Looking at every sensor in every turn would be a fifth of a busy node's work.
    const Microseconds since = elapsed(health_looked_at_, now);
    is_health_look_due_ = since.count() >= 0 && since < policy_.health_look_interval;
    if (is_health_look_due_) return;
    health_looked_at_ = now;
    // Alternating: both at once would delay a slow core for longer than a reading may wait.
    if (std::exchange(looks_at_faults_, !looks_at_faults_)) {
        learn_what_is_alike(now);
        note_fault_change();
        return;
    }
    for (std::uint8_t i = 0; i < sensor_count_; ++i) {
        if (sensors_[i]->take_failure()) black_box_.on_fault(config_.sensors[i].bus, now);
        const ReportedSensor& reported = reported_[i];
        const bool is_changed =
            sensors_[i]->state() != reported.state || sensors_[i]->fault() != reported.fault;
        // The first comparison avoids the division by the wire's step in nearly every poll.
        const bool is_bound_exceeded = reported.bound_since > reported.bound &&
                                       bound_on_wire(reported.bound_since) > bound_on_wire(reported.bound);
        if (is_changed || is_bound_exceeded) announcer_.request_health(i);
    }
}

void Node::learn_what_is_alike(NodeTime now) {
    if (!alike_.update()) return;
    for (std::uint8_t i = 0; i < sensor_count_; ++i) sensors_[i]->on_overlooking_more(now);
}

void Node::end_what_has_expired(NodeTime now) {
    count_uptime(now);
    black_box_.update(now);
    if (last_command_ && elapsed(last_command_->received, now) >= policy_.command_repeat) {
        last_command_.reset();
    }
    if (refused_command_ && elapsed(refused_command_->received, now) >= policy_.refusal_reported) {
        refused_command_.reset();
    }
    if (own_id_heard_ && elapsed(*own_id_heard_, now) >= policy_.id_conflict_clear) {
        own_id_heard_.reset();
        apply_order_to_range(now);
    }
}

void Node::blink(NodeTime now) {
    if (!identify_until_ || !is_reached(blink_at_, now)) return;
    const bool is_over = is_reached(*identify_until_, now);
    is_lit_ = !is_lit_ && !is_over;
    ports_.indicator->set(is_lit_);
    blink_at_ = now + kBlinkHalfPeriod;
    if (is_over) identify_until_.reset();
}

NodeTime Node::wake_time(NodeTime now) const {
    NodeTime wake = announcer_.next_due();
    for (const auto& bus : buses_) {
        if (bus) wake = earlier(wake, bus->wake_time());
    }
    if (is_health_look_due_) wake = earlier_of(wake, health_looked_at_ + policy_.health_look_interval);
    if (identify_until_) wake = earlier_of(wake, blink_at_);
    if (ports_.watchdog != nullptr) wake = earlier_of(wake, feed_at_);
    wake = earlier(wake, bus_off_.wake_time());
    if (bus_off_.is_off()) return later_of(wake, now);
    if (has_unsent_) {
        return later_of(earlier_of(wake, now + std::max(tokens_.wait(), kTransmitRetry)), now);
    }
    wake = earlier(wake, black_box_.wake_time(now));
    if (!own_id_heard_) wake = earlier(wake, queue_.ready_time());
    return later_of(wake, now);
}

wire::NodeState Node::state() const noexcept {
    using wire::NodeState;
    if (!is_config_usable_) return NodeState::bad_config;
    if (is_safe()) return NodeState::safe;
    if (own_id_heard_) return NodeState::id_conflict;
    const auto is_unusable = [](const auto& bus) { return !bus || bus->is_faulty(); };
    const auto is_settled = [](const auto& sensor) { return sensor->is_settled(); };
    const bool has_sensors = sensor_count_ > 0;
    if (has_sensors && std::all_of(buses_.begin(), buses_.end(), is_unusable)) return NodeState::bus_fault;
    if (has_sensors && commanded_to_range_ == 0) return NodeState::stopped;
    const auto all = sensors();
    if (!std::all_of(all.begin(), all.end(), is_settled)) return NodeState::starting;
    const bool is_can_well = can_state_ == CanState::active && !bus_off_.is_recent();
    return is_can_well ? NodeState::ranging : NodeState::can_fault;
}

std::uint8_t Node::ignored_data_ready() const noexcept {
    std::uint8_t ignored = 0;
    for (std::size_t i = 0; i < buses_.size(); ++i) {
        if (buses_[i] && buses_[i]->hint().is_ignored()) ignored |= static_cast<std::uint8_t>(1U << i);
    }
    return ignored;
}

NodeCounts Node::counts() const noexcept {
    NodeCounts counts{.displaced = queue_.losses().displaced,
                      .late = queue_.losses().late,
                      .others_late = others_late_,
                      .given_up = given_up_,
                      .others_given_up = others_given_up_,
                      .bus_off = bus_off_.count(),
                      .accepted = accepted_,
                      .frames_sent = frames_sent_,
                      .rx_rejected = rx_rejected_};
    for (const auto& bus : buses_) {
        if (bus) counts.spurious_hints += bus->hint().spurious_count();
    }
    for (const auto& sensor : sensors()) {
        const SensorCounts& own = sensor->counts();
        counts.i2c_errors += sensor->i2c_error_count();
        counts.rejected += own.rejected;
        counts.reads_disagreed += own.reads_disagreed;
        counts.undated += own.undated;
        counts.withheld += own.withheld;
        counts.suspect += own.suspect;
        counts.sensor_restarts += own.restarts;
        counts.boots_late += sensor->was_boot_late() ? 1U : 0U;
    }
    return counts;
}

}  // namespace octoskin::node
