// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/end_voxels.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/end_voxels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <array>
#include <tuple>

#include "host/core/traversal/image_bands.hpp"

#ifndef OCTOSKIN_END_VOXELS_TYPES
#define OCTOSKIN_END_VOXELS_TYPES
namespace octoskin {

/// Positions of the words of a box's bricks.
struct WordGrid {
    std::array<std::uint32_t, 3> lowest;  ///< brick
    std::array<std::uint32_t, 3> steps;   ///< words from one brick to the next along each axis
    std::uint32_t nowhere = 0;            ///< for rays without an end at a surface
};

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Finds the word and the bit of the voxel in which each of `count` pixels' rays ends. Reads and writes whole
/// vectors.
void find_places(const WordGrid& grid, const std::uint32_t* key_xy, const std::uint32_t* key_z,
                 std::size_t count, std::uint32_t* places, std::uint32_t* bits) {
    const hn::CappedTag<std::uint32_t, 16> k;
    const auto mask = [&](auto keys, std::uint32_t bit) HWY_ATTR { return hn::And(keys, hn::Set(k, bit)); };
    const auto words_to = [&](auto keys, std::size_t axis) HWY_ATTR {
        const auto bricks = hn::Sub(hn::ShiftRight<kBrickHeight>(keys), hn::Set(k, grid.lowest[axis]));
        return hn::Mul(bricks, hn::Set(k, grid.steps[axis]));
    };
    // Moves bits 0 and 1 to 0 and 3: Morton order.
    const auto spread = [&](auto keys)
                            HWY_ATTR { return hn::Or(mask(keys, 1), hn::ShiftLeft<2>(mask(keys, 2))); };
    for (std::size_t i = 0; i < count; i += hn::Lanes(k)) {
        const auto xy = hn::LoadU(k, key_xy + i);
        const auto x = mask(xy, 0xFFFF);
        const auto y = hn::ShiftRight<16>(xy);
        const auto z = hn::LoadU(k, key_z + i);
        const auto brick = hn::Add(hn::Add(words_to(x, 0), words_to(y, 1)), words_to(z, 2));
        const auto word =
            hn::Or(hn::Or(hn::ShiftRight<2>(mask(x, 4)), hn::ShiftRight<1>(mask(y, 4))), mask(z, 4));
        const auto has_end = hn::Ne(z, hn::Set(k, ProjectedImage::kNoKey));
        hn::StoreU(hn::IfThenElse(has_end, hn::Add(brick, word), hn::Set(k, grid.nowhere)), k, places + i);
        hn::StoreU(hn::Or(hn::Or(spread(x), hn::ShiftLeft<1>(spread(y))), hn::ShiftLeft<2>(spread(z))), k,
                   bits + i);
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_places);

constexpr std::size_t kWords = std::tuple_size_v<BrickMask>;

}  // namespace

bool EndVoxels::begin(const KeyBox& box, std::size_t voxels_max, std::size_t parts) {
    const BrickBox bricks = BrickBox::of(box);
    if (bricks.bricks() * kBrickVoxels > voxels_max) return false;
    box_ = bricks;
    parts_.resize(parts);
    for (Part& part : parts_) part.words.assign(kWords * bricks.bricks() + 1, 0);
    return true;
}

void EndVoxels::mark(const ProjectedImage& rays, std::size_t part) {
    Part& own = parts_[part];
    own.places.resize(rays.width + kLanesMax);
    own.bits.resize(own.places.size());
    const auto number = [](auto value) { return static_cast<std::uint32_t>(value); };
    const WordGrid grid{
        .lowest = {number(box_.lowest.at[0]), number(box_.lowest.at[1]), number(box_.lowest.at[2])},
        .steps = {number(kWords), number(kWords * box_.edge(0)),
                  number(kWords * box_.edge(0) * box_.edge(1))},
        .nowhere = number(own.words.size() - 1)};
    const std::size_t end = std::size_t{rays.height} * (part + 1) / parts_.size();
    for (std::size_t v = std::size_t{rays.height} * part / parts_.size(); v < end; ++v) {
        HWY_DYNAMIC_DISPATCH(find_places)
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
    const std::size_t first = kWords * box_.index(place);
    for (const Part& part : parts_) {
        for (std::size_t word = 0; word < kWords; ++word) mask[word] |= part.words[first + word];
    }
    return mask;
}

}  // namespace octoskin
#endif
