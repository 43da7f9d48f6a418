#include "host/core/bricks/brick_tree.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <memory>
#include <utility>

#include "host/core/bricks/cube_parts.hpp"

namespace octoskin {
namespace {

static_assert(sizeof(void*) == 8, "a place holds a pointer or a marked value");

/// Bits of a Morton code that select a place within one node.
constexpr unsigned kNodeBits = 6;
constexpr std::size_t kPlaces = std::size_t{1} << kNodeBits;
constexpr unsigned kBrickBits = 3 * kBrickHeight;
/// Levels of nodes; the lowest is 0. A code has 48 bits: 9 within a brick, and only three in the root.
constexpr unsigned kLevels = 7;

constexpr std::size_t place_at(MortonCode brick, unsigned level) {
    return (brick >> (kBrickBits + kNodeBits * level)) & (kPlaces - 1);
}
constexpr MortonCode code_at(MortonCode node, std::size_t place, unsigned level) {
    return node | (static_cast<MortonCode>(place) << (kBrickBits + kNodeBits * level));
}

constexpr std::uint64_t kIsValue = 1;
bool is_value(std::uint64_t place) {
    return (place & kIsValue) != 0;
}
template <class Value>
Value value_in(std::uint64_t place) {
    const auto upper = static_cast<std::uint32_t>(place >> 32U);
    if constexpr (sizeof(Value) == sizeof(upper)) {
        return std::bit_cast<Value>(upper);
    } else {
        return static_cast<Value>(upper);
    }
}
template <class Value>
std::uint64_t place_of_value(Value value) {
    std::uint32_t upper = 0;
    if constexpr (sizeof(Value) == sizeof(upper)) {
        upper = std::bit_cast<std::uint32_t>(value);
    } else {
        upper = value;
    }
    return (std::uint64_t{upper} << 32U) | kIsValue;
}
template <class Below>
Below* below(std::uint64_t place) {
    return std::bit_cast<Below*>(place);
}
template <class Below>
std::uint64_t place_of_pointer(Below* pointer) {
    return std::bit_cast<std::uint64_t>(pointer);
}

}  // namespace

// Only the owner of a reference increments the counter, so only decrements need memory ordering.
template <class Value>
struct BrickTreeOf<Value>::Node {
    std::atomic<std::uint32_t> owners = 1;
    /// One bit per place. Clear: this node alone owns the child. The owner of the node then need not read the
    /// child, which is not in the cache.
    std::atomic<std::uint64_t> maybe_shared = 0;
    std::array<Place, kPlaces> places{};
};
template <class Value>
struct BrickTreeOf<Value>::Dense {
    std::atomic<std::uint32_t> owners = 1;
    Values values;
};

template <class Value>
BrickTreeOf<Value>::BrickTreeOf(const BrickTreeOf& other) noexcept
    : root_(other.root_), nodes_(other.nodes_), dense_(other.dense_), bricks_(other.bricks_) {
    share(place_of_pointer(root_), kLevels);
}
template <class Value>
BrickTreeOf<Value>::BrickTreeOf(BrickTreeOf&& other) noexcept
    : root_(std::exchange(other.root_, nullptr)),
      nodes_(std::exchange(other.nodes_, 0)),
      dense_(std::exchange(other.dense_, 0)),
      bricks_(std::exchange(other.bricks_, 0)) {}
template <class Value>
BrickTreeOf<Value>& BrickTreeOf<Value>::operator=(BrickTreeOf other) noexcept {
    std::swap(root_, other.root_);
    std::swap(nodes_, other.nodes_);
    std::swap(dense_, other.dense_);
    std::swap(bricks_, other.bricks_);
    return *this;
}
template <class Value>
BrickTreeOf<Value>::~BrickTreeOf() {
    release(place_of_pointer(root_), kLevels);
}

/// `level`: level of the node that contains the place.
template <class Value>
void BrickTreeOf<Value>::share(Place place, unsigned level) noexcept {
    if (place == 0) return;
    if (level > 0) {
        below<Node>(place)->owners.fetch_add(1, std::memory_order_relaxed);
    } else if (!is_value(place)) {
        below<Dense>(place)->owners.fetch_add(1, std::memory_order_relaxed);
    }
}

/// Recursion depth: the levels of the tree.
template <class Value>
void BrickTreeOf<Value>::release(Place place, unsigned level) noexcept {
    if (place == 0) return;
    if (level == 0) {
        if (is_value(place)) return;
        if (below<Dense>(place)->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) {
            delete below<Dense>(place);
        }
        return;
    }
    Node* const node = below<Node>(place);
    if (node->owners.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    for (const Place lower : node->places) release(lower, level - 1);
    delete node;
}

template <class Value>
BrickViewOf<Value> BrickTreeOf<Value>::find(MortonCode brick) const noexcept {
    const Node* node = root_;
    for (unsigned level = kLevels - 1; level > 0 && node != nullptr; --level) {
        node = below<Node>(node->places[place_at(brick, level)]);
    }
    return brick_in(node == nullptr ? 0 : node->places[place_at(brick, 0)]);
}

/// `place`: 0, or a place of a node of the lowest level.
template <class Value>
BrickViewOf<Value> BrickTreeOf<Value>::brick_in(Place place) noexcept {
    if (place == 0) return {};
    if (is_value(place)) return {nullptr, value_in<Value>(place)};
    return {&below<Dense>(place)->values, UnknownValue<Value>::kValue};
}

template <class Value>
typename BrickTreeOf<Value>::Space BrickTreeOf<Value>::space() const noexcept {
    // An empty tree has no root that is twice as wide as the octree: it is the octree's cube without parts.
    const unsigned height = kBrickHeight + 2 * kLevels - (root_ == nullptr ? 1U : 0U);
    return {place_of_pointer(root_), {.lowest = {}, .height = height}};
}

template <class Value>
typename BrickTreeOf<Value>::Space BrickTreeOf<Value>::Space::part(std::size_t index) const noexcept {
    assert(has_parts() && index < kPlaces);
    return {below<Node>(place_)->places[index], part_of(cube_, index)};
}

template <class Value>
BrickViewOf<Value> BrickTreeOf<Value>::Space::bricks() const noexcept {
    assert(!has_parts());
    return brick_in(place_);
}

template <class Value>
std::size_t BrickTreeOf<Value>::nodes_missing(MortonCode brick) const noexcept {
    const Node* node = root_;
    for (unsigned level = kLevels - 1; level > 0; --level) {
        if (node == nullptr) return level + 1;
        node = below<Node>(node->places[place_at(brick, level)]);
    }
    return node == nullptr ? 1 : 0;
}

namespace {

template <class Shared>
bool is_ours(const Shared* shared) {
    return shared->owners.load(std::memory_order_acquire) == 1;
}

}  // namespace

template <class Value>
BrickValuesOf<Value>* BrickTreeOf<Value>::own(MortonCode brick) noexcept {
    return OwnBricks(*this).find(brick);
}

template <class Value>
BrickValuesOf<Value>* BrickTreeOf<Value>::OwnBricks::find(MortonCode brick) noexcept {
    const MortonCode prefix = brick >> (kBrickBits + kNodeBits);
    if (lowest_ == nullptr || prefix != prefix_) {
        lowest_ = nullptr;
        Node* node = tree_->root_;
        for (unsigned level = kLevels - 1; level > 0; --level) {
            if (node == nullptr || !is_ours(node)) return nullptr;
            node = below<Node>(node->places[place_at(brick, level)]);
        }
        if (node == nullptr || !is_ours(node)) return nullptr;
        lowest_ = node;
        prefix_ = prefix;
    }
    const std::size_t index = place_at(brick, 0);
    const Place place = lowest_->places[index];
    if (place == 0 || is_value(place)) return nullptr;
    Dense* const dense = below<Dense>(place);
    const std::uint64_t maybe_shared = lowest_->maybe_shared.load(std::memory_order_relaxed);
    if ((maybe_shared >> index & 1U) != 0) {
        if (!is_ours(dense)) return nullptr;
        lowest_->maybe_shared.store(maybe_shared & ~(std::uint64_t{1} << index), std::memory_order_relaxed);
    }
    return &dense->values;
}

template <class Value>
typename BrickTreeOf<Value>::Place& BrickTreeOf<Value>::place_of(MortonCode brick) {
    // All missing nodes are allocated before any of them is linked, so that a failure changes nothing.
    const std::size_t missing = nodes_missing(brick);
    std::array<std::unique_ptr<Node>, kLevels> made;
    for (std::size_t i = 0; i < missing; ++i) made[i] = std::make_unique<Node>();

    Place* place = nullptr;  // the place that refers to `node`
    Node* node = root_;
    for (unsigned level = kLevels; level-- > 0;) {
        if (node == nullptr) {
            node = made[level].release();
            ++nodes_;
        } else if (!is_ours(node)) {
            auto own = std::make_unique<Node>();
            own->places = node->places;
            for (const Place lower : own->places) share(lower, level);
            own->maybe_shared = ~std::uint64_t{0};
            node->maybe_shared = ~std::uint64_t{0};  // before the release: the next owner must see it
            release(place_of_pointer(node), level + 1);
            node = own.release();
        }
        if (place == nullptr) {
            root_ = node;
        } else {
            *place = place_of_pointer(node);
        }
        place = &node->places[place_at(brick, level)];
        if (level > 0) node = below<Node>(*place);
    }
    return *place;
}

template <class Value>
void BrickTreeOf<Value>::set_all(MortonCode brick, Value value) {
    assert(!UnknownValue<Value>::is(value));
    Place& place = place_of(brick);
    bricks_ += place == 0 ? 1U : 0U;
    if (place != 0 && !is_value(place)) {
        release(place, 0);
        --dense_;
    }
    place = place_of_value(value);
}

template <class Value>
void BrickTreeOf<Value>::forget(MortonCode brick) {
    if (find(brick).is_unknown()) return;
    Place& place = place_of(brick);
    dense_ -= is_value(place) ? 0U : 1U;
    --bricks_;
    release(place, 0);
    place = 0;
    // Removes nodes that have become empty.
    std::array<Node*, kLevels> path{};
    Node* node = root_;
    for (unsigned level = kLevels; level-- > 0;) {
        path[level] = node;
        if (level > 0) node = below<Node>(node->places[place_at(brick, level)]);
    }
    for (unsigned level = 0; level < kLevels; ++level) {
        const auto& places = path[level]->places;
        if (std::any_of(places.begin(), places.end(), [](Place below_it) { return below_it != 0; })) return;
        delete path[level];
        --nodes_;
        if (level + 1 == kLevels) {
            root_ = nullptr;
        } else {
            path[level + 1]->places[place_at(brick, level + 1)] = 0;
        }
    }
}

template <class Value>
BrickValuesOf<Value>& BrickTreeOf<Value>::open(MortonCode brick) {
    if (Values* const values = own(brick)) return *values;
    // Allocated first: otherwise a failure would leave an empty node.
    const View before = find(brick);
    std::unique_ptr<Dense> made;
    if (before.values == nullptr) {
        made = std::make_unique<Dense>();
        made->values.fill(before.value);
    }
    Place& place = place_of(brick);
    if (made != nullptr) {
        bricks_ += place == 0 ? 1U : 0U;
        ++dense_;
        place = place_of_pointer(made.release());
    } else if (!is_ours(below<Dense>(place))) {
        auto own = std::make_unique<Dense>();
        own->values = below<Dense>(place)->values;
        release(place, 0);
        place = place_of_pointer(own.release());
    }
    return below<Dense>(place)->values;
}

template <class Value>
void BrickTreeOf<Value>::for_each(const std::function<void(MortonCode, const View&)>& visit) const {
    const auto visit_node = [&](const auto& self, const Node& node, MortonCode code, unsigned level) -> void {
        for (std::size_t i = 0; i < kPlaces; ++i) {
            const Place place = node.places[i];
            if (place == 0) continue;
            const MortonCode lower = code_at(code, i, level);
            if (level > 0) {
                self(self, *below<Node>(place), lower, level - 1);
            } else {
                visit(lower, brick_in(place));
            }
        }
    };
    if (root_ != nullptr) visit_node(visit_node, *root_, 0, kLevels - 1);
}

template <class Value>
void BrickTreeOf<Value>::for_each_difference(const BrickTreeOf& before,
                                             const std::function<void(MortonCode)>& visit) const {
    // An empty place is equivalent to a node with empty places.
    const auto compare = [&](const auto& self, Place now, Place then, MortonCode code,
                             unsigned level) -> void {
        if (now == then) return;
        if (level == 0) return visit(code);
        for (std::size_t i = 0; i < kPlaces; ++i) {
            self(self, now == 0 ? 0 : below<Node>(now)->places[i],
                 then == 0 ? 0 : below<Node>(then)->places[i], code_at(code, i, level - 1), level - 1);
        }
    };
    compare(compare, place_of_pointer(root_), place_of_pointer(before.root_), 0, kLevels);
}

template class BrickTreeOf<float>;
template class BrickTreeOf<std::uint16_t>;

}  // namespace octoskin
