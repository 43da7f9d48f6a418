#include "host/core/mapping/brick_editor.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "host/core/bricks/brick_sets.hpp"

namespace octoskin {
namespace {

/// Time stamps of voxels that expire.
struct Due {
    std::uint16_t first = 0;  ///< the earliest
    std::uint16_t limit = 0;  ///< above the latest
};

/// Of now, or of when `passed_s` more seconds have passed.
Due due_of(const VoxelAges& ages, std::uint32_t unknown_after_s, std::int64_t passed_s = 0) {
    const std::int64_t rest_s = std::int64_t{unknown_after_s} - passed_s;
    // Voxels measured before the clock began have aged since it began.
    const bool takes_all = ages.runs_for_s() >= rest_s;
    const auto first = static_cast<std::uint16_t>(takes_all ? 1 : VoxelAges::kOfBefore + 1);
    return {first, ages.stamp_before(static_cast<std::uint32_t>(std::max<std::int64_t>(rest_s, 0)))};
}

/// The brick's voxels with a time stamp of at least `first` and below `limit`.
BrickMask stamped_from_to(const StampView& view, std::uint16_t first, std::uint16_t limit) {
    BrickMask voxels{};
    if (view.values == nullptr) {
        if (view.value >= first && view.value < limit) voxels.fill(~std::uint64_t{0});
        return voxels;
    }
    for (std::size_t word = 0; word < voxels.size(); ++word) {
        const std::uint64_t below = stamps_below(*view.values, word, limit);
        voxels[word] = below == 0 ? 0 : below & ~stamps_below(*view.values, word, first);
    }
    return voxels;
}

BrickMask known_in(const BrickView& view) {
    BrickMask known{};
    if (view.values == nullptr) {
        known.fill(~std::uint64_t{0});
        return known;
    }
    for (std::size_t word = 0; word < known.size(); ++word)
        known[word] = sets_of(*view.values, word, 0.0F).known;
    return known;
}

BrickTree clamped_tree(const BrickTree& tree, const VoxelRules& rules) {
    const auto clamp = [&](float& log_odds) {  // a NaN (unknown voxel) stays a NaN
        log_odds = rules.clamped(log_odds);
    };
    BrickTree clamped = tree;
    tree.for_each([&](MortonCode brick, const BrickView& view) {
        if (view.values != nullptr) {
            std::ranges::for_each(clamped.open(brick), clamp);
        } else {
            clamped.set_all(brick, rules.clamped(view.value));
        }
    });
    return clamped;
}

/// Shares of the memory limit, in sixteenths.
constexpr std::size_t kCountShare = 3;
constexpr std::size_t kAgeShare = 9;

/// The smallest limit of which this share holds `bytes`.
constexpr std::size_t limit_for(std::size_t bytes, std::size_t share) {
    return (16 * bytes + share - 1) / share;
}

}  // namespace

std::size_t bytes_needed(const MapLayers& layers) noexcept {
    return std::max(bytes_at_most(layers.log_odds), limit_for(layers.counts.bytes_at_most(), kCountShare));
}

std::size_t bytes_at_most(const BrickTree& tree) noexcept {
    return tree.nodes() * BrickTree::kNodeBytes + tree.bricks() * BrickTree::kBrickBytes;
}

bool BrickEditor::has_room_for(MortonCode brick) const noexcept {
    const std::size_t more =
        layers_.log_odds.nodes_missing(brick) * BrickTree::kNodeBytes + BrickTree::kBrickBytes;
    return bytes_at_most(layers_.log_odds) + more <= bytes_max();
}

bool BrickEditor::has_room_to_count(MortonCode brick) const noexcept {
    const CountLayer& counts = layers_.counts;
    return limit_for(counts.bytes_at_most() + counts.bytes_of_new(brick), kCountShare) <= bytes_max();
}

bool BrickEditor::has_room_to_date(MortonCode brick) const noexcept {
    const VoxelAges& ages = layers_.ages;
    return limit_for(ages.bytes_at_most() + ages.bytes_of_new(brick), kAgeShare) <= bytes_max();
}

Status<MapRefusal> BrickEditor::open_counts(MortonCode brick) noexcept {
    CountLayer& counts = layers_.counts;
    const bool is_new = !counts.has(brick);
    if (is_new && !has_room_to_count(brick)) return unexpected(&MapCounters::no_room);
    try {
        if (is_new) counts.begin(brick, layers_.log_odds.find(brick));
        (void)counts.misses.open(brick);
        (void)counts.hits.open(brick);
        return Done{};
    } catch (const std::bad_alloc&) {
        return unexpected(&MapCounters::no_memory);
    }
}

void BrickEditor::date(MortonCode brick, const BrickMask& voxels, SensorKind kind) noexcept {
    VoxelAges& ages = layers_.ages;
    // A brick without any time stamp would leave the agenda, and what it gets later would never expire.
    if (!ages.has_begun() || voxels == BrickMask{}) return;
    bool is_dated = !ages.find(brick).is_unknown();
    if (!is_dated) {
        // Refused; or counts only, in a map where nothing expires.
        const bool is_to_expire = config_.age.unknown_after_s > 0 && has_counts(brick);
        if (layers_.log_odds.find(brick).is_unknown() && !is_to_expire) return;
        is_dated = has_room_to_date(brick);
    }
    try {
        if (is_dated) ages.confirm(brick, voxels, kind);
    } catch (const std::bad_alloc&) {
        is_dated = false;
        ++counters_.ages_without_memory;
    }
    if (!is_dated) counters_.undated += count_of(voxels);
}

bool BrickEditor::is_seen_by_camera(std::uint16_t stamp) const noexcept {
    const auto last = layers_.ages.confirmation_of(stamp);
    return last && last->kind == SensorKind::camera && last->age_s <= 1;
}

void BrickEditor::date_all() {
    const auto date = [&](MortonCode brick) {
        if (!layers_.ages.find(brick).is_unknown() || has_room_to_date(brick)) {
            layers_.ages.take_from_before(brick, measured_in(brick));
        } else {
            counters_.undated += kBrickVoxels;
        }
    };
    layers_.log_odds.for_each([&](MortonCode brick, const BrickView&) { date(brick); });
    if (config_.age.unknown_after_s == 0) return;  // voxels with counts only need a time stamp only to expire
    layers_.counts.hits.for_each([&](MortonCode brick, const BrickView&) {
        if (layers_.log_odds.find(brick).is_unknown()) date(brick);
    });
}

BrickMask BrickEditor::measured_in(MortonCode brick) const noexcept {
    const BrickView log_odds = layers_.log_odds.find(brick);
    BrickMask measured = log_odds.is_unknown() ? BrickMask{} : known_in(log_odds);
    if (!has_counts(brick)) return measured;
    const BrickView hits = layers_.counts.hits.find(brick);
    const BrickView misses = layers_.counts.misses.find(brick);
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
        if (hits.at(cell) > 0.0F || misses.at(cell) > 0.0F) put_in(measured, cell);
    return measured;
}

void BrickEditor::expire() {
    VoxelAges& ages = layers_.ages;
    const Due due = due_of(ages, config_.age.unknown_after_s);
    ages.look_at_due(due.first, due.limit, [&](MortonCode brick) {
        const BrickMask voxels = stamped_from_to(ages.find(brick), due.first, due.limit);
        if (count_of(voxels) == 0) return;
        expire_log_odds(brick, voxels);
        if (has_counts(brick)) layers_.counts.expire(brick, voxels);
        ages.forget(brick, voxels);  // last: after a memory failure, the voxels are found again
    });
}

std::size_t count_due(const MapLayers& layers, std::uint32_t unknown_after_s, std::int64_t passed_s) {
    const Due due = due_of(layers.ages, unknown_after_s, passed_s);
    std::size_t voxels = 0;
    layers.ages.stamps().for_each([&](MortonCode brick, const StampView& stamps) {
        const BrickView log_odds = layers.log_odds.find(brick);
        if (log_odds.is_unknown()) return;
        const BrickMask known = known_in(log_odds);
        BrickMask expiring = stamped_from_to(stamps, due.first, due.limit);
        for (std::size_t word = 0; word < known.size(); ++word) expiring[word] &= known[word];
        voxels += count_of(expiring);
    });
    return voxels;
}

void BrickEditor::expire_log_odds(MortonCode brick, const BrickMask& voxels) {
    BrickTree& log_odds = layers_.log_odds;
    const BrickView before = log_odds.find(brick);
    if (before.is_unknown()) return;
    const BrickMask known = known_in(before);
    BrickMask expired{};
    for (std::size_t word = 0; word < known.size(); ++word) expired[word] = known[word] & voxels[word];
    if (expired == known) {
        log_odds.forget(brick);
    } else {
        BrickValues& values = log_odds.open(brick);
        for_each_cell(expired, [&](std::size_t cell) { values[cell] = kUnknownLogOdds; });
    }
    layers_.known_voxels -= count_of(expired);
}

bool BrickEditor::fill(const VoxelCube& cube, float log_odds) {
    assert(layers_.counts.empty());
    const std::size_t bricks = (std::size_t{1} << (3 * cube.height)) / kBrickVoxels;
    // Checked in advance: a file may claim the whole octree.
    if (bricks > bytes_max() / BrickTree::kBrickBytes) return false;
    // Adding 0 turns -0 into 0: in a file, equal values must be equal bytes.
    const float value = rules_.clamped(log_odds) + 0.0F;
    const MortonCode first = morton_of(cube.lowest);
    const MortonCode end = first + (MortonCode{1} << (3 * cube.height));
    const MortonCode step = std::min<MortonCode>(end - first, kBrickVoxels);
    for (MortonCode code = first; code < end; code += step) {
        const MortonCode brick = code & ~MortonCode{kBrickVoxels - 1};
        const BrickView before = layers_.log_odds.find(brick);
        if (before.is_unknown() && !has_room_for(brick)) return false;
        if (step == kBrickVoxels) {
            for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
                layers_.known_voxels += std::isnan(before.at(cell)) ? 1U : 0U;
            layers_.log_odds.set_all(brick, value);
            continue;
        }
        BrickValues& values = layers_.log_odds.open(brick);
        for (std::size_t cell = code % kBrickVoxels, last = cell + step; cell < last; ++cell)
            set(values[cell], value);
    }
    return true;
}

void BrickEditor::clamp_all() {
    layers_.log_odds = clamped_tree(layers_.log_odds, rules_);
    layers_.counts.prior = clamped_tree(layers_.counts.prior, rules_);
}

void BrickEditor::fuse_all() {
    const BrickTree counted = layers_.counts.hits;
    counted.for_each([&](MortonCode brick, const BrickView&) { fuse(brick); });
}

void BrickEditor::fuse(MortonCode brick) {
    const BrickView hits = layers_.counts.hits.find(brick);
    const BrickView misses = layers_.counts.misses.find(brick);
    const BrickView prior = layers_.counts.prior.find(brick);
    const BrickView before = layers_.log_odds.find(brick);
    BrickValues fused;
    bool is_any_known = false;
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        VoxelState voxel{before.at(cell), prior.at(cell), hits.at(cell), misses.at(cell)};
        rules_.fuse(voxel);
        fused[cell] = voxel.log_odds;
        is_any_known = is_any_known || !std::isnan(voxel.log_odds);
    }
    if (!is_any_known) return;  // counts only: no log-odds to store
    BrickValues& values = layers_.log_odds.open(brick);
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) set(values[cell], fused[cell]);
}

}  // namespace octoskin
