// One sensor board in the simulation: the real node core with simulated sensors on simulated buses.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "common/config/node_config.hpp"
#include "firmware/core/node.hpp"
#include "hw/sim/can/simulated_can_bus.hpp"
#include "hw/sim/clock.hpp"
#include "hw/sim/data_ready/simulated_data_ready_lines.hpp"
#include "hw/sim/experiment/board_parts.hpp"
#include "hw/sim/experiment/rig_board.hpp"
#include "hw/sim/i2c/simulated_i2c_bus.hpp"
#include "hw/sim/vl53l1x/sensor_model.hpp"

namespace octoskin::sim {

/// The scene that the sensor with this local index looks at.
using SceneOfSensor = std::function<RangingScene(std::uint8_t sensor)>;

/// Period of the board's loop. The flashed image on the emulated board (hw/sim/stm32g474) needs about this
/// time from the end of a transfer to the next START.
inline constexpr Microseconds kLoopTurn{12};

class SimulatedBoard final : public RigBoard, private node::XshutLines {
  public:
    /// `can` must outlive the board. Each sensor's constants are a function of `reel`, node and sensor.
    /// Nothing happens before the start's first turn.
    SimulatedBoard(const NodeConfig& config, const BoardStart& start, const PartsReel& reel,
                   SimulatedCanBus& can, const SceneOfSensor& scene);

    void begin_turn(SimTime now) override;
    void finish_turn() override {}
    [[nodiscard]] double i2c_busy_s(std::size_t bus) override;
    [[nodiscard]] BoardStart start() override { return start_; }
    [[nodiscard]] SensorModel& sensor(std::size_t index) { return *sensors_.at(index); }
    [[nodiscard]] SimulatedI2cBus& bus(std::size_t index) { return *buses_.at(index); }
    [[nodiscard]] const node::Node& node() const noexcept { return *node_; }

  private:
    struct Received {
        wire::CanFrame frame;
        SimTime end;
    };

    void turn(SimTime time);
    [[nodiscard]] SimTime next_event() const;
    void set(std::uint8_t line, bool is_high) override;

    NodeConfig config_;
    BoardStart start_;
    Present present_;  ///< the board's own time, which advances from event to event
    SimTime turn_began_;
    std::deque<Received> received_;
    node::Identity identity_;
    node::CanTransmitter* transmitter_ = nullptr;
    std::vector<std::unique_ptr<SensorModel>> sensors_;
    std::vector<std::unique_ptr<SimulatedI2cBus>> buses_;
    std::vector<i2c::Bus*> bus_pointers_;
    SimulatedDataReadyLines data_ready_;
    std::unique_ptr<node::Node> node_;
};

}  // namespace octoskin::sim
