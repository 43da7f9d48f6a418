#include "host/core/mapping/depth_terms.hpp"

#include <algorithm>

#include "host/core/bricks/brick_sets.hpp"

namespace octoskin {

BrickTerms& DepthTerms::last(MortonCode brick) {
    if (bricks.empty() || bricks.back().first != brick) {
        const auto begin = static_cast<std::uint32_t>(hits.size());
        bricks.push_back({.first = brick, .passed = {}, .hits_begin = begin, .hits_end = begin});
    }
    return bricks.back();
}

void DepthTerms::add(MortonCode brick, const BrickMask& passed) {
    const bool is_empty = std::ranges::all_of(passed, [](std::uint64_t word) { return word == 0; });
    if (!is_empty && miss != 0.0F) last(brick).passed = passed;
}

void DepthTerms::add_hit(MortonCode brick, CellTerm hit) {
    if (hit.log_odds == 0.0F) return;
    BrickTerms& terms = last(brick);
    hits.push_back(hit);
    terms.hits_end = static_cast<std::uint32_t>(hits.size());
}

void DepthTerms::append(const DepthTerms& later) {
    assert(miss == later.miss);
    assert(bricks.empty() || later.bricks.empty() || bricks.back().first < later.bricks.front().first);
    const auto shift = static_cast<std::uint32_t>(hits.size());
    for (BrickTerms brick : later.bricks) {
        brick.hits_begin += shift;
        brick.hits_end += shift;
        bricks.push_back(brick);
    }
    hits.insert(hits.end(), later.hits.begin(), later.hits.end());
}

void DepthTerms::take(std::vector<VoxelUpdate> updates) {
    std::ranges::sort(updates, {}, [](const VoxelUpdate& update) { return morton_of(update.key); });
    for (const VoxelUpdate& update : updates) {
        const MortonCode brick = brick_of(update.key);
        const std::size_t cell = cell_of(update.key);
        if (update.log_odds != miss) {
            add_hit(brick, {static_cast<std::uint16_t>(cell), update.log_odds});
        } else if (miss != 0.0F) {
            put_in(last(brick).passed, cell);
        }
    }
}

float DepthTerms::of(VoxelKey key) const noexcept {
    const auto brick = std::ranges::lower_bound(bricks, brick_of(key), {}, &BrickTerms::first);
    if (brick == bricks.end() || brick->first != brick_of(key)) return 0.0F;
    const std::size_t cell = cell_of(key);
    if (contains(brick->passed, cell)) return miss;
    const auto own = hits_of(*brick);
    const auto hit =
        std::ranges::find(own, cell, [](const CellTerm& term) { return std::size_t{term.cell}; });
    return hit == own.end() ? 0.0F : hit->log_odds;
}

std::size_t DepthTerms::size() const noexcept {
    std::size_t size = hits.size();
    for (const BrickTerms& brick : bricks) size += count_of(brick.passed);
    return size;
}

}  // namespace octoskin
