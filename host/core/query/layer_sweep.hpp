// One brick's part of a sweep along y or z: the least sum of a value along the axis and its squared distance.
// Uses the processor's best instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "host/core/bricks/brick.hpp"

namespace octoskin {

/// Squared distances of eight voxels that are adjacent along x.
using DistanceRow = std::array<std::int16_t, kBrickEdge>;
/// One value for each layer of a brick.
using OfLayers = std::array<std::int16_t, kBrickEdge>;
/// A brick's rows, indexed by layer + 8 * place along the axis of a sweep.
using SweptRows = std::array<DistanceRow, std::size_t{kBrickEdge} * kBrickEdge>;

/// The data of a brick before a sweep.
struct UnsweptBrick {
    const SweptRows* rows = nullptr;
    const OfLayers* least = nullptr;
};
/// The swept brick in the middle, and on both sides as many bricks as the reach requires, up to kSideMax.
struct SweepColumn {
    static constexpr int kSideMax = 15;
    std::array<UnsweptBrick, 2 * kSideMax + 1> bricks{};
    int side = 0;
};

/// The least squared distance between voxels of two bricks this many bricks apart.
constexpr int gap_squared(int bricks) noexcept {
    const int voxels = bricks < 0 ? -bricks : bricks;
    return voxels == 0 ? 0 : (kBrickEdge * (voxels - 1) + 1) * (kBrickEdge * (voxels - 1) + 1);
}

/// For each layer whose bit is set in `layers`: each value becomes the least sum of a value along the axis
/// and the square of its distance, and at most `beyond`. `largest` becomes the largest value of the layer.
/// Other layers are left unchanged or swept too. `beyond`: at most 120 * 120 + 1, and no value exceeds it.
/// About 50 ns per layer.
void sweep_layers(const SweepColumn& column, unsigned layers, std::int16_t beyond, SweptRows& rows,
                  OfLayers& largest) noexcept;

}  // namespace octoskin
