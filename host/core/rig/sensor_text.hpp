// The name of a sensor in texts for the user.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// "node 7 'upper ring' sensor 3 'left'". `sensor`: its index on the node.
[[nodiscard]] inline std::string sensor_text(wire::NodeId node, std::string_view node_name,
                                             std::size_t sensor, std::string_view sensor_name) {
    return "node " + std::to_string(node) + " '" + std::string(node_name) + "' sensor " +
           std::to_string(sensor) + " '" + std::string(sensor_name) + "'";
}
/// The same for a sensor of `node`.
[[nodiscard]] inline std::string sensor_text(const HostNode& node, std::size_t sensor) {
    return sensor_text(node.node_id, node.name, sensor, node.sensors.at(sensor).name);
}

}  // namespace octoskin
