// OctoMap 1.9 as an independent oracle of the mapping room: its own keys, rays, sets and arithmetic, with
// exact log-odds clamps.
#pragma once

#include <octomap/octomap.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin::oracle {

/// An OcTree whose clamps are set in log-odds: the public setters take probabilities and would round.
class ClampedTree : public octomap::OcTree {
  public:
    explicit ClampedTree(const MapConfig& config) : octomap::OcTree(config.resolution_m) {
        clamping_thres_min = config.log_odds_min;
        clamping_thres_max = config.log_odds_max;
        occ_prob_thres_log = config.log_odds_occupied;
    }
};

inline VoxelKey key_of(const octomap::OcTreeKey& key) {
    return {key[0], key[1], key[2]};
}
inline octomap::OcTreeKey key_of(VoxelKey key) {
    return {key.x, key.y, key.z};
}
inline octomap::point3d point_of(const Eigen::Vector3f& point) {
    return {point.x(), point.y(), point.z()};
}

inline std::vector<VoxelKey> ray_keys(const octomap::OcTree& tree, const Eigen::Vector3f& origin,
                                      const Eigen::Vector3f& end) {
    static thread_local octomap::KeyRay ray;  // it has room for 100,000 keys: not anew for each ray
    std::vector<VoxelKey> keys;
    if (!tree.computeRayKeys(point_of(origin), point_of(end), ray)) return keys;
    for (const auto& key : ray) keys.push_back(key_of(key));
    return keys;
}

/// Every known voxel of a tree at its finest level, pruned nodes expanded.
template <class Node>
std::map<VoxelKey, float> voxels_of(const octomap::OccupancyOcTreeBase<Node>& tree) {
    std::map<VoxelKey, float> voxels;
    for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
        const int edge = 1 << (tree.getTreeDepth() - leaf.getDepth());
        const VoxelKey lowest = key_of(leaf.getIndexKey());
        for (int z = 0; z < edge; ++z) {
            for (int y = 0; y < edge; ++y) {
                for (int x = 0; x < edge; ++x) {
                    voxels[{static_cast<std::uint16_t>(lowest.x + x),
                            static_cast<std::uint16_t>(lowest.y + y),
                            static_cast<std::uint16_t>(lowest.z + z)}] = leaf->getLogOdds();
                }
            }
        }
    }
    return voxels;
}

inline std::map<VoxelKey, float> voxels_of(const FusedMap& map) {
    std::map<VoxelKey, float> voxels;
    map.for_each_known([&](VoxelKey key, float log_odds) { voxels[key] = log_odds; });
    return voxels;
}

}  // namespace octoskin::oracle
