// Compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/query/layer_sweep.cpp"

// clang-format off: this order is Highway's.
#include "host/core/query/layer_sweep.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cassert>

#ifndef OCTOSKIN_LAYER_SWEEP_SQUARES
#define OCTOSKIN_LAYER_SWEEP_SQUARES
namespace octoskin {

constexpr std::size_t kLanesMax = 16;
constexpr std::size_t kRowsAPlace = kBrickEdge;  // one of each layer
constexpr std::size_t kSteps = std::size_t{kBrickEdge} * (SweepColumn::kSideMax + 1);

/// The square of a number of voxels, in all lanes.
struct alignas(32) SquareTable {
    std::array<std::array<std::int16_t, kLanesMax>, kSteps> of{};
    constexpr SquareTable() {
        for (std::size_t step = 0; step < kSteps; ++step)
            of[step].fill(static_cast<std::int16_t>(step * step));
    }
};
inline constexpr SquareTable kSquares;

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using ValueTag = hn::CappedTag<std::int16_t, kLanesMax>;
/// Sweeps the layers from `first` on, as many as a vector holds. It works outwards until a brick is too far
/// away to lower any voxel's value. Vectors are separate variables, because some instruction sets have no
/// arrays of vectors.
void sweep_some(const SweepColumn& column, std::size_t first, std::int16_t beyond, SweptRows& rows,
                OfLayers& largest) {
    const ValueTag d;
    const std::size_t layers = hn::Lanes(d) / kBrickEdge;
    const auto most = hn::Set(d, beyond);
    auto least0 = most, least1 = most, least2 = most, least3 = most;
    auto least4 = most, least5 = most, least6 = most, least7 = most;
    auto worst = most;
    int worst_of_all = beyond;
    const auto take = [&](int bricks) {
        const UnsweptBrick& source = column.bricks[static_cast<std::size_t>(column.side + bricks)];
        int nearest = (*source.least)[first];
        for (std::size_t layer = 1; layer < layers; ++layer)
            nearest = std::min(nearest, int{(*source.least)[first + layer]});
        if (nearest + gap_squared(bricks) >= worst_of_all) return;
        for (int from = 0; from < kBrickEdge; ++from) {
            const auto value =
                hn::LoadU(d, (*source.rows)[first + kRowsAPlace * static_cast<std::size_t>(from)].data());
            const auto come_to = [&](int to) {
                const int steps = kBrickEdge * bricks + from - to;
                const auto& square = kSquares.of[static_cast<std::size_t>(steps < 0 ? -steps : steps)];
                return hn::Add(value, hn::LoadU(d, square.data()));
            };
            least0 = hn::Min(least0, come_to(0));
            least1 = hn::Min(least1, come_to(1));
            least2 = hn::Min(least2, come_to(2));
            least3 = hn::Min(least3, come_to(3));
            least4 = hn::Min(least4, come_to(4));
            least5 = hn::Min(least5, come_to(5));
            least6 = hn::Min(least6, come_to(6));
            least7 = hn::Min(least7, come_to(7));
        }
        worst = hn::Max(hn::Max(hn::Max(least0, least1), hn::Max(least2, least3)),
                        hn::Max(hn::Max(least4, least5), hn::Max(least6, least7)));
        worst_of_all = hn::GetLane(hn::MaxOfLanes(d, worst));
    };
    take(0);
    for (int bricks = 1; bricks <= column.side && gap_squared(bricks) < worst_of_all; ++bricks) {
        take(bricks);
        take(-bricks);
    }
    const auto put = [&](const auto& least, std::size_t along) {
        hn::StoreU(least, d, rows[first + kRowsAPlace * along].data());
    };
    put(least0, 0);
    put(least1, 1);
    put(least2, 2);
    put(least3, 3);
    put(least4, 4);
    put(least5, 5);
    put(least6, 6);
    put(least7, 7);
    std::array<std::int16_t, kLanesMax> of_lanes{};
    hn::StoreU(worst, d, of_lanes.data());
    for (std::size_t layer = 0; layer < layers; ++layer) {
        const std::int16_t* const begin = of_lanes.data() + kRowsAPlace * layer;
        largest[first + layer] = *std::max_element(begin, begin + kBrickEdge);
    }
}

void sweep_layers(const SweepColumn& column, unsigned layers, std::int16_t beyond, SweptRows& rows,
                  OfLayers& largest) {
    const std::size_t at_once = hn::Lanes(ValueTag()) / kBrickEdge;
    const unsigned some = (1U << at_once) - 1U;
    for (std::size_t first = 0; first < static_cast<std::size_t>(kBrickEdge); first += at_once)
        if ((layers >> first & some) != 0) sweep_some(column, first, beyond, rows, largest);
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(sweep_layers);

}  // namespace

void sweep_layers(const SweepColumn& column, unsigned layers, std::int16_t beyond, SweptRows& rows,
                  OfLayers& largest) noexcept {
    assert(column.side >= 0 && column.side <= SweepColumn::kSideMax);
    HWY_DYNAMIC_DISPATCH(sweep_layers)(column, layers, beyond, rows, largest);
}

}  // namespace octoskin
#endif
