#include "host/bridge/published/binary_octree.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace octoskin::bridge {
namespace {

constexpr unsigned kDepth = 16;  ///< levels below the root

/// Two bits of a .bt.
enum State : unsigned { none, free_leaf, occupied_leaf, inner };

/// Of a node with these children: eight equal leaves are one.
constexpr unsigned state_of(unsigned children) {
    constexpr unsigned kAllFree = 0x5555U;
    constexpr unsigned kAllOccupied = 0xAAAAU;
    if (children == 0) return none;
    if (children == kAllFree) return free_leaf;
    return children == kAllOccupied ? occupied_leaf : inner;
}

unsigned children_of_voxels(const float* voxels, float occupied_from) {
    unsigned children = 0;
    for (unsigned child = 0; child < 8; ++child) {
        const float log_odds = voxels[child];
        const unsigned known = std::isnan(log_odds) ? 0U : 1U;
        const unsigned occupied = log_odds >= occupied_from ? 1U : 0U;
        children |= (known + occupied) << (2 * child);
    }
    return children;
}

}  // namespace

BinaryOctree::Brick BinaryOctree::encoded(MortonCode code, const BrickView& view, float occupied_from) {
    Brick brick;
    brick.code = code;
    if (view.values == nullptr) {
        std::array<float, 8> alike;
        alike.fill(view.value);
        brick.root = static_cast<Children>(children_of_voxels(alike.data(), occupied_from));
        return brick;
    }
    unsigned root = 0;
    std::size_t end = 1;
    for (unsigned i = 0; i < 8; ++i) {
        const std::size_t at = end++;
        unsigned upper = 0;
        for (unsigned j = 0; j < 8; ++j) {
            const unsigned lower = children_of_voxels(view.values->data() + 64 * i + 8 * j, occupied_from);
            const unsigned state = state_of(lower);
            upper |= state << (2 * j);
            if (state == inner) brick.nodes[end++] = static_cast<Children>(lower);
        }
        brick.nodes[at] = static_cast<Children>(upper);
        root |= state_of(upper) << (2 * i);
        if (state_of(upper) != inner) end = at;
    }
    brick.root = static_cast<Children>(root);
    brick.nodes[0] = brick.root;
    brick.count = static_cast<std::uint8_t>(state_of(root) == inner ? end : 0);
    return brick;
}

void BinaryOctree::update(const BrickTree& log_odds, float occupied_from) {
    if (occupied_from != occupied_from_) {
        log_odds_ = {};
        bricks_.clear();
        occupied_from_ = occupied_from;
    }
    std::vector<Brick> changed;
    log_odds.for_each_difference(log_odds_, [&](MortonCode code) {
        changed.push_back(encoded(code, log_odds.find(code), occupied_from));
    });
    if (!changed.empty()) {
        merge(std::move(changed));
        write();
    }
    log_odds_ = log_odds;
}

/// Both are sorted. A brick without a known voxel is removed.
void BinaryOctree::merge(std::vector<Brick> changed) {
    const bool are_all_there = std::ranges::all_of(changed, [this](const Brick& brick) {
        const auto found = std::ranges::lower_bound(bricks_, brick.code, {}, &Brick::code);
        const bool is_there = brick.root != 0 && found != bricks_.end() && found->code == brick.code;
        if (is_there) *found = brick;
        return is_there;
    });
    if (are_all_there) return;
    std::vector<Brick> merged;
    merged.reserve(bricks_.size() + changed.size());
    std::ranges::set_union(changed, bricks_, std::back_inserter(merged), {}, &Brick::code, &Brick::code);
    std::erase_if(merged, [](const Brick& brick) { return brick.root == 0; });
    bricks_ = std::move(merged);
}

void BinaryOctree::write() {
    data_.clear();
    std::size_t next = 0;
    if (!bricks_.empty()) (void)append(next, kDepth);
}

/// Appends the node with an edge of 2^height voxels about the brick `next`, without what is pruned, and goes
/// on to the brick behind it. Returns its state. Recursion depth: 13.
unsigned BinaryOctree::append(std::size_t& next, unsigned height) {
    if (height == kBrickHeight) return append_brick(bricks_[next++]);
    const MortonCode place = bricks_[next].code >> (3 * height);
    const std::size_t at = data_.size();
    data_.resize(at + sizeof(Children));
    unsigned children = 0;
    while (next < bricks_.size() && bricks_[next].code >> (3 * height) == place) {
        const auto child = static_cast<unsigned>(bricks_[next].code >> (3 * (height - 1))) & 7U;
        children |= append(next, height - 1) << (2 * child);
    }
    const auto node = static_cast<Children>(children);
    std::memcpy(data_.data() + at, &node, sizeof(node));
    if (state_of(children) != inner) data_.resize(at);
    return state_of(children);
}

unsigned BinaryOctree::append_brick(const Brick& brick) {
    const std::size_t at = data_.size();
    data_.resize(at + brick.count * sizeof(Children));
    if (brick.count > 0) std::memcpy(data_.data() + at, brick.nodes.data(), brick.count * sizeof(Children));
    return state_of(brick.root);
}

}  // namespace octoskin::bridge
