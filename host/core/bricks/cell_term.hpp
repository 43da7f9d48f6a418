// A log-odds term for one voxel of a brick.
#pragma once

#include <bit>
#include <cstdint>

namespace octoskin {

struct CellTerm {
    std::uint16_t cell = 0;  ///< place in the brick (cell_of)
    float term = 0.0F;
    friend bool operator==(const CellTerm&, const CellTerm&) = default;
};

/// True if the term is neither 0 nor infinite nor NaN.
[[nodiscard]] inline bool is_plain(float term) noexcept {
    constexpr std::uint32_t kInfinity = 0x7F80'0000U;
    const std::uint32_t magnitude = std::bit_cast<std::uint32_t>(term) & 0x7FFF'FFFFU;
    return magnitude - 1U < kInfinity - 1U;
}

}  // namespace octoskin
