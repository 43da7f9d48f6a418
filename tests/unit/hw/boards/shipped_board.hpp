// The one board that ships.
#pragma once

#include <stdexcept>

#include "hw/rigfile/board_hardware.hpp"

namespace octoskin::rig {

inline BoardHardware nucleo() {
    auto board = read_board_hardware(OCTOSKIN_SOURCE_DIR "/hw/boards/nucleo_g474re.hardware.yaml");
    if (!board) throw std::runtime_error(board.error().message());
    return *board;
}

}  // namespace octoskin::rig
