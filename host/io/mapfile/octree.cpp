#include "host/io/mapfile/octree.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "host/core/mapping/morton.hpp"

namespace octoskin {
namespace {

struct Leaf {
    MortonCode code;
    float log_odds;
};

class Builder {
  public:
    std::vector<OctreeNode> nodes;

    /// Appends the node of 2^height voxels' edge that holds these leaves, and what is below it. They are in
    /// Morton order, at least one. Recurses `height` deep, 16 at most.
    void append(std::span<const Leaf> leaves, unsigned height) {
        if (height == 0) {
            nodes.push_back({leaves.front().log_odds, 0});
            return;
        }
        const std::size_t at = nodes.size();
        nodes.emplace_back();
        OctreeNode node{-std::numeric_limits<float>::max(), 0};
        while (!leaves.empty()) {
            const unsigned child = child_of(leaves.front(), height);
            const auto next = std::partition_point(leaves.begin(), leaves.end(), [&](const Leaf& leaf) {
                return child_of(leaf, height) == child;
            });
            const std::size_t child_at = nodes.size();
            append({leaves.begin(), next}, height - 1);
            node.children = static_cast<std::uint8_t>(node.children | (1U << child));
            node.log_odds = std::max(node.log_odds, nodes[child_at].log_odds);
            leaves = {next, leaves.end()};
        }
        nodes[at] = node;
        prune(at);
    }

  private:
    static unsigned child_of(const Leaf& leaf, unsigned height) {
        return static_cast<unsigned>(leaf.code >> (3 * (height - 1))) & 7U;
    }

    /// Makes the node at `at`, the last one complete, a leaf if it has eight leaves of one value.
    void prune(std::size_t at) {
        const bool has_eight_leaves = nodes[at].children == 0xFF && nodes.size() == at + 9;
        if (!has_eight_leaves) return;
        const float value = nodes[at + 1].log_odds;
        const auto first = nodes.begin() + static_cast<std::ptrdiff_t>(at) + 1;
        if (!std::all_of(first, nodes.end(),
                         [&](const OctreeNode& leaf) { return leaf.log_odds == value; })) {
            return;
        }
        nodes.resize(at + 1);
        nodes[at] = {value, 0};
    }
};

}  // namespace

std::vector<OctreeNode> pruned_octree(const FusedMap& map, LeafValues values) {
    const MapConfig& config = map.config();
    std::vector<Leaf> leaves;
    leaves.reserve(map.known_voxels());
    map.for_each_known([&](VoxelKey key, float log_odds) {
        if (values == LeafValues::max_likelihood) {
            const bool is_occupied = map.occupancy_of(log_odds) == Occupancy::occupied;
            log_odds = is_occupied ? config.log_odds_max : config.log_odds_min;
        }
        leaves.push_back({morton_of(key), log_odds});
    });
    Builder builder;
    if (!leaves.empty()) builder.append(leaves, kOctreeDepth);
    return std::move(builder.nodes);
}

}  // namespace octoskin
