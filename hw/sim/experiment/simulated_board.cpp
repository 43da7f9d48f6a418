#include "hw/sim/experiment/simulated_board.hpp"

#include <algorithm>

namespace octoskin::sim {
namespace {

constexpr std::uint32_t kSimulatedBuildId = 0x51ABED00;

/// The board's controller never exceeds the nominal rate, for any filter and edges. With typical ones each
/// bit takes this much longer than its nominal time (RM0440, I2C_TIMINGR; typical edges as on the emulated
/// board).
std::uint32_t true_rate_hz(std::uint32_t nominal_hz) {
    constexpr double kLongerBitUs = 0.246;
    return static_cast<std::uint32_t>(1e6 / (1e6 / nominal_hz + kLongerBitUs));
}

}  // namespace

SimulatedBoard::SimulatedBoard(const NodeConfig& config, const BoardStart& start, const PartsReel& reel,
                               SimulatedCanBus& can, const SceneOfSensor& scene)
    : config_(config), start_(start), present_{start.first_turn}, turn_began_(start.first_turn) {
    const BoardParts parts = draw_board_parts(reel, config);
    identity_ = {.uid = parts.unique_id, .build_id = kSimulatedBuildId, .board_type = config.board_type};
    for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus) {
        buses_.push_back(std::make_unique<SimulatedI2cBus>(present_, true_rate_hz(config.i2c_hz)));
        bus_pointers_.push_back(buses_.back().get());
    }
    for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
        sensors_.push_back(std::make_unique<SensorModel>(parts.sensors.at(sensor), scene(sensor)));
        buses_.at(config.sensors.at(sensor).bus)->attach(*sensors_.back());
        data_ready_.line(config.sensors.at(sensor).bus).attach(*sensors_.back());
    }
    transmitter_ = &can.attach_node([this](const wire::CanFrame& frame, SimTime end) {
        if (end >= start_.first_turn) received_.push_back({frame, end});
    });
    const node::Ports ports{
        .buses = bus_pointers_, .xshut = *this, .can = *transmitter_, .data_ready = &data_ready_};
    node_ = std::make_unique<node::Node>(config_, identity_, ports, start_.clock.to_node(present_.time));
}

/// Runs from event to event, and polls the CAN controller's mailboxes at the end.
void SimulatedBoard::begin_turn(SimTime now) {
    if (now < start_.first_turn) return;
    for (SimTime next = next_event(); next < now; next = next_event()) turn(next);
    if (present_.time <= now) turn(now);
}

/// A turn starts its transfers at its end.
void SimulatedBoard::turn(SimTime time) {
    turn_began_ = time;
    present_.time.us = time.us + kLoopTurn.count();
    for (; !received_.empty() && received_.front().end <= time; received_.pop_front())
        node_->on_frame(received_.front().frame, start_.clock.to_node(received_.front().end));
    if (config_.data_ready_buses != 0) data_ready_.look(present_.time);
    node_->poll(start_.clock.to_node(time));
}

SimTime SimulatedBoard::next_event() const {
    const NodeTime node_now = start_.clock.to_node(turn_began_);
    SimTime next{turn_began_.us + elapsed(node_now, node_->wake_time(node_now)).count()};
    for (const auto& bus : buses_) {
        if (const auto end = bus->transfer_end()) next = std::min(next, *end);
    }
    if (config_.data_ready_buses != 0) {
        if (const auto change = data_ready_.next_change(turn_began_)) next = std::min(next, *change);
    }
    if (!received_.empty()) next = std::min(next, received_.front().end);
    return std::max(next, present_.time);
}

double SimulatedBoard::i2c_busy_s(std::size_t bus) {
    return static_cast<double>(buses_.at(bus)->busy_time().count()) * 1e-6;
}

void SimulatedBoard::set(std::uint8_t line, bool is_high) {
    for (std::size_t sensor = 0; sensor < sensors_.size(); ++sensor) {
        if (config_.sensors.at(sensor).xshut_line == line)
            sensors_[sensor]->set_xshut(is_high, present_.time);
    }
}

}  // namespace octoskin::sim
