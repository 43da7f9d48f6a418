// The flashed image on an emulated board, connected to the experiment's bus and world.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "common/config/node_config.hpp"
#include "hw/sim/board_link/board_process.hpp"
#include "hw/sim/can/simulated_can_bus.hpp"
#include "hw/sim/experiment/board_parts.hpp"
#include "hw/sim/experiment/rig_board.hpp"
#include "hw/sim/experiment/simulated_board.hpp"

namespace octoskin::sim {

/// Emulated boards in place of the node core in this process.
struct EmulatedBoards {
    std::filesystem::path program;  ///< octoskin_board
    std::filesystem::path image;    ///< the ELF to flash
    std::uint32_t cycles_per_instruction = 1;
};

class EmulatedBoard final : public RigBoard {
  public:
    /// `can` must outlive the board. Its parts are the same as those of a board in this process with the same
    /// reel. Throws BoardLinkError.
    EmulatedBoard(const EmulatedBoards& emulated, const NodeConfig& config, double drift_ppm,
                  const PartsReel& reel, SimulatedCanBus& can, const SceneOfSensor& scene);
    ~EmulatedBoard() override;

    void begin_turn(SimTime now) override;
    void finish_turn() override;
    [[nodiscard]] double i2c_busy_s(std::size_t bus) override;
    [[nodiscard]] BoardStart start() override;
    [[nodiscard]] std::string violations() override;

  private:
    [[nodiscard]] const BoardSummary& summary();
    void note(BusEventKind kind, SimTime time, const wire::CanFrame& frame);

    double drift_ppm_;
    std::filesystem::path block_;  ///< file with the configuration, while the board exists
    std::vector<RangingScene> scenes_;
    std::unique_ptr<BoardProcess> process_;
    CanSeat* seat_ = nullptr;
    std::optional<wire::CanFrame> offered_;
    bool has_reported_start_ = false;
    RunUntil turn_;
    std::optional<BoardSummary> summary_;
};

}  // namespace octoskin::sim
