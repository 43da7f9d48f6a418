#include "tests/support/node_rig.hpp"

#include <algorithm>
#include <stdexcept>

#include "firmware/core/transmit_places.hpp"

namespace octoskin::test {

namespace {

constexpr std::uint32_t kFirstDistanceMm = 200;
// The range of each mode without phase wrapping, with a margin.
constexpr std::uint32_t kLongDistancesMm = 4'200;
constexpr std::uint32_t kShortDistancesMm = 1'100;
constexpr std::int64_t kTakenBackAfterUs = 20'000;

node::Identity identity(wire::ResetCause cause, std::uint8_t board_type) {
    return {.uid = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12},
            .build_id = 0x1234ABCD,
            .board_type = board_type,
            .reset_cause = cause};
}

}  // namespace

NodeConfig fleet_config(std::uint8_t count, std::uint8_t buses) {
    NodeConfig config;
    config.node_id = 5;
    config.sensor_count = count;
    for (std::uint8_t i = 0; i < count; ++i) {
        SensorConfig& sensor = config.sensors[i];
        sensor.bus = static_cast<std::uint8_t>(i % buses);
        sensor.xshut_line = i;
        sensor.address = static_cast<std::uint8_t>(0x30 + i);
        sensor.phase_us = static_cast<std::uint16_t>(33'000 / count * i);
    }
    return config;
}

NodeRig::Distances NodeRig::distances_of(std::size_t sensor) const {
    const bool is_long =
        sensor < config_.sensor_count && config_.sensors[sensor].distance_mode == DistanceMode::long_range;
    const std::uint32_t step_mm = config_.sensor_count + 1U;  // and the stray one
    return {.first_mm = kFirstDistanceMm + static_cast<std::uint32_t>(sensor),
            .step_mm = step_mm,
            .count = (is_long ? kLongDistancesMm : kShortDistancesMm) / step_mm};
}

NodeRig::FittedSensor::FittedSensor(const SensorSetup& setup, const Distances& distances)
    : model(setup.part, [this, distances, target = setup.target](std::uint32_t, sim::SimTime middle,
                                                                 const Roi& roi) {
          const auto index = static_cast<std::uint32_t>(truth.size()) % distances.count;
          const auto range_mm = static_cast<std::uint16_t>(distances.first_mm + distances.step_mm * index);
          truth.push_back({.range_mm = range_mm, .window_middle = middle, .roi = roi});
          if (target) return *target;
          return sim::RangingReturn{
              .range_m = range_mm * 1e-3, .sigma_m = 0.005, .peak_signal_mcps = 10.0, .ambient_mcps = 0.5};
      }) {
    model.set_faults(setup.faults);
}

NodeRig::NodeRig(const NodeConfig& config, const std::vector<SensorSetup>& setups, sim::NodeClock clock,
                 const node::Policy& policy, std::uint8_t board_type)
    : config_(config),
      policy_(policy),
      board_type_(board_type),
      clock_(clock),
      can_({.nominal = config.nominal_bitrate, .data = config.data_bitrate}) {
    for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus) {
        buses_.emplace_back(present_, config.i2c_hz);
        bus_pointers_.push_back(&buses_.back());
    }
    for (std::size_t i = 0; i < config.sensor_count; ++i) {
        sensors_.push_back(std::make_unique<FittedSensor>(setups.at(i), distances_of(i)));
        if (!setups[i].is_fitted) continue;
        buses_.at(config.sensors[i].bus).attach(sensors_.back()->model);
        data_ready_.line(config.sensors[i].bus).attach(sensors_.back()->model);
    }
    can_.tap([this](const wire::CanFrame& frame, sim::SimTime end) { record(frame, end); });
    controller_ = &can_.attach_node([this](const wire::CanFrame& frame, sim::SimTime end) {
        if (node_) node_->on_frame(frame, clock_.to_node(end));
    });
    host_ = &can_.attach({}, 64);
    start_node(wire::ResetCause::pin);
}

void NodeRig::start_node(wire::ResetCause cause) {
    const node::Ports ports{.buses = bus_pointers_,
                            .xshut = *this,
                            .can = *this,
                            .data_ready = &data_ready_,
                            .indicator = this,
                            .watchdog = this,
                            .kept = &kept_};
    node_ = std::make_unique<node::Node>(config_, identity(cause, board_type_), ports, node_now(), policy_);
}

void NodeRig::reset(const Reset& reset) {
    can_.advance(present_.time);
    controller_->discard();
    while (controller_->take_given_up()) {
    }
    unacknowledged_.clear();
    for (sim::SimulatedI2cBus& bus : buses_) bus.abandon();
    node_.reset();
    if (!reset.is_xshut_kept) {
        for (std::uint8_t i = 0; i < config_.sensor_count; ++i) set(config_.sensors[i].xshut_line, false);
    }
    const sim::SimTime end{present_.time.us + reset.takes.count()};
    can_.advance(end);
    present_.time = end;
    start_node(reset.cause);
}

void NodeRig::hang_for(Microseconds duration) {
    present_.time.us += duration.count();
    can_.advance(present_.time);
}

void NodeRig::set(std::uint8_t line, bool is_high) {
    xshut_events_.push_back({.line = line, .is_high = is_high, .time = present_.time});
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        if (config_.sensors[i].xshut_line == line) sensors_[i]->model.set_xshut(is_high, present_.time);
    }
}

void NodeRig::attach_stray_sensor(std::size_t bus, const sim::SensorFaults& faults) {
    stray_ = std::make_unique<FittedSensor>(SensorSetup{.part = {}, .faults = faults},
                                            distances_of(config_.sensor_count));
    stray_->model.set_xshut(true, present_.time);
    buses_.at(bus).attach(stray_->model);
}

bool NodeRig::send(const wire::CanFrame& frame) {
    if (!is_alone_) return !is_transmission_blocked_ && controller_->send(frame);
    std::vector<std::uint32_t> waiting;
    for (const Unacknowledged& other : unacknowledged_) waiting.push_back(other.frame.can_id);
    if (!node::may_join(waiting, frame.can_id)) return false;
    unacknowledged_.push_back({.frame = frame, .given = present_.time});
    return true;
}

void NodeRig::leave_unacknowledged(bool is_alone) {
    is_alone_ = is_alone;
    for (const Unacknowledged& waiting : unacknowledged_) {
        if (!controller_->send(waiting.frame)) throw std::runtime_error("the mailboxes were not empty");
    }
    unacknowledged_.clear();
}

void NodeRig::discard() {
    controller_->discard();
    for (Unacknowledged& waiting : unacknowledged_) waiting.given.us -= kTakenBackAfterUs;
}

std::optional<wire::CanFrame> NodeRig::take_given_up() {
    if (auto given_up = controller_->take_given_up()) return given_up;
    if (unacknowledged_.empty()) return std::nullopt;
    const Unacknowledged oldest = unacknowledged_.front();
    if (present_.time.us - oldest.given.us < kTakenBackAfterUs) return std::nullopt;
    unacknowledged_.pop_front();
    return oldest.frame;
}

void NodeRig::turn() {
    can_.advance(present_.time);
    if (config_.data_ready_buses != 0) data_ready_.look(present_.time);
    node_->poll(node_now());
    ++poll_count_;
}

void NodeRig::run_for(Microseconds duration) {
    const sim::SimTime end{present_.time.us + duration.count()};
    while (present_.time < end) {
        turn();
        present_.time = std::min(next_event(), end);
    }
}

sim::SimTime NodeRig::next_event() const {
    const Microseconds wait = elapsed(node_now(), node_->wake_time(node_now()));
    sim::SimTime next{present_.time.us + wait.count()};
    for (const sim::SimulatedI2cBus& bus : buses_) {
        if (const auto end = bus.transfer_end()) next = std::min(next, *end);
    }
    if (config_.data_ready_buses != 0) {
        if (const auto change = data_ready_.next_change(present_.time)) next = std::min(next, *change);
    }
    if (const auto event = can_.next_event()) next = std::min(next, *event);
    // An action that is due now happens in the next microsecond: no board's loop is faster.
    return std::max(next, sim::SimTime{present_.time.us + 1});
}

void NodeRig::run_in_steps_for(Microseconds duration, Microseconds step) {
    const sim::SimTime end{present_.time.us + duration.count()};
    while (present_.time < end) {
        turn();
        present_.time.us += step.count();
    }
}

void NodeRig::send_from_host(const wire::Message& message, wire::NodeId id) {
    send_from_host(wire::encode(message, id));
}

void NodeRig::send_from_host(const wire::CanFrame& frame) {
    can_.advance(present_.time);
    if (!host_->send(frame)) throw std::runtime_error("the test's own mailboxes are full");
}

void NodeRig::record(const wire::CanFrame& frame, sim::SimTime end) {
    frames_.push_back(frame);
    const auto decoded = wire::decode(frame);
    if (!decoded) {
        ++undecodable_count_;
        return;
    }
    said_.push_back({.message = decoded->message, .end = end});
}

std::vector<SaidReading> NodeRig::readings_of(std::uint8_t sensor) const {
    std::vector<SaidReading> readings;
    for (const SaidMessage& item : said_) {
        if (const auto* classical = std::get_if<wire::Range>(&item.message)) {
            if (classical->reading.sensor == sensor) readings.push_back({classical->reading, item.end});
        } else if (const auto* fd = std::get_if<wire::RangeFd>(&item.message)) {
            for (std::uint8_t i = 0; i < fd->count; ++i) {
                const wire::RangeReading& reading = fd->entries[i].reading;
                if (reading.sensor == sensor) readings.push_back({reading, item.end});
            }
        }
    }
    return readings;
}

std::optional<wire::SensorHealth> NodeRig::last_health(std::uint8_t sensor) const {
    std::optional<wire::SensorHealth> last;
    for (const SaidMessage& item : said_) {
        const auto* health = std::get_if<wire::SensorHealth>(&item.message);
        if (health != nullptr && health->sensor == sensor) last = *health;
    }
    return last;
}

}  // namespace octoskin::test
