// What a FusedMap knows of time: when its voxels were last measured, and which of them nobody has for too
// long.
#include <cassert>
#include <cmath>
#include <new>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {
namespace {

/// Of a brick's voxels those whose stamp is `first` or more, and below the limit.
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

BrickMask known_in(const BrickValues& values) {
    BrickMask known{};
    for (std::size_t word = 0; word < known.size(); ++word) known[word] = sets_of(values, word, 0.0F).known;
    return known;
}

}  // namespace

void FusedMap::go_on(HostTime now) noexcept {
    has_undated_ = has_undated_ || !confirmations_.has_begun();
    try {
        if (!confirmations_.go_on(now)) return;
        if (has_undated_) date_all();
        has_undated_ = false;
        if (config_.age.unknown_after_s > 0) expire();
    } catch (const std::bad_alloc&) {  // what is too old is forgotten, or dated, in a later second
        ++counters_.undated;
    }
}

/// What is there when the clock begins: nobody knows since when.
void FusedMap::date_all() {
    tree_.for_each([&](MortonCode brick, const BrickView&) {
        if (!confirmations_.find(brick).is_unknown()) return;  // an earlier second came so far
        if (has_room_to_date(brick)) {
            confirmations_.take_from_before(brick);
        } else {
            counters_.undated += kBrickVoxels;
        }
    });
}

bool FusedMap::has_room_to_date(MortonCode brick) const noexcept {
    const std::size_t bytes_max = std::size_t{config_.memory_max_mib} << 20U;
    return 16 * (confirmations_.bytes_at_most() + confirmations_.bytes_of_new(brick)) <= 9 * bytes_max;
}

void FusedMap::confirm(MortonCode brick, const BrickMask& voxels, SensorKind kind) noexcept {
    bool is_dated = !confirmations_.find(brick).is_unknown();
    if (!is_dated) {
        // Refused, or of counts alone where nothing is ever forgotten.
        const bool is_to_expire = config_.age.unknown_after_s > 0 && counts_.has(brick);
        if (tree_.find(brick).is_unknown() && !is_to_expire) return;
        is_dated = has_room_to_date(brick);
    }
    try {
        if (is_dated) confirmations_.confirm(brick, voxels, kind);
    } catch (const std::bad_alloc&) {
        is_dated = false;
    }
    if (!is_dated) counters_.undated += count_of(voxels);
}

void FusedMap::confirm(std::span<const VoxelUpdate> updates, SensorKind kind) noexcept {
    while (!updates.empty()) {
        std::size_t done = confirmations_.confirm_owned(updates, kind);
        if (done == 0) {
            done = length_of_first_run(updates);
            for_each_run(updates.first(done),
                         [&](MortonCode brick, const BrickMask& voxels) { confirm(brick, voxels, kind); });
        }
        updates = updates.subspan(done);
    }
}

void FusedMap::confirm(const DepthTerms& terms, const BrickTerms& brick) noexcept {
    const auto hits = terms.hits_of(brick);
    if (hits.empty()) return confirm(brick.first, brick.passed, SensorKind::camera);
    BrickMask voxels = brick.passed;
    for (const CellTerm& hit : hits) put_in(voxels, hit.cell);
    confirm(brick.first, voxels, SensorKind::camera);
}

namespace {

/// Calls confirm(brick, voxels) for each run of voxels in one brick of which some are meant. Most voxels of a
/// cone come in runs.
template <class Voxels, class KeyOf, class Filter, class Confirm>
void confirm_runs(const Voxels& voxels, const KeyOf& key_of, const Filter& filter_of,
                  const Confirm& confirm) {
    for (std::size_t next = 0; next < voxels.size();) {
        const VoxelKey first = key_of(voxels[next]);
        const auto is_meant = filter_of(brick_of(first));
        BrickMask mask{};
        bool has_any = false;
        for (; next < voxels.size() && are_of_one_brick(key_of(voxels[next]), first); ++next) {
            if (!is_meant(voxels[next])) continue;
            has_any = true;
            put_in(mask, cell_of(key_of(voxels[next])));
        }
        if (has_any) confirm(brick_of(first), mask);
    }
}

}  // namespace

/// Not what is occupied and the camera saw just now: while it looks, its word stays the newest, and what
/// passes there contradicts it. Of a cap not what is free either, which a hit that is shared does not
/// confirm. What is unknown and was given a hit has its time, too: counts that lead to nothing are forgotten
/// like all else.
void FusedMap::confirm(const ConeVoxels& cone) noexcept {
    const auto confirm_brick = [&](MortonCode brick, const BrickMask& voxels) {
        confirm(brick, voxels, SensorKind::range);
    };
    confirm_runs(
        cone.passed, [](VoxelKey key) { return key; },
        [&](MortonCode brick) {
            return [this, view = tree_.find(brick), stamps = confirmations_.find(brick)](VoxelKey key) {
                const std::size_t cell = cell_of(key);
                const bool is_occupied = view.at(cell) >= config_.log_odds_occupied;
                return !is_occupied || !is_seen_by_camera(stamps.at(cell));
            };
        },
        confirm_brick);
    confirm_runs(
        cone.cap, [](const CapVoxel& voxel) { return voxel.key; },
        [&](MortonCode brick) {
            return
                [this, view = tree_.find(brick), stamps = confirmations_.find(brick)](const CapVoxel& voxel) {
                    const std::size_t cell = cell_of(voxel.key);
                    const float log_odds = view.at(cell);
                    if (std::isnan(log_odds)) return voxel.weight > 0.0F;
                    return log_odds >= config_.log_odds_occupied && !is_seen_by_camera(stamps.at(cell));
                };
        },
        confirm_brick);
}

void FusedMap::expire() {
    const std::uint16_t limit = confirmations_.stamp_before(config_.age.unknown_after_s);
    // What was there before the clock has its time from then on.
    const bool takes_all = confirmations_.runs_for_s() >= std::int64_t{config_.age.unknown_after_s};
    const auto first = static_cast<std::uint16_t>(takes_all ? 1 : Confirmations::kOfBefore + 1);
    confirmations_.look_at_due(first, limit, [&](MortonCode brick) {
        const BrickMask voxels = stamped_from_to(confirmations_.find(brick), first, limit);
        if (count_of(voxels) == 0) return;
        forget_log_odds(brick, voxels);
        if (!counts_.empty() && counts_.has(brick)) counts_.forget(brick, voxels);
        confirmations_.forget(brick, voxels);  // last: what there was no memory for is found again
    });
}

void FusedMap::forget_log_odds(MortonCode brick, const BrickMask& voxels) {
    const BrickView before = tree_.find(brick);
    if (before.is_unknown()) return;
    BrickMask known{};
    if (before.values == nullptr) {
        known.fill(~std::uint64_t{0});
    } else {
        known = known_in(*before.values);
    }
    BrickMask forgotten{};
    bool is_all = true;
    for (std::size_t word = 0; word < known.size(); ++word) {
        forgotten[word] = known[word] & voxels[word];
        is_all &= forgotten[word] == known[word];
    }
    if (is_all) {
        tree_.forget(brick);
    } else {
        BrickValues& values = tree_.open(brick);
        for_each_cell(forgotten, [&](std::size_t cell) { values[cell] = kUnknownLogOdds; });
    }
    known_voxels_ -= count_of(forgotten);
}

std::optional<Confirmation> FusedMap::confirmation(VoxelKey key) const noexcept {
    if (occupancy(key) == Occupancy::unknown) return std::nullopt;
    return confirmations_.told_by(confirmations_.find(brick_of(key)).at(cell_of(key)));
}

std::uint16_t FusedMap::stale_stamp() const noexcept {
    const bool has_horizon = config_.age.stale_after_s > 0 && confirmations_.has_begun();
    return has_horizon ? confirmations_.stamp_before(config_.age.stale_after_s) : std::uint16_t{0};
}

bool FusedMap::is_stale(VoxelKey key) const noexcept {
    return occupancy(key) != Occupancy::unknown &&
           confirmations_.find(brick_of(key)).at(cell_of(key)) < stale_stamp();
}

}  // namespace octoskin
