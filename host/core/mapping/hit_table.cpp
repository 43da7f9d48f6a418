#include "host/core/mapping/hit_table.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

namespace octoskin {

void HitTable::begin(std::size_t hits_max) {
    runs_.clear();
    runs_.reserve(hits_max);
}

void HitTable::add(std::ptrdiff_t voxel, float term) noexcept {
    const auto index = static_cast<std::uint32_t>(voxel);
    if (!runs_.empty() && runs_.back().voxel == index) {
        runs_.back().term = std::max(runs_.back().term, term);
    } else {
        runs_.push_back({index, term});
    }
}

void HitTable::finish() {
    slots_.assign(std::bit_ceil(2 * std::max<std::size_t>(runs_.size(), 1)), Hit());
    for (const Hit& run : runs_) {
        Hit& slot = slots_[slot_of(run.voxel)];
        slot = {run.voxel, slot.voxel == kNone ? run.term : std::max(slot.term, run.term)};
    }
}

/// Fibonacci hashing: neighbours, which come together, are spread far.
std::size_t HitTable::slot_of(std::uint32_t voxel) const noexcept {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = ((voxel * 0x9E3779B97F4A7C15ULL) >> 32U) & mask;
    while (slots_[slot].voxel != kNone && slots_[slot].voxel != voxel) slot = (slot + 1) & mask;
    return slot;
}

float HitTable::largest(std::ptrdiff_t voxel) const noexcept {
    const Hit& hit = slots_[slot_of(static_cast<std::uint32_t>(voxel))];
    assert(hit.voxel == static_cast<std::uint32_t>(voxel));
    return hit.term;
}

}  // namespace octoskin
