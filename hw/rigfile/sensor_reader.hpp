// One sensor of a node.
#pragma once

#include <string>

#include "hw/rigfile/table.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {

/// A sensor as written: what the host keeps, and what its node is told.
struct SensorEntry {
    Sensor sensor;
    SensorConfig config;
};

/// The table of one sensor, its keys checked.
[[nodiscard]] Table sensor_table(const Value& value, const std::string& path);
/// Throws Fault for whatever is wrong in this sensor alone, the board's limits included.
[[nodiscard]] SensorEntry read_sensor(const Table& table, const UrdfDocument& robot,
                                      const std::string& base_link, const Board& board);

}  // namespace octoskin::rig
