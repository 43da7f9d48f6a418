// Reads one sensor of a node.
#pragma once

#include <string>

#include "hw/rigfile/table.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {

/// A sensor of the file: the host's part, and the node's configuration.
struct SensorEntry {
    Sensor sensor;
    SensorConfig config;
};

/// The table of one sensor, its keys checked.
[[nodiscard]] Table sensor_table(const Value& value, const std::string& path);
/// Throws Error for an error in this sensor, including the board's limits.
[[nodiscard]] SensorEntry read_sensor(const Table& table, const UrdfDocument& robot,
                                      const std::string& base_link, const Board& board);

}  // namespace octoskin::rig
