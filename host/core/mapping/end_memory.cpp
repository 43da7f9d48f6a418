#include "host/core/mapping/end_memory.hpp"

#include <algorithm>
#include <cassert>

#include "host/core/voxels/morton.hpp"

namespace octoskin {
namespace {

MortonCode code_of(const EndMemory::End& end) {
    return morton_of({static_cast<std::uint16_t>(end.key_xy), static_cast<std::uint16_t>(end.key_xy >> 16U),
                      static_cast<std::uint16_t>(end.key_z)});
}

bool has_voxel(const EndMemory::End& end) {
    return end.key_z != ProjectedImage::kNoKey;
}

}  // namespace

void EndMemory::find(const ProjectedImage& image, std::span<const std::uint8_t> restarted,
                     const Evidence& terms, Evidence& retracted) {
    assert(restarted.size() == image.pixels());
    retracted.clear();
    retracted.rule = EvidenceRule::retract;
    retracted.sensor = SensorKind::camera;
    find_left(image, restarted);
    if (!left_.empty()) {
        keep_held(image);
        keep_hit(terms);
    }
    for (const MortonCode code : left_)
        put_in(retracted.last(code - code % kBrickVoxels).voxels, code % kBrickVoxels);
}

void EndMemory::keep(const ProjectedImage& image) {
    ends_.resize(image.pixels());
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        if (image.key_z[i] != ProjectedImage::kNoKey)
            ends_[i] = {image.key_xy[i], image.key_z[i], image.reach_m[i]};
    }
}

void EndMemory::find_left(const ProjectedImage& image, std::span<const std::uint8_t> restarted) {
    left_.clear();
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        const End& last = ends_[i];
        const bool is_elsewhere = image.key_z[i] != last.key_z || image.key_xy[i] != last.key_xy;
        if (!is_elsewhere || image.key_z[i] == ProjectedImage::kNoKey || !has_voxel(last)) continue;
        const bool is_hidden = restarted[i] != 0 && image.reach_m[i] < last.depth_m;
        if (!is_hidden) left_.push_back(code_of(last));
    }
    std::ranges::sort(left_);
    left_.erase(std::unique(left_.begin(), left_.end()), left_.end());
}

/// Pixels without a value now still state what they did.
void EndMemory::keep_held(const ProjectedImage& image) {
    std::vector<MortonCode> held;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        if (image.key_z[i] == ProjectedImage::kNoKey && has_voxel(ends_[i]))
            held.push_back(code_of(ends_[i]));
    }
    std::ranges::sort(held);
    std::erase_if(left_, [&](MortonCode code) { return std::ranges::binary_search(held, code); });
}

void EndMemory::keep_hit(const Evidence& terms) {
    auto brick = terms.bricks.begin();
    std::erase_if(left_, [&](MortonCode code) {
        const MortonCode first = code - code % kBrickVoxels;
        while (brick != terms.bricks.end() && brick->first < first) ++brick;
        if (brick == terms.bricks.end() || brick->first != first) return false;
        const auto cell = static_cast<std::uint16_t>(code % kBrickVoxels);
        return std::ranges::any_of(terms.cells_of(*brick),
                                   [&](const CellTerm& hit) { return hit.cell == cell; });
    });
}

}  // namespace octoskin
