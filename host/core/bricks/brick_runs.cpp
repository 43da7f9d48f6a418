// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/bricks/brick_runs.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/bricks/brick_runs.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

#include "host/core/bricks/brick.hpp"

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<std::uint32_t, 16>;
using Words = hn::Vec<Tag>;

/// An update consists of three words: x and y; z and a gap; the term.
constexpr std::size_t kWords = 3;
static_assert(sizeof(VoxelUpdate) == kWords * sizeof(std::uint32_t) && offsetof(VoxelUpdate, log_odds) == 8);

/// True for a term that is neither 0 nor infinite nor NaN: the bits of its magnitude are at least those of
/// the least number above 0, and less than those of infinity.
HWY_INLINE auto is_plain(Words term) {
    const Tag u;
    const auto magnitude = hn::And(term, hn::Set(u, 0x7FFF'FFFFU));
    return hn::Lt(hn::Sub(magnitude, hn::Set(u, 1)), hn::Set(u, 0x7F80'0000U - 1));
}

/// Spreads the lowest three bits of each half of a word, with two free bits between them: kSpreadInBrick.
HWY_INLINE Words spread_halves(Words word) {
    const Tag u;
    return hn::Or(hn::And(word, hn::Set(u, 0x0001'0001U)),
                  hn::Or(hn::ShiftLeft<2>(hn::And(word, hn::Set(u, 0x0002'0002U))),
                         hn::ShiftLeft<4>(hn::And(word, hn::Set(u, 0x0004'0004U)))));
}

HWY_INLINE Words cells_of(Words xy, Words z) {
    const Tag u;
    const Words x_and_y = spread_halves(xy);
    const Words y = hn::ShiftRight<15>(x_and_y);
    return hn::And(hn::Or(hn::Or(x_and_y, y), hn::ShiftLeft<2>(spread_halves(z))),
                   hn::Set(u, static_cast<std::uint32_t>(kBrickVoxels - 1)));
}

void find_runs(const VoxelUpdate* updates, std::size_t count, BrickRuns& found) {
    const Tag u;
    const std::size_t lanes = hn::Lanes(u);
    const auto in_lane_0 = hn::FirstN(u, 1);
    // Rotates by one lane; lane 0 receives the last lane.
    alignas(64) std::array<std::int32_t, hn::MaxLanes(u)> lane_before;
    for (std::size_t lane = 0; lane < lanes; ++lane)
        lane_before[lane] = static_cast<std::int32_t>((lane + lanes - 1) % lanes);
    const auto one_on = hn::SetTableIndices(u, lane_before.data());
    Words xy_turned_before = hn::Zero(u);
    Words z_turned_before = hn::Set(u, 0xFFFF'FFFFU);  // no brick: the first update begins a run
    std::array<VoxelUpdate, hn::MaxLanes(u)> last;     // padding behind the last update has a term of 0
    std::size_t runs = 0;
    found.updates = 0;
    for (std::size_t begin = 0; begin < count; begin += lanes) {
        const VoxelUpdate* some = updates + begin;
        if (count - begin < lanes) {
            std::copy(some, updates + count, last.begin());
            some = last.data();
        }
        Words xy, z, term;
        hn::LoadInterleaved3(u, reinterpret_cast<const std::uint32_t*>(some), xy, z, term);
        const auto stop = hn::FindFirstTrue(u, hn::Not(is_plain(term)));
        hn::StoreU(cells_of(xy, z), u, found.cell_of.data() + begin);

        const Words xy_brick = hn::And(xy, hn::Set(u, 0xFFF8'FFF8U));
        const Words z_brick = hn::And(z, hn::Set(u, 0xFFF8U));
        const Words xy_turned = hn::TableLookupLanes(xy_brick, one_on);
        const Words z_turned = hn::TableLookupLanes(z_brick, one_on);
        const Words xy_previous = hn::IfThenElse(in_lane_0, xy_turned_before, xy_turned);
        const Words z_previous = hn::IfThenElse(in_lane_0, z_turned_before, z_turned);
        const std::size_t plain = stop < 0 ? lanes : static_cast<std::size_t>(stop);
        const auto begins =
            hn::And(hn::Or(hn::Ne(xy_brick, xy_previous), hn::Ne(z_brick, z_previous)), hn::FirstN(u, plain));
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(u, begins, bytes);
        const std::uint32_t bits = bytes[0] | (std::uint32_t{bytes[1]} << 8U);
        // CompressStore is slower here: for AVX2, GCC copies its table of 1 KiB to the stack, vector by
        // vector.
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            found.first_of[runs] = static_cast<std::uint32_t>(begin + lane);
            runs += bits >> lane & 1U;
        }
        found.updates += plain;
        if (plain < lanes) break;
        xy_turned_before = xy_turned;
        z_turned_before = z_turned;
    }
    found.runs = runs;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_runs);

}  // namespace

void find_runs(std::span<const VoxelUpdate> updates, BrickRuns& found) noexcept {
    HWY_DYNAMIC_DISPATCH(find_runs)
    (updates.data(), std::min(updates.size(), BrickRuns::kUpdatesMax), found);
}

}  // namespace octoskin
#endif
