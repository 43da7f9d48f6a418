#include "host/core/mapping/hit_bricks.hpp"

#include <limits>

namespace octoskin {

bool HitBricks::take(const PlacedImage& rays, const KeyBox& box, const HitModel& model,
                     std::size_t voxels_max) {
    box_ = box;
    const auto bricks_along = [](std::uint16_t low, std::uint16_t high) {
        return static_cast<std::size_t>((high >> kBrickHeight) - (low >> kBrickHeight)) + 1;
    };
    bricks_x_ = bricks_along(box.lowest.x, box.highest.x);
    bricks_y_ = bricks_along(box.lowest.y, box.highest.y);
    const std::size_t bricks = bricks_x_ * bricks_y_ * bricks_along(box.lowest.z, box.highest.z);
    if (bricks * kBrickVoxels > voxels_max) return false;

    found_.clear();
    bricks_.clear();
    ends_.assign(bricks, 0);
    for (std::uint32_t v = 0; v < rays.height; ++v) {
        take_row(rays, std::size_t{v} * rays.width, model);
    }
    for (const std::uint32_t brick : bricks_) ++ends_[brick];
    std::uint32_t begin = 0;
    for (std::uint32_t& end : ends_) {
        const std::uint32_t count = end;
        end = begin;  // for now where it begins
        begin += count;
    }
    sorted_.resize(found_.size());
    for (std::size_t i = 0; i < found_.size(); ++i) sorted_[ends_[bricks_[i]]++] = found_[i];
    return true;
}

void HitBricks::take_row(const PlacedImage& rays, std::size_t first, const HitModel& model) {
    std::uint64_t before = ~std::uint64_t{0};  // no voxel
    for (std::size_t i = first; i < first + rays.width; ++i) {
        if (rays.reach_m[i] < 0.0F || rays.range_m[i] < 0.0) continue;
        const float term = model.log_odds(rays.range_m[i]);
        const std::uint64_t voxel = rays.key_xy[i] | std::uint64_t{rays.key_z[i]} << 32U;
        if (voxel == before && found_.back().rays < std::numeric_limits<std::uint16_t>::max()) {
            CellHits& hits = found_.back();
            ++hits.rays;
            hits.sum += term;
            hits.most = term > hits.most ? term : hits.most;
            continue;
        }
        before = voxel;
        const VoxelKey key{static_cast<std::uint16_t>(voxel), static_cast<std::uint16_t>(voxel >> 16U),
                           static_cast<std::uint16_t>(voxel >> 32U)};
        found_.push_back({static_cast<std::uint16_t>(cell_of(key)), 1, term, term});
        bricks_.push_back(static_cast<std::uint32_t>(index_of(key)));
    }
}

std::span<const CellHits> HitBricks::of(MortonCode brick) const noexcept {
    const VoxelKey lowest = key_of_morton(brick);
    if (!do_meet({lowest, kBrickHeight}, box_)) return {};
    const std::size_t at = index_of(lowest);
    const std::size_t begin = at == 0 ? 0 : ends_[at - 1];
    return std::span(sorted_).subspan(begin, ends_[at] - begin);
}

}  // namespace octoskin
