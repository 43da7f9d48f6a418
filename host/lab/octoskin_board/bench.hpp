// A board on a bench: its image, its configuration, its sensors.
#pragma once

#include <memory>

#include "common/config/node_config.hpp"
#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/lab/octoskin_board/arguments.hpp"
#include "hw/sim/stm32g474/board_on_bus.hpp"
#include "hw/sim/stm32g474/sensor_carrier.hpp"

namespace octoskin::board {

class Bench {
  public:
    using SceneOfSensor = std::function<sim::RangingScene(std::uint8_t sensor)>;
    /// Reads everything and powers the board.
    static Result<std::unique_ptr<Bench>, AppError> build(const Arguments& arguments,
                                                          const SceneOfSensor& scene);

    [[nodiscard]] sim::stm32::NucleoBoard& board() noexcept { return *board_; }
    [[nodiscard]] sim::stm32::SensorCarrier& sensors() noexcept { return *sensors_; }
    [[nodiscard]] const NodeConfig& config() const noexcept { return config_; }

  private:
    NodeConfig config_;
    std::unique_ptr<sim::stm32::NucleoBoard> board_;
    std::unique_ptr<sim::stm32::SensorCarrier> sensors_;
};

/// Each sensor faces a wall head-on at its range, metres; the list is repeated.
[[nodiscard]] Bench::SceneOfSensor wall_at(std::vector<double> range_m);

/// The violations, one per line, each with its place in the program.
[[nodiscard]] std::string violation_report(sim::stm32::NucleoBoard& board);
/// The run's duration, load and counts. `cpu_s`: CPU time of this process; wall time depends on other
/// programs.
[[nodiscard]] std::string use_report(Bench& bench, double cpu_s);

}  // namespace octoskin::board
