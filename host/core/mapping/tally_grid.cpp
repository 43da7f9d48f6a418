#include "host/core/mapping/tally_grid.hpp"

namespace octoskin {

bool TallyGrid::span(const KeyBox& box, std::size_t voxels_max) {
    const std::array<int, 3> size = {box.highest.x - box.lowest.x + 3, box.highest.y - box.lowest.y + 3,
                                     box.highest.z - box.lowest.z + 3};
    // At most 65538 along each axis: the product fits 64 bits.
    const std::size_t voxels = static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                               static_cast<std::size_t>(size[2]);
    if (voxels > voxels_max) return false;
    size_ = size;
    corner_ = {box.lowest.x - 1, box.lowest.y - 1, box.lowest.z - 1};
    stride_ = {1, size[0], std::ptrdiff_t{size[0]} * size[1]};
    if (marks_.size() < voxels) {
        marks_.resize(voxels, 0);
        hit_slots_.resize(voxels, 0);
    }
    hits_.clear();
    return true;
}

void TallyGrid::add_hit(std::ptrdiff_t index, float term) {
    const auto at = static_cast<std::size_t>(index);
    if ((marks_[at] & kIsHit) == 0) {
        marks_[at] |= kIsHit;
        hit_slots_[at] = static_cast<std::uint32_t>(hits_.size());
        hits_.push_back({.hits = 1, .hit_sum = static_cast<double>(term)});
        return;
    }
    VoxelTally& tally = hits_[hit_slots_[at]];
    ++tally.hits;
    tally.hit_sum += static_cast<double>(term);
}

}  // namespace octoskin
