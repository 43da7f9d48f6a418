#include "hw/sim/experiment/board_parts.hpp"

#include <random>

namespace octoskin::sim {
namespace {

// Variation of new parts: oscillator calibration 36 or 37, the slow oscillator within the given spread (4..9
// % fast by default), the optical centre off by up to 2 SPADs, boot within the datasheet's 1.2 ms.
SensorPart draw_part(std::mt19937_64& random, const SlowClockSpread& slow_clocks) {
    // Plain arithmetic instead of <random>'s distributions, whose results differ between standard libraries.
    const auto uniform = [&random](std::uint32_t count) {
        return static_cast<std::uint32_t>(random() % count);
    };
    SensorPart part;
    part.osc_calibrate = static_cast<std::uint16_t>(36U + uniform(2));
    part.slow_clock_factor =
        slow_clocks.factor_min + (slow_clocks.factor_max - slow_clocks.factor_min) * uniform(1001) / 1000.0;
    part.optical_centre_spad = static_cast<std::uint8_t>(199U - 2U + uniform(5));
    part.boot_time = Microseconds{600 + uniform(601)};
    return part;
}

}  // namespace

BoardParts draw_board_parts(const PartsReel& reel, const NodeConfig& config) {
    std::mt19937_64 random(reel.seed * 64 + config.node_id);
    BoardParts parts;
    for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
        parts.sensors.push_back(draw_part(random, reel.slow_clocks));
        parts.sensors.back().traits = traits_of(reel.traits, config.node_id, sensor);
    }
    for (std::uint8_t& byte : parts.unique_id) byte = static_cast<std::uint8_t>(random() & 0xFFU);
    return parts;
}

}  // namespace octoskin::sim
