// One brick's share of a sweep along y or z: the least of what lies along the axis, and how far away. On the
// processor's best instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "host/core/bricks/brick.hpp"

namespace octoskin {

/// Squared distances of eight voxels that lie side by side along x.
using DistanceRow = std::array<std::int16_t, kBrickEdge>;
/// Of each layer of a brick something.
using OfLayers = std::array<std::int16_t, kBrickEdge>;
/// A brick's rows, by layer + 8 * place along the axis of a sweep.
using SweptRows = std::array<DistanceRow, std::size_t{kBrickEdge} * kBrickEdge>;

/// What a brick holds before a sweep.
struct UnsweptBrick {
    const SweptRows* rows = nullptr;
    const OfLayers* least = nullptr;
};
/// The brick that is swept, in the middle, and as many on both sides as the reach wants, up to kSideMax.
struct SweepColumn {
    static constexpr int kSideMax = 15;
    std::array<UnsweptBrick, 2 * kSideMax + 1> bricks{};
    int side = 0;
};

/// The least square that is added between two bricks so many further on.
constexpr int gap_squared(int bricks) noexcept {
    const int voxels = bricks < 0 ? -bricks : bricks;
    return voxels == 0 ? 0 : (kBrickEdge * (voxels - 1) + 1) * (kBrickEdge * (voxels - 1) + 1);
}

/// Of each layer whose bit is set in `layers`: every row's values become the least of those along the axis,
/// each with the square of its distance added, and of `beyond`; `largest` of the layer's. Others are left or
/// treated alike. `beyond`: at most 120 * 120 + 1, and no value is more. Some 50 ns a layer.
void sweep_layers(const SweepColumn& column, unsigned layers, std::int16_t beyond, SweptRows& rows,
                  OfLayers& largest) noexcept;

}  // namespace octoskin
