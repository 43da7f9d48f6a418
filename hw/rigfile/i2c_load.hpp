// The load of a node's I2C buses.
#pragma once

#include "common/config/node_config.hpp"
#include "common/time.hpp"

namespace octoskin::rig {

inline constexpr double kI2cLoadMax = 0.7;

/// Time that one reading of a sensor occupies its bus, at the slowest clock (see i2c_load), seconds.
[[nodiscard]] double reading_s(const NodeConfig& node, const SensorConfig& sensor);

/// The least difference between a sensor's period and its budget, so that a zone can be written between two
/// ranges. The sum of reading and write at that clock, the guard, the greatest time by which a range may
/// begin before its window, and the period's error.
[[nodiscard]] Microseconds zone_pause(const NodeConfig& node, const SensorConfig& sensor);

/// Share of the time that bus `bus` is occupied while all its sensors range; above 1 if overloaded. Computed
/// at the slowest clock of the bus: filters and rise times reduce a nominal 400 kHz to 283 kHz.
[[nodiscard]] double i2c_load(const NodeConfig& node, std::uint8_t bus);

}  // namespace octoskin::rig
