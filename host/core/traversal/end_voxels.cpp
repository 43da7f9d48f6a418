// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/end_voxels.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/end_voxels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include "host/core/traversal/end_places-inl.hpp"
#include "host/core/traversal/image_bands.hpp"

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// find_places(); reads and writes whole vectors.
void find_end_places(const WordGrid& grid, const std::uint32_t* key_xy, const std::uint32_t* key_z,
                     std::size_t count, std::uint32_t* places, std::uint32_t* bits) {
    find_places(grid, key_xy, key_z, count, places, bits);
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_end_places);

}  // namespace

bool EndVoxels::begin(const KeyBox& box, std::size_t voxels_max, std::size_t parts) {
    const BrickBox bricks = BrickBox::of(box);
    if (bricks.bricks() * kBrickVoxels > voxels_max) return false;
    box_ = bricks;
    parts_.resize(parts);
    for (Part& part : parts_) part.words.assign(kBrickWords * bricks.bricks() + 1, 0);
    return true;
}

void EndVoxels::mark(const ProjectedImage& rays, std::size_t part) {
    Part& own = parts_[part];
    own.places.resize(rays.width + kLanesMax);
    own.bits.resize(own.places.size());
    const WordGrid grid = word_grid_of(box_);
    const std::size_t end = std::size_t{rays.height} * (part + 1) / parts_.size();
    for (std::size_t v = std::size_t{rays.height} * part / parts_.size(); v < end; ++v) {
        HWY_DYNAMIC_DISPATCH(find_end_places)
        (grid, rays.key_xy.data() + v * rays.width, rays.key_z.data() + v * rays.width, rays.width,
         own.places.data(), own.bits.data());
        const auto set = [&](std::size_t u) { own.words[own.places[u]] |= std::uint64_t{1} << own.bits[u]; };
        // Neighbouring pixels often share a word, and each write would wait for the one before.
        const std::size_t quarter = rays.width / 4;
        for (std::size_t u = 0; u < quarter; ++u) {
            set(u);
            set(u + quarter);
            set(u + 2 * quarter);
            set(u + 3 * quarter);
        }
        for (std::size_t u = 4 * quarter; u < rays.width; ++u) set(u);
    }
}

BrickMask EndVoxels::of(MortonCode brick) const noexcept {
    BrickMask mask{};
    const BrickPlace place = BrickPlace::of(key_of_morton(brick));
    if (!box_.holds(place)) return mask;
    const std::size_t first = kBrickWords * box_.index(place);
    for (const Part& part : parts_) {
        for (std::size_t word = 0; word < kBrickWords; ++word) mask[word] |= part.words[first + word];
    }
    return mask;
}

}  // namespace octoskin
#endif
