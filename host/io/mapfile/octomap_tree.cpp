#include "host/io/mapfile/octomap_tree.hpp"

#include <octomap/octomap_utils.h>

#include <cassert>
#include <sstream>

#include "host/io/mapfile/octomap_writer.hpp"

namespace octoskin {

void set_limits(octomap::OcTree& tree, const MapConfig& config) {
    tree.setOccupancyThres(octomap::probability(static_cast<double>(config.log_odds_occupied)));
    tree.setClampingThresMin(octomap::probability(static_cast<double>(config.log_odds_min)));
    tree.setClampingThresMax(octomap::probability(static_cast<double>(config.log_odds_max)));
}

std::unique_ptr<octomap::OcTree> to_octomap(const FusedMap& map) {
    auto tree = std::make_unique<octomap::OcTree>(map.resolution_m());
    set_limits(*tree, map.config());
    if (map.known_voxels() == 0) return tree;
    // Through OctoMap's own reader: its public functions cannot make inner nodes.
    const std::string bytes = encode_ot(map);
    std::istringstream nodes(bytes.substr(bytes.find("\ndata\n") + 6));
    tree->readData(nodes);
    assert(nodes.good());
    return tree;
}

}  // namespace octoskin
