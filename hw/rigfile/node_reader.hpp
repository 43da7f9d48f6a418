// Reads the `nodes:` of a rig: boards and sensors, and checks that they can work together.
#pragma once

#include <string>
#include <vector>

#include "hw/rigfile/table.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {

/// The parts of the rig that a node's checks need.
struct NodeContext {
    const UrdfDocument& robot;
    const std::string& base_link;
    const Bus& bus;
    const Value* sensor_defaults;  ///< defaults of every sensor; nullptr if the rig has none
};

/// Every node with its sensors and its complete configuration. Throws Error for an error in a node, for names
/// and addresses used twice, and for an I2C bus loaded above 70 %.
[[nodiscard]] std::vector<Node> read_nodes(const Value& value, const std::string& path,
                                           const NodeContext& context);

/// A path to a board's file, relative to the file that names it, or the board's table itself.
[[nodiscard]] Board read_board(const Value& value, const std::string& path);

}  // namespace octoskin::rig
