// Operations on sets of a brick's voxels, and sets of voxels by value.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "host/core/bricks/brick.hpp"

namespace octoskin {

[[nodiscard]] inline bool contains(const BrickMask& mask, std::size_t cell) noexcept {
    return (mask[cell / 64] >> (cell % 64) & 1U) != 0;
}

inline void put_in(BrickMask& mask, std::size_t cell) noexcept {
    mask[cell / 64] |= std::uint64_t{1} << (cell % 64);
}

/// Calls visit(cell) for each voxel of the set, in ascending order.
template <class Visit>
void for_each_cell(const BrickMask& mask, const Visit& visit) {
    for (std::size_t word = 0; word < mask.size(); ++word)
        for (std::uint64_t voxels = mask[word]; voxels != 0; voxels &= voxels - 1)
            visit(64 * word + static_cast<std::size_t>(std::countr_zero(voxels)));
}

[[nodiscard]] inline std::size_t count_of(const BrickMask& mask) noexcept {
    std::size_t count = 0;
    for (const std::uint64_t word : mask) count += static_cast<std::size_t>(std::popcount(word));
    return count;
}

[[nodiscard]] inline bool is_whole(const BrickMask& mask) noexcept {
    for (const std::uint64_t word : mask)
        if (word != ~std::uint64_t{0}) return false;
    return true;
}

/// Sets of 64 voxels of a brick, each as a word of a BrickMask: bit i is voxel i.
struct WordSets {
    std::uint64_t known = 0;
    std::uint64_t at_least = 0;  ///< known, and with at least the given value
};

/// The sets of the 64 voxels from 64 * `word` on; `word` is below 8. The result is the same on every
/// processor. About 10 ns.
[[nodiscard]] WordSets sets_of(const BrickValues& values, std::size_t word, float at_least) noexcept;

}  // namespace octoskin
