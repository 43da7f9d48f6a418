// Positions of ray ends in the words of a box's bricks. Included once for each instruction set (see Highway's
// foreach_target.h, which comes before).
#ifndef OCTOSKIN_END_PLACES_TYPES
#define OCTOSKIN_END_PLACES_TYPES

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_box.hpp"
#include "host/core/traversal/projected_image.hpp"

namespace octoskin {

inline constexpr std::size_t kBrickWords = std::tuple_size_v<BrickMask>;

/// Positions of the words of a box's bricks.
struct WordGrid {
    std::array<std::uint32_t, 3> lowest;  ///< brick
    std::array<std::uint32_t, 3> steps;   ///< words from one brick to the next along each axis
    std::uint32_t nowhere = 0;            ///< for rays without an end at a surface
};

/// The words are those of the bricks in BrickBox::index()'s order, and a last one for no voxel.
[[nodiscard]] inline WordGrid word_grid_of(const BrickBox& box) {
    const auto number = [](auto value) { return static_cast<std::uint32_t>(value); };
    return {.lowest = {number(box.lowest.at[0]), number(box.lowest.at[1]), number(box.lowest.at[2])},
            .steps = {number(kBrickWords), number(kBrickWords * box.edge(0)),
                      number(kBrickWords * box.edge(0) * box.edge(1))},
            .nowhere = number(kBrickWords * box.bricks())};
}

}  // namespace octoskin
#endif

#if defined(OCTOSKIN_END_PLACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOSKIN_END_PLACES_INL
#undef OCTOSKIN_END_PLACES_INL
#else
#define OCTOSKIN_END_PLACES_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Finds the word and the bit of the voxel in which each of `count` pixels' rays ends. Reads and writes whole
/// vectors.
HWY_INLINE void find_places(const WordGrid& grid, const std::uint32_t* key_xy, const std::uint32_t* key_z,
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

#endif
