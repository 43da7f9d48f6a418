// The properties that differ between boards of one type: their sensors' constants and their unique id. A
// function of the seed and the node, so that the node core gets the same parts in this process and on an
// emulated board.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/config/node_config.hpp"
#include "hw/sim/vl53l1x/ranging_timing.hpp"

namespace octoskin::sim {

struct BoardParts {
    std::vector<SensorPart> sensors;  ///< by local index
    std::array<std::uint8_t, 12> unique_id{};
};

/// The source of the parts.
struct PartsReel {
    std::uint64_t seed = 0;
    SlowClockSpread slow_clocks{};
    std::vector<TraitsOf> traits{};
};
[[nodiscard]] BoardParts draw_board_parts(const PartsReel& reel, const NodeConfig& config);

}  // namespace octoskin::sim
