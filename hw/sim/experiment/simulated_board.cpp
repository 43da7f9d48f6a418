#include "hw/sim/experiment/simulated_board.hpp"

#include "hw/sim/experiment/board_parts.hpp"

namespace octoskin::sim {
namespace {

constexpr std::uint32_t kSimulatedBuildId = 0x51ABED00;

}  // namespace

SimulatedBoard::SimulatedBoard(const NodeConfig& config, NodeClock clock, std::uint64_t seed,
                               const Present& present, SimulatedCanBus& can, const SceneOfSensor& scene,
                               SimTime starts_at)
    : config_(config), clock_(clock), present_(present), starts_at_(starts_at) {
    const BoardParts parts = draw_board_parts(seed, config);
    identity_ = {.uid = parts.unique_id, .build_id = kSimulatedBuildId, .board_type = config.board_type};
    for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus) {
        buses_.push_back(std::make_unique<SimulatedI2cBus>(present, config.i2c_hz));
        bus_pointers_.push_back(buses_.back().get());
    }
    for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
        sensors_.push_back(std::make_unique<SensorModel>(parts.sensors.at(sensor), scene(sensor)));
        buses_.at(config.sensors.at(sensor).bus)->attach(*sensors_.back());
        data_ready_.line(config.sensors.at(sensor).bus).attach(*sensors_.back());
    }
    transmitter_ = &can.attach([this](const wire::CanFrame& frame, SimTime end) {
        if (node_) node_->on_frame(frame, clock_.to_node(end));
    });
    if (starts_at_ <= present.time) start();
}

void SimulatedBoard::start() {
    const node::Ports ports{
        .buses = bus_pointers_, .xshut = *this, .can = *transmitter_, .data_ready = &data_ready_};
    node_ = std::make_unique<node::Node>(config_, identity_, ports, clock_.to_node(present_.time));
}

void SimulatedBoard::poll() {
    if (present_.time < starts_at_) return;
    if (!node_) start();
    if (config_.data_ready_buses != 0) data_ready_.look(present_.time);
    node_->poll(clock_.to_node(present_.time));
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
