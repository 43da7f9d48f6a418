// The board in lock-step with a simulator that plays bus and world.
#pragma once

#include <memory>

#include "host/lab/octoskin_board/bench.hpp"
#include "hw/sim/board_link/link_socket.hpp"

namespace octoskin::board {

/// Sensors that ask the simulator what they see. The socket must outlive them.
[[nodiscard]] Bench::SceneOfSensor scene_over(sim::LinkSocket& socket);

/// Until the simulator closes the socket. Throws sim::BoardLinkError.
void serve(Bench& bench, sim::LinkSocket& socket);

}  // namespace octoskin::board
