#include "host/io/mapfile/octree.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace octoskin {
namespace {

constexpr float kLowest = -std::numeric_limits<float>::max();

NodeState leaf_state(float log_odds, float log_odds_occupied) {
    if (std::isnan(log_odds)) return NodeState::none;
    return log_odds >= log_odds_occupied ? NodeState::occupied_leaf : NodeState::free_leaf;
}

constexpr std::uint16_t as_child(NodeState state, unsigned child) {
    return static_cast<std::uint16_t>(static_cast<unsigned>(state) << (2 * child));
}

/// The node above eight voxels.
OctreeNode parent_of_voxels(const float* voxels, float log_odds_occupied) {
    bool is_one_value = true;
    OctreeNode node{kLowest, 0, NodeState::inner};
    for (unsigned child = 0; child < 8; ++child) {
        const float log_odds = voxels[child];
        is_one_value &= log_odds == voxels[0];  // an unknown voxel, a NaN, is equal to none
        node.log_odds = log_odds > node.log_odds ? log_odds : node.log_odds;
        node.children |= as_child(leaf_state(log_odds, log_odds_occupied), child);
    }
    if (node.children == 0) return {};
    return is_one_value ? OctreeNode{voxels[0], 0, leaf_state(voxels[0], log_odds_occupied)} : node;
}

/// The node above eight children, of which some may be missing.
OctreeNode parent_of(std::span<const OctreeNode, 8> children) {
    bool is_one_leaf = true;
    OctreeNode node{kLowest, 0, NodeState::inner};
    for (unsigned child = 0; child < 8; ++child) {
        const OctreeNode& below = children[child];
        is_one_leaf &=
            below.children == 0 && below.state != NodeState::none && below.log_odds == children[0].log_odds;
        if (below.state != NodeState::none) node.log_odds = std::max(node.log_odds, below.log_odds);
        node.children |= as_child(below.state, child);
    }
    if (node.children == 0) return {};
    return is_one_leaf ? children[0] : node;
}

/// The lowest three levels of an octree, in one brick.
class BrickNodes {
  public:
    BrickNodes(const MapBrick& brick, const MapConfig& config, LeafValues values)
        : log_odds_occupied_(config.log_odds_occupied) {
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) voxels_[cell] = brick.log_odds.at(cell);
        if (values == LeafValues::max_likelihood) {
            for (float& log_odds : voxels_) {
                if (std::isnan(log_odds)) continue;
                log_odds = log_odds >= log_odds_occupied_ ? config.log_odds_max : config.log_odds_min;
            }
        }
        for (std::size_t i = 0; i < lower_.size(); ++i)
            lower_[i] = parent_of_voxels(&voxels_[8 * i], log_odds_occupied_);
        for (std::size_t i = 0; i < upper_.size(); ++i)
            upper_[i] = parent_of(std::span<const OctreeNode, 8>(&lower_[8 * i], 8));
        root_ = parent_of(upper_);
    }

    [[nodiscard]] const OctreeNode& root() const noexcept { return root_; }

    /// The number of nodes; the root must exist.
    [[nodiscard]] std::uint64_t size() const {
        const auto children_of = [](const OctreeNode& node) {
            const unsigned bits = node.children;
            return static_cast<unsigned>(std::popcount((bits | (bits >> 1U)) & 0x5555U));
        };
        std::uint64_t size = 1 + children_of(root_);
        if (root_.state != NodeState::inner) return size;
        for (std::size_t i = 0; i < upper_.size(); ++i) {
            size += children_of(upper_[i]);
            if (upper_[i].state != NodeState::inner) continue;
            for (std::size_t j = 8 * i; j < 8 * i + 8; ++j) size += children_of(lower_[j]);
        }
        return size;
    }

    void append_to(std::vector<OctreeNode>& nodes) const {
        nodes.push_back(root_);
        if (root_.state != NodeState::inner) return;
        for (std::size_t i = 0; i < upper_.size(); ++i) {
            if (upper_[i].state != NodeState::none) nodes.push_back(upper_[i]);
            if (upper_[i].state != NodeState::inner) continue;
            for (std::size_t j = 8 * i; j < 8 * i + 8; ++j) append_lower(j, nodes);
        }
    }

  private:
    void append_lower(std::size_t at, std::vector<OctreeNode>& nodes) const {
        if (lower_[at].state != NodeState::none) nodes.push_back(lower_[at]);
        if (lower_[at].state != NodeState::inner) return;
        for (std::size_t i = 8 * at; i < 8 * at + 8; ++i) {
            const NodeState state = leaf_state(voxels_[i], log_odds_occupied_);
            if (state != NodeState::none) nodes.push_back({voxels_[i], 0, state});
        }
    }

    float log_odds_occupied_;
    std::array<float, kBrickVoxels> voxels_;
    std::array<OctreeNode, 64> lower_;
    std::array<OctreeNode, 8> upper_;
    OctreeNode root_;
};

}  // namespace

PrunedOctree::PrunedOctree(const FusedMap& map, LeafValues values)
    : config_(map.config()), values_(values), bricks_(map.bricks()) {
    if (!bricks_.empty()) (void)append(0, bricks_.size(), kOctreeDepth);
    size_ += upper_.size();
}

/// Appends the node with an edge of 2^height voxels that contains the bricks from `begin` to `end` (at least
/// one), and everything below it. Recursion depth: that of the tree, at most 13.
OctreeNode PrunedOctree::append(std::size_t begin, std::size_t end, unsigned height) {
    if (height == kBrickHeight) {
        append_brick(begin);
        return upper_.back().node;
    }
    const auto child_of = [height](const MapBrick& brick) {
        return static_cast<unsigned>(brick.first >> (3 * (height - 1))) & 7U;
    };
    const std::size_t at = upper_.size();
    upper_.push_back({{}, kNoBrick});
    std::array<OctreeNode, 8> children;
    while (begin < end) {
        const unsigned child = child_of(bricks_[begin]);
        const auto from = bricks_.begin() + static_cast<std::ptrdiff_t>(begin);
        const auto to = bricks_.begin() + static_cast<std::ptrdiff_t>(end);
        const auto next =
            std::partition_point(from, to, [&](const MapBrick& brick) { return child_of(brick) == child; });
        const auto next_at = static_cast<std::size_t>(next - bricks_.begin());
        children[child] = append(begin, next_at, height - 1);
        begin = next_at;
    }
    const OctreeNode node = parent_of(children);
    upper_[at].node = node;
    if (node.state != NodeState::inner) upper_.resize(at + 1);
    return node;
}

void PrunedOctree::append_brick(std::size_t at) {
    const BrickNodes tree(bricks_[at], config_, values_);
    const bool is_inner = tree.root().state == NodeState::inner;
    size_ += is_inner ? tree.size() - 1 : 0;  // its root is among the upper nodes
    upper_.push_back({tree.root(), is_inner ? static_cast<std::uint32_t>(at) : kNoBrick});
}

bool PrunedOctree::for_each(const std::function<bool(std::span<const OctreeNode>)>& put) const {
    constexpr std::size_t kNodesAtOnce = 16'384;
    constexpr std::size_t kBrickNodesMax = kBrickVoxels + 64 + 8 + 1;
    std::vector<OctreeNode> nodes;
    nodes.reserve(kNodesAtOnce + kBrickNodesMax);
    for (const UpperNode& upper : upper_) {
        if (upper.brick == kNoBrick) {
            nodes.push_back(upper.node);
        } else {
            BrickNodes(bricks_[upper.brick], config_, values_).append_to(nodes);
        }
        if (nodes.size() < kNodesAtOnce) continue;
        if (!put(nodes)) return false;
        nodes.clear();
    }
    return nodes.empty() || put(nodes);
}

}  // namespace octoskin
