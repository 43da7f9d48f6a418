// How busy a node's sensors keep one of its I2C buses.
#pragma once

#include "common/config/node_config.hpp"
#include "common/time.hpp"

namespace octoskin::rig {

inline constexpr double kI2cLoadMax = 0.7;

/// How long one reading of a sensor occupies its bus, at that clock; seconds.
[[nodiscard]] double reading_s(const NodeConfig& node, const SensorConfig& sensor);

/// How much longer than its budget a sensor's period must be, so that a zone can be written between two
/// ranges: reading and write at that clock, the guard, the most by which a range may begin before its window,
/// and what the period may be off.
[[nodiscard]] Microseconds zone_pause(const NodeConfig& node, const SensorConfig& sensor);

/// Share of the time that bus `bus` is occupied while all its sensors range, 0..1 and beyond. At the slowest
/// clock that the bus may have: filters and rise times stretch a nominal 400 kHz to 283.
[[nodiscard]] double i2c_load(const NodeConfig& node, std::uint8_t bus);

}  // namespace octoskin::rig
