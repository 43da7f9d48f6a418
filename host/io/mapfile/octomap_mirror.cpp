#include "host/io/mapfile/octomap_mirror.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <span>
#include <sstream>
#include <string>

#include "host/io/mapfile/octomap_tree.hpp"
#include "host/io/mapfile/octree.hpp"

namespace octoskin {
namespace {

/// The voxels of a cube in Morton order.
using Voxels = std::span<const float>;

bool are_unknown(Voxels voxels) {
    return std::ranges::all_of(voxels, [](float log_odds) { return std::isnan(log_odds); });
}
bool are_one_value(Voxels voxels) {
    return std::ranges::all_of(voxels, [&](float log_odds) { return log_odds == voxels[0]; });
}
/// Compares bits: unknown voxels are NaN.
bool are_unchanged(Voxels now, Voxels before) {
    const auto bytes = std::as_bytes(now);
    return std::memcmp(bytes.data(), std::as_bytes(before).data(), bytes.size()) == 0;
}

/// A brick's 512 voxels as an array, expanded if they are all equal.
class BrickVoxels {
  public:
    explicit BrickVoxels(const BrickView& brick) : values_(brick.values) {
        if (values_ == nullptr) alike_.fill(brick.value);
    }
    [[nodiscard]] Voxels all() const noexcept { return values_ != nullptr ? *values_ : alike_; }

  private:
    const BrickValues* values_;
    BrickValues alike_;
};

/// Inserts bricks into a tree in Morton order. The nodes on the path to the last brick stay open, neither
/// pruned nor removed, until a brick comes that is not below them. Each node is thus visited once, however
/// many bricks below it are inserted. OctoMap itself counts the nodes.
class BrickInsertion {
  public:
    explicit BrickInsertion(octomap::OcTree& tree) : tree_(tree) {}

    /// The tree contains `before` for the brick, and afterwards `now`.
    void put(MortonCode brick, const BrickView& now, const BrickView& before);
    /// After this call nothing may be inserted.
    void finish();

  private:
    static constexpr unsigned kParentHeight = kBrickHeight + 1;

    void open_root();
    void open_child();
    void close_lowest();
    void put_cube(octomap::OcTreeNode* parent, unsigned child, Voxels now, Voxels before);
    void remove(octomap::OcTreeNode* parent, unsigned child);
    void make_leaf(octomap::OcTreeNode* node);
    void drop_children(octomap::OcTreeNode* node);

    /// Which child of its parent the node at this height above the brick is.
    [[nodiscard]] unsigned child_at(unsigned height) const {
        return static_cast<unsigned>(brick_ >> (3 * height)) & 7U;
    }

    octomap::OcTree& tree_;
    std::array<octomap::OcTreeNode*, kOctreeDepth + 1> open_{};  ///< by height
    unsigned lowest_ = kOctreeDepth;                             ///< height of the lowest open node
    MortonCode brick_ = 0;                                       ///< the last inserted one
};

void BrickInsertion::put(MortonCode brick, const BrickView& now, const BrickView& before) {
    if (open_[kOctreeDepth] == nullptr) open_root();
    const auto height_of_both = static_cast<unsigned>(std::bit_width(brick ^ brick_) + 2) / 3;
    while (lowest_ < height_of_both) close_lowest();
    brick_ = brick;
    while (lowest_ > kParentHeight) open_child();
    put_cube(open_[kParentHeight], child_at(kBrickHeight), BrickVoxels(now).all(), BrickVoxels(before).all());
}

void BrickInsertion::finish() {
    octomap::OcTreeNode* const root = open_[kOctreeDepth];
    if (root == nullptr) return;
    while (lowest_ < kOctreeDepth) close_lowest();
    if (!tree_.nodeHasChildren(root)) {
        tree_.clear();
    } else if (!tree_.pruneNode(root)) {
        root->updateOccupancyChildren();
    }
}

void BrickInsertion::open_root() {
    if (tree_.getRoot() == nullptr) {
        // Makes a root without children: of OctoMap's public functions only its reader can.
        std::istringstream root(std::string(sizeof(float) + 1, '\0'));
        tree_.readData(root);
    }
    open_[kOctreeDepth] = tree_.getRoot();
}

void BrickInsertion::open_child() {
    octomap::OcTreeNode* const parent = open_[lowest_];
    const unsigned child = child_at(--lowest_);
    if (!tree_.nodeChildExists(parent, child)) {
        open_[lowest_] = tree_.createNodeChild(parent, child);
        return;
    }
    open_[lowest_] = tree_.getNodeChild(parent, child);
    if (!tree_.nodeHasChildren(open_[lowest_])) tree_.expandNode(open_[lowest_]);
}

void BrickInsertion::close_lowest() {
    octomap::OcTreeNode* const node = open_[lowest_];
    const unsigned child = child_at(lowest_++);
    if (!tree_.nodeHasChildren(node)) {
        drop_children(node);
        tree_.deleteNodeChild(open_[lowest_], child);
    } else if (!tree_.pruneNode(node)) {
        node->updateOccupancyChildren();
    }
}

/// Makes the nodes below a place what a pruned tree has there. Recursion depth: the levels of a brick.
void BrickInsertion::put_cube(octomap::OcTreeNode* parent, unsigned child, Voxels now, Voxels before) {
    const bool is_new = !tree_.nodeChildExists(parent, child);
    if (are_unknown(now)) {
        if (!is_new) remove(parent, child);
        return;
    }
    octomap::OcTreeNode* const node =
        is_new ? tree_.createNodeChild(parent, child) : tree_.getNodeChild(parent, child);
    if (are_one_value(now)) {
        make_leaf(node);
        node->setLogOdds(now[0]);
        return;
    }
    if (!is_new && !tree_.nodeHasChildren(node)) tree_.expandNode(node);
    const std::size_t size = now.size() / 8;
    for (unsigned i = 0; i < 8; ++i) {
        const Voxels part = now.subspan(i * size, size);
        const Voxels part_before = before.subspan(i * size, size);
        if (!are_unchanged(part, part_before)) put_cube(node, i, part, part_before);
    }
    node->updateOccupancyChildren();
}

void BrickInsertion::remove(octomap::OcTreeNode* parent, unsigned child) {
    make_leaf(tree_.getNodeChild(parent, child));
    tree_.deleteNodeChild(parent, child);
}

void BrickInsertion::make_leaf(octomap::OcTreeNode* node) {
    if (tree_.nodeHasChildren(node)) drop_children(node);
}

/// After its children are deleted, a node in OctoMap keeps the array for them, and its deletion then asserts;
/// only pruning eight equal leaves frees the array. Recursion depth: the levels below the node.
void BrickInsertion::drop_children(octomap::OcTreeNode* node) {
    for (unsigned i = 0; i < 8; ++i) {
        octomap::OcTreeNode* const child =
            tree_.nodeChildExists(node, i) ? tree_.getNodeChild(node, i) : tree_.createNodeChild(node, i);
        make_leaf(child);
        child->setLogOdds(0.0F);
    }
    const bool is_pruned = tree_.pruneNode(node);
    assert(is_pruned);
    (void)is_pruned;
}

}  // namespace

OctomapMirror::OctomapMirror(const MapConfig& config) : shown_(config), tree_(config.resolution_m) {
    set_limits(tree_, config);
}

std::size_t OctomapMirror::update(const FusedMap& now) {
    assert(now.resolution_m() == shown_.resolution_m());
    set_limits(tree_, now.config());
    std::size_t bricks = 0;
    try {
        BrickInsertion insertion(tree_);
        now.for_each_difference(shown_, [&](const MapBrick& brick) {
            insertion.put(brick.first, brick.log_odds, shown_.brick(brick.first));
            ++bricks;
        });
        insertion.finish();
    } catch (...) {
        // The tree may contain half of a change, and neither map shows which half: start again.
        tree_.clear();
        shown_ = FusedMap(now.config());
        throw;
    }
    shown_ = now.copy();
    return bricks;
}

}  // namespace octoskin
