// The board on a simulated CAN bus of its own process: for running it alone.
#pragma once

#include "hw/sim/can/simulated_can_bus.hpp"
#include "hw/sim/stm32g474/nucleo_board.hpp"

namespace octoskin::sim::stm32 {

/// Turn of board and bus: a frame that the board offers reaches the bus at the end of a turn.
inline constexpr std::int64_t kCanTurnUs = 50;

class BoardOnBus {
  public:
    /// Both must outlive this.
    BoardOnBus(NucleoBoard& board, SimulatedCanBus& bus);
    BoardOnBus(const BoardOnBus&) = delete;
    BoardOnBus& operator=(const BoardOnBus&) = delete;

    /// Runs both in turns; `each_turn` is called at every turn's end and may send on the bus.
    void run_until(SimTime end, const std::function<void(SimTime now)>& each_turn = {});

  private:
    NucleoBoard& board_;
    SimulatedCanBus& bus_;
    CanSeat* seat_ = nullptr;
    SimTime now_{};
};

}  // namespace octoskin::sim::stm32
