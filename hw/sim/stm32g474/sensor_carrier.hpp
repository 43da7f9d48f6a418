// The board's sensors: register-level models on its four buses, their XSHUT pins on the board's lines, their
// GPIO1 pins on the bus's data-ready line.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "common/config/node_config.hpp"
#include "hw/sim/stm32g474/nucleo_board.hpp"
#include "hw/sim/vl53l1x/sensor_model.hpp"

namespace octoskin::sim::stm32 {

class SensorCarrier {
  public:
    /// `parts`: one per sensor. `board` must outlive the carrier. `scene` returns each sensor's scene.
    SensorCarrier(NucleoBoard& board, const NodeConfig& config, const std::vector<SensorPart>& parts,
                  const std::function<RangingScene(std::uint8_t sensor)>& scene);
    SensorCarrier(const SensorCarrier&) = delete;
    SensorCarrier& operator=(const SensorCarrier&) = delete;

    [[nodiscard]] SensorModel& sensor(std::size_t index) { return *sensors_.at(index); }
    [[nodiscard]] std::size_t size() const noexcept { return sensors_.size(); }

  private:
    NodeConfig config_;
    std::vector<std::unique_ptr<SensorModel>> sensors_;
};

}  // namespace octoskin::sim::stm32
