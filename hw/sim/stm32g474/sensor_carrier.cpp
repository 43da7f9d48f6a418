#include "hw/sim/stm32g474/sensor_carrier.hpp"

namespace octoskin::sim::stm32 {

SensorCarrier::SensorCarrier(NucleoBoard& board, const NodeConfig& config,
                             const std::vector<SensorPart>& parts,
                             const std::function<RangingScene(std::uint8_t sensor)>& scene)
    : config_(config) {
    for (std::uint8_t index = 0; index < config.sensor_count; ++index) {
        sensors_.push_back(std::make_unique<SensorModel>(parts.at(index), scene(index)));
        board.wire(config.sensors.at(index).bus).attach(*sensors_.back());
        board.data_ready(config.sensors.at(index).bus).attach(*sensors_.back());
        sensors_.back()->set_xshut(board.is_xshut_high(config.sensors.at(index).xshut_line), board.now());
    }
    board.on_xshut([this, &board](std::uint32_t output, bool is_high) {
        for (std::size_t index = 0; index < sensors_.size(); ++index) {
            if (config_.sensors.at(index).xshut_line == output)
                sensors_[index]->set_xshut(is_high, board.now());
        }
    });
}

}  // namespace octoskin::sim::stm32
