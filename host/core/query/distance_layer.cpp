#include "host/core/query/distance_layer.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

namespace octoskin {
namespace {

constexpr std::uint64_t kAllOfSlice = ~std::uint64_t{0};
constexpr std::uint64_t kRowBits = 0xFF;

constexpr int square(int value) {
    return value * value;
}
constexpr int bricks_of(int voxels) {
    return (voxels + kBrickEdge - 1) / kBrickEdge;
}
static_assert(bricks_of(DistanceLayer::kReachMax) <= SweepColumn::kSideMax);

bool hold_the_same(const DistanceRow& a, const DistanceRow& b) {
    using Words = std::array<std::uint64_t, 2>;
    return std::bit_cast<Words>(a) == std::bit_cast<Words>(b);
}
/// Compilers reduce it to one wide instruction.
void lower(DistanceRow& least, const DistanceRow& values) {
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], values[i]);
}
std::int16_t least_of(const DistanceRow& row) {
    return *std::ranges::min_element(row);
}
std::int16_t largest_of(const DistanceRow& row) {
    return *std::ranges::max_element(row);
}

template <class Visit>
void for_each_bit(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

constexpr Axis after(Axis axis) {
    return axis == Axis::x ? Axis::y : Axis::z;
}

}  // namespace

DistanceLayer::DistanceLayer(bool is_site_elsewhere, int reach, const BrickBox& region)
    : reach_(reach),
      brick_reach_(bricks_of(reach)),
      beyond_(static_cast<Value>(square(reach) + 1)),
      sites_(sites_box(region, reach)),
      stages_{Stage(region.wider(Axis::y, brick_reach_).wider(Axis::z, brick_reach_)),
              Stage(region.wider(Axis::z, brick_reach_)), Stage(region)} {
    assert(reach >= 1 && reach <= kReachMax);
    plain_sites_.fill(is_site_elsewhere ? kAllOfSlice : 0);
    const Value elsewhere = is_site_elsewhere ? Value{0} : beyond_;
    for (DistanceRow& row : plain_.rows) row.fill(elsewhere);
    plain_.least.fill(elsewhere);
    plain_.largest.fill(elsewhere);
}

BrickBox DistanceLayer::sites_box(const BrickBox& region, int reach) noexcept {
    const int bricks = bricks_of(reach);
    return region.wider(Axis::x, bricks).wider(Axis::y, bricks).wider(Axis::z, bricks);
}

bool DistanceLayer::set_sites(const BrickPlace& brick, const SiteSlices& sites) {
    const SiteSlices& before = sites_of(brick);
    std::uint64_t rows = 0;
    for (std::size_t z = 0; z < kEdge; ++z)
        for (std::size_t y = 0; y < kEdge; ++y)
            if (((before[z] ^ sites[z]) >> (kEdge * y) & kRowBits) != 0)
                rows |= std::uint64_t{1} << row_of(Axis::x, y, z);
    if (rows == 0) return false;
    if (sites == plain_sites_) {
        sites_.take_away(sites_.index(brick));
    } else {
        sites_.open(sites_.index(brick), sites) = sites;
    }
    spread_sites(brick, rows);
    return true;
}

void DistanceLayer::want(Stage& stage, const BrickPlace& brick, std::uint64_t parts) {
    if (parts == 0) return;
    const std::size_t index = stage.values.index(brick);
    if (stage.due[index] == 0) stage.bricks_due.push_back(index);
    stage.due[index] |= parts;
}

/// A site affects a row if one of the row's voxels has no nearer site.
void DistanceLayer::spread_sites(const BrickPlace& brick, std::uint64_t rows) {
    Stage& first = stage(Axis::x);
    for (int step = -brick_reach_; step <= brick_reach_; ++step) {
        const BrickPlace target = brick.moved(Axis::x, step);
        if (!first.values.box().holds(target)) continue;
        const int nearest = std::min(gap_squared(step), square(reach_));
        const Values& values = values_of(Axis::x, target);
        std::uint64_t matter = 0;
        for_each_bit(rows, [&](std::size_t row) {
            if (largest_of(values.rows[row]) >= nearest) matter |= std::uint64_t{1} << row;
        });
        want(first, target, matter);
    }
}

/// Values can change only in layers in which some voxel's value is not less than the distance via this brick:
/// older values may come from removed sites, and new ones may arrive.
void DistanceLayer::spread(Axis next, const BrickPlace& brick, const Change& change) {
    Stage& wanted = stage(next);
    for (int step = -brick_reach_; step <= brick_reach_; ++step) {
        const BrickPlace target = brick.moved(next, step);
        if (!wanted.values.box().holds(target)) continue;
        const int further = gap_squared(step);
        const OfLayers& largest = values_of(next, target).largest;
        std::uint64_t matter = 0;
        for_each_bit(change.layers, [&](std::size_t layer) {
            const int comes = change.least[layer] + further;
            if (comes <= square(reach_) && comes <= largest[layer]) matter |= std::uint64_t{1} << layer;
        });
        want(wanted, target, matter);
    }
}

/// Changes propagate along x, then y, then z: each sweep begins with the changes of the one before.
std::size_t DistanceLayer::settle() {
    std::size_t worked = 0;
    for (const Axis axis : {Axis::x, Axis::y, Axis::z}) worked += sweep_due(axis);
    return worked;
}

std::size_t DistanceLayer::sweep_due(Axis axis) {
    std::size_t worked = 0;
    Stage& swept = stage(axis);
    const std::vector<std::size_t> bricks = std::exchange(swept.bricks_due, {});
    SweptRows rows;
    for (const std::size_t index : bricks) {
        const std::uint64_t due = std::exchange(swept.due[index], 0);
        const BrickPlace brick = swept.values.place(index);
        OfLayers largest = values_of(axis, brick).largest;
        std::uint64_t swept_rows = due;
        if (axis == Axis::x) {
            sweep_x(brick, due, rows);
        } else {
            swept_rows = sweep(axis, brick, static_cast<unsigned>(due), rows, largest);
        }
        worked += static_cast<std::size_t>(std::popcount(swept_rows) + 7) / kEdge;
        const Change change = take(swept, index, swept_rows, rows, largest);
        if (change.layers != 0 && axis != Axis::z) spread(after(axis), brick, change);
    }
    return worked;
}

/// Distance from each voxel to the nearest site of its row: in the brick itself, and in the first brick on
/// each side with a site.
void DistanceLayer::sweep_x(const BrickPlace& brick, std::uint64_t rows, SweptRows& swept) const {
    std::array<const SiteSlices*, 2 * SweepColumn::kSideMax + 1> column{};
    const auto middle = static_cast<std::size_t>(brick_reach_);
    for (std::size_t i = 0; i <= 2 * middle; ++i)
        column[i] = &sites_of(brick.moved(Axis::x, static_cast<int>(i) - brick_reach_));
    for_each_bit(rows, [&](std::size_t row) {
        const std::size_t y = row / kEdge;
        const std::size_t z = row % kEdge;
        const auto row_in = [&](std::size_t place) {
            return static_cast<unsigned>((*column[place])[z] >> (kEdge * y) & kRowBits);
        };
        DistanceRow nearest;
        nearest.fill(static_cast<Value>(reach_ + 1));
        const auto take_site = [&](int site) {
            for (std::size_t x = 0; x < kEdge; ++x) {
                const auto steps = static_cast<Value>(std::abs(static_cast<int>(x) - site));
                nearest[x] = std::min(nearest[x], steps);
            }
        };
        for_each_bit(row_in(middle), [&](std::size_t x) { take_site(static_cast<int>(x)); });
        for (std::size_t step = 1; step <= middle; ++step) {
            const unsigned below = row_in(middle - step);
            if (below == 0) continue;
            take_site(static_cast<int>(std::bit_width(below)) - 1 - kBrickEdge * static_cast<int>(step));
            break;
        }
        for (std::size_t step = 1; step <= middle; ++step) {
            const unsigned above = row_in(middle + step);
            if (above == 0) continue;
            take_site(std::countr_zero(above) + kBrickEdge * static_cast<int>(step));
            break;
        }
        for (std::size_t x = 0; x < kEdge; ++x)
            swept[row][x] = std::min(static_cast<Value>(nearest[x] * nearest[x]), beyond_);
    });
}

/// Sweeps some layers along y or z and returns their rows.
std::uint64_t DistanceLayer::sweep(Axis axis, const BrickPlace& brick, unsigned layers, SweptRows& swept,
                                   OfLayers& largest) const {
    const Axis before = axis == Axis::y ? Axis::x : Axis::y;
    SweepColumn column;
    column.side = brick_reach_;
    for (int step = -brick_reach_; step <= brick_reach_; ++step) {
        const Values& values = values_of(before, brick.moved(axis, step));
        column.bricks[static_cast<std::size_t>(step + brick_reach_)] = {&values.rows, &values.least};
    }
    constexpr std::uint64_t kOfEachPlace = 0x0101'0101'0101'0101U;
    if (axis == Axis::z) {
        sweep_layers(column, layers, beyond_, swept, largest);
        return layers * kOfEachPlace;
    }
    SweptRows by_layer;
    sweep_layers(column, layers, beyond_, by_layer, largest);
    std::uint64_t rows = 0;
    for_each_bit(layers, [&](std::size_t z) {
        for (std::size_t y = 0; y < kEdge; ++y) swept[y + kEdge * z] = by_layer[z + kEdge * y];
        rows |= kRowBits << (kEdge * z);
    });
    return rows;
}

/// Copies changed values into the brick. Before and after this sweep, the layer of the next sweep is the
/// row's index modulo eight.
DistanceLayer::Change DistanceLayer::take(Stage& stage, std::size_t index, std::uint64_t rows,
                                          const SweptRows& swept, const OfLayers& largest) {
    const Values* const there = stage.values[index];
    const Values& before = there != nullptr ? *there : plain_;
    std::uint64_t changed = 0;
    for_each_bit(rows, [&](std::size_t row) {
        if (!hold_the_same(swept[row], before.rows[row])) changed |= std::uint64_t{1} << row;
    });
    Change change;
    if (changed == 0) return change;
    Values& values = stage.values.open(index, plain_);
    values.largest = largest;
    std::array<DistanceRow, kEdge> least;
    for_each_bit(changed, [&](std::size_t row) {
        const std::size_t layer = row % kEdge;
        if ((change.layers >> layer & 1U) == 0) least[layer] = swept[row];
        change.layers |= std::uint64_t{1} << layer;
        lower(least[layer], swept[row]);
        lower(least[layer], values.rows[row]);
        values.rows[row] = swept[row];
    });
    for_each_bit(change.layers, [&](std::size_t layer) {
        change.least[layer] = least_of(least[layer]);
        DistanceRow of_layer = values.rows[layer];
        for (std::size_t along = 1; along < kEdge; ++along)
            lower(of_layer, values.rows[layer + kEdge * along]);
        values.least[layer] = least_of(of_layer);
    });
    if (std::ranges::equal(values.rows, plain_.rows, hold_the_same)) stage.values.take_away(index);
    return change;
}

template <class IsNearest>
std::optional<VoxelKey> DistanceLayer::step_to(VoxelKey key, Axis axis, const IsNearest& is_nearest) const {
    std::uint16_t& along = axis == Axis::x ? key.x : axis == Axis::y ? key.y : key.z;
    const int middle = along;
    for (int step = 0; step <= reach_; ++step) {
        for (const int at : {middle - step, middle + step}) {
            if (at < 0 || at >= kVoxelsPerAxis) continue;
            along = static_cast<std::uint16_t>(at);
            if (is_nearest(key, square(step))) return key;
        }
    }
    return std::nullopt;
}

/// Follows the value back along z, y and x to its source.
std::optional<VoxelKey> DistanceLayer::nearest(VoxelKey key) const noexcept {
    const int all = value_at(Axis::z, key);
    if (all >= beyond_) return std::nullopt;
    const auto in_layer = step_to(
        key, Axis::z, [&](VoxelKey at, int squared) { return value_at(Axis::y, at) + squared == all; });
    if (!in_layer) return std::nullopt;
    const int of_layer = value_at(Axis::y, *in_layer);
    const auto in_row = step_to(*in_layer, Axis::y, [&](VoxelKey at, int squared) {
        return value_at(Axis::x, at) + squared == of_layer;
    });
    if (!in_row) return std::nullopt;
    const int of_row = value_at(Axis::x, *in_row);
    return step_to(*in_row, Axis::x,
                   [&](VoxelKey at, int squared) { return squared == of_row && is_site(at); });
}

std::size_t DistanceLayer::memory_bytes() const noexcept {
    std::size_t bytes = sites_.memory_bytes();
    for (const Stage& stage : stages_)
        bytes += stage.values.memory_bytes() + stage.due.size() * sizeof(std::uint64_t);
    return bytes;
}

}  // namespace octoskin
