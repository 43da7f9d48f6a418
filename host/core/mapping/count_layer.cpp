#include "host/core/mapping/count_layer.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/bricks/brick_sets.hpp"

namespace octoskin {

void CountLayer::begin(MortonCode brick, const BrickView& now) {
    misses.set_all(brick, 0.0F);
    if (now.values != nullptr) {
        prior.open(brick) = *now.values;
    } else if (!now.is_unknown()) {
        prior.set_all(brick, now.value);
    }
    hits.set_all(brick, 0.0F);
}

void CountLayer::expire(MortonCode brick, const BrickMask& voxels) {
    const auto put = [&](BrickTree& tree, float value) {
        if (tree.find(brick).is_unknown()) return;
        BrickValues& values = tree.open(brick);
        for_each_cell(voxels, [&](std::size_t cell) { values[cell] = value; });
    };
    if (is_whole(voxels)) {
        for (BrickTree* tree : {&hits, &misses, &prior}) tree->forget(brick);
        return;
    }
    put(prior, kUnknownLogOdds);
    put(misses, 0.0F);
    put(hits, 0.0F);
    const auto is_none = [&](std::size_t cell) {
        return hits.find(brick).at(cell) == 0.0F && misses.find(brick).at(cell) == 0.0F &&
               std::isnan(prior.find(brick).at(cell));
    };
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
        if (!is_none(cell)) return;
    for (BrickTree* tree : {&hits, &misses, &prior}) tree->forget(brick);
}

std::size_t CountLayer::bytes_at_most() const noexcept {
    const auto bytes = [](const BrickTree& tree) {
        return tree.nodes() * BrickTree::kNodeBytes + tree.bricks() * BrickTree::kBrickBytes;
    };
    // A brick without priors may get them.
    return bytes(hits) + bytes(misses) + std::max(bytes(prior), bytes(hits));
}

std::size_t CountLayer::bytes_of_new(MortonCode brick) const noexcept {
    return 3 * (hits.nodes_missing(brick) * BrickTree::kNodeBytes + BrickTree::kBrickBytes);
}

std::size_t CountLayer::heap_bytes() const noexcept {
    return hits.memory_bytes() + misses.memory_bytes() + prior.memory_bytes();
}

}  // namespace octoskin
