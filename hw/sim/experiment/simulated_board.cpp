#include "hw/sim/experiment/simulated_board.hpp"

#include <random>

namespace octoskin::sim {
namespace {

constexpr std::uint32_t kSimulatedBuildId = 0x51ABED00;

// Parts as they come off the reel: oscillator calibration 36 or 37, the slow oscillator 4..9 % fast, the
// optical centre off by up to 2 SPADs, boot within the datasheet's 1.2 ms.
SensorPart draw_part(std::mt19937_64& random) {
    // Plain arithmetic instead of <random>'s distributions, whose results differ between standard libraries.
    const auto uniform = [&random](std::uint32_t count) {
        return static_cast<std::uint32_t>(random() % count);
    };
    SensorPart part;
    part.osc_calibrate = static_cast<std::uint16_t>(36U + uniform(2));
    part.slow_clock_factor = 1.04 + 0.05 * uniform(1001) / 1000.0;
    part.optical_centre_spad = static_cast<std::uint8_t>(199U - 2U + uniform(5));
    part.boot_time = Microseconds{600 + uniform(601)};
    return part;
}

node::Identity identity_of(std::uint8_t board_type, std::mt19937_64& random) {
    node::Identity identity{.build_id = kSimulatedBuildId, .board_type = board_type};
    for (std::uint8_t& byte : identity.uid) byte = static_cast<std::uint8_t>(random() & 0xFFU);
    return identity;
}

}  // namespace

SimulatedBoard::SimulatedBoard(const NodeConfig& config, NodeClock clock, std::uint64_t seed,
                               const Present& present, SimulatedCanBus& can, const SceneOfSensor& scene)
    : config_(config), clock_(clock), present_(present) {
    std::mt19937_64 random(seed * 64 + config.node_id);
    for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus) {
        buses_.push_back(std::make_unique<SimulatedI2cBus>(present, config.i2c_hz));
        bus_pointers_.push_back(buses_.back().get());
    }
    for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
        sensors_.push_back(std::make_unique<SensorModel>(draw_part(random), scene(sensor)));
        buses_.at(config.sensors.at(sensor).bus)->attach(*sensors_.back());
    }
    node::CanTransmitter& transmitter = can.attach(
        [this](const wire::CanFrame& frame, SimTime end) { node_->on_frame(frame, clock_.to_node(end)); });
    const node::Ports ports{.buses = bus_pointers_, .xshut = *this, .can = transmitter};
    node_ = std::make_unique<node::Node>(config_, identity_of(config.board_type, random), ports,
                                         clock_.to_node(present.time));
}

void SimulatedBoard::poll() {
    node_->poll(clock_.to_node(present_.time));
}

void SimulatedBoard::set(std::uint8_t line, bool is_high) {
    for (std::size_t sensor = 0; sensor < sensors_.size(); ++sensor) {
        if (config_.sensors.at(sensor).xshut_line == line)
            sensors_[sensor]->set_xshut(is_high, present_.time);
    }
}

}  // namespace octoskin::sim
