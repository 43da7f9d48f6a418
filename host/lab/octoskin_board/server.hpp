// Runs the board in lock-step with a simulator that models bus and world.
#pragma once

#include <memory>

#include "host/lab/octoskin_board/bench.hpp"
#include "hw/sim/board_link/link_socket.hpp"

namespace octoskin::board {

/// A scene that asks the simulator for each sensor's view. The socket must outlive them.
[[nodiscard]] Bench::SceneOfSensor scene_over(sim::LinkSocket& socket);

/// Serves until the simulator closes the socket. Throws sim::BoardLinkError.
void serve(Bench& bench, sim::LinkSocket& socket);

}  // namespace octoskin::board
