#include "host/core/mapping/fused_map.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <new>
#include <utility>

namespace octoskin {
namespace {

constexpr std::size_t bytes_of(std::uint32_t memory_mib) {
    return std::size_t{memory_mib} << 20U;
}

/// If each voxel had a value of its own.
std::size_t bytes_at_most(const BrickTree& tree) {
    return tree.nodes() * BrickTree::kNodeBytes + tree.bricks() * BrickTree::kBrickBytes;
}

}  // namespace

FusedMap::FusedMap(const MapConfig& config) : config_(config), lattice_(config.resolution_m) {
    assert(std::isfinite(config.log_odds_min) && std::isfinite(config.log_odds_max));
    assert(config.log_odds_min <= 0.0F && config.log_odds_max >= 0.0F);
}

void FusedMap::limit(const MapConfig& config) {
    assert(config.resolution_m == config_.resolution_m);
    const bool clamps_change =
        config.log_odds_min != config_.log_odds_min || config.log_odds_max != config_.log_odds_max;
    if (clamps_change) {
        const auto clamp = [&](float& log_odds) {  // a NaN, which is an unknown voxel, stays one
            log_odds = std::clamp(log_odds, config.log_odds_min, config.log_odds_max);
        };
        BrickTree clamped = tree_;
        tree_.for_each([&](MortonCode brick, const BrickView& view) {
            if (view.values != nullptr) {
                std::ranges::for_each(clamped.open(brick), clamp);
            } else {
                float value = view.value;
                clamp(value);
                clamped.set_all(brick, value);
            }
        });
        tree_ = std::move(clamped);
    }
    config_ = config;
    counters_ = {};
}

bool FusedMap::has_room_for(MortonCode brick) const noexcept {
    const std::size_t more = tree_.nodes_missing(brick) * BrickTree::kNodeBytes + BrickTree::kBrickBytes;
    return bytes_at_most(tree_) + more <= bytes_of(config_.memory_max_mib);
}

template <class Write>
Status<FusedMap::Refusal> FusedMap::change(MortonCode brick, Write&& write) noexcept {
    if (tree_.find(brick).is_unknown() && !has_room_for(brick)) return unexpected(&MapCounters::no_room);
    try {
        write();
        return Done{};
    } catch (const std::bad_alloc&) {
        return unexpected(&MapCounters::no_memory);
    }
}

void FusedMap::add(float& voxel, float log_odds) noexcept {
    known_voxels_ += std::isnan(voxel) ? 1U : 0U;
    voxel = clamped(log_odds).added_to(voxel);
}

void FusedMap::apply(std::span<const VoxelUpdate> updates) {
    while (!updates.empty()) updates = updates.subspan(apply_some(updates));
}

/// The voxels of a beam lie in many bricks, and most of a map is in no cache: all are asked for before the
/// first is written, so that the memory is waited for once. Returns how many updates it took.
std::size_t FusedMap::apply_some(std::span<const VoxelUpdate> updates) noexcept {
    constexpr std::size_t kRunsMax = 32;
    struct Run {
        BrickValues* values = nullptr;
        std::size_t end = 0;
    };
    std::array<Run, kRunsMax> runs;
    std::size_t count = 0;
    std::size_t end = 0;
    for (BrickTree::OwnBricks own(tree_); end < updates.size() && count < kRunsMax; ++count) {
        const VoxelKey first = updates[end].key;
        BrickValues* const values = own.find(brick_of(first));
        for (; end < updates.size() && are_of_one_brick(updates[end].key, first); ++end) {
            if (values != nullptr) __builtin_prefetch(&(*values)[cell_of(updates[end].key)], 1);
        }
        runs[count] = {values, end};
    }
    std::size_t begin = 0;
    for (const Run& run : std::span(runs).first(count)) {
        apply_run(run.values, updates.subspan(begin, run.end - begin));
        begin = run.end;
    }
    return end;
}

/// Terms of one brick, `values` if all of them have a place. A brick is made for the first of them that it is
/// needed for.
void FusedMap::apply_run(BrickValues* values, std::span<const VoxelUpdate> run) noexcept {
    const MortonCode brick = brick_of(run.front().key);
    if (values == nullptr) values = tree_.own(brick);  // a run before may have made it
    Status<Refusal> has_values = Done{};
    for (const VoxelUpdate& update : run) {
        if (!std::isfinite(update.log_odds)) {
            ++counters_.not_finite;
            continue;
        }
        if (update.log_odds == 0.0F) {
            ++counters_.zero;
            continue;
        }
        if (values == nullptr && has_values) {
            const BrickView before = tree_.find(brick);
            if (before.values == nullptr && clamped(update.log_odds).added_to(before.value) == before.value) {
                ++counters_.applied;  // a clamped value that stays: most of free space
                continue;
            }
            has_values = change(brick, [&] { values = &tree_.open(brick); });
        }
        if (values == nullptr) {
            ++(counters_.*has_values.error());
            continue;
        }
        add((*values)[cell_of(update.key)], update.log_odds);
        ++counters_.applied;
    }
}

void FusedMap::apply(const DepthTerms& terms, std::span<const BrickTerms> bricks) {
    assert(std::isfinite(terms.miss));
    for (const BrickTerms& brick : bricks) apply_brick(terms, brick);
}

void FusedMap::apply_brick(const DepthTerms& terms, const BrickTerms& brick) noexcept {
    const auto hits = terms.hits_of(brick);
    const ClampedTerm miss = clamped(terms.miss);
    const std::size_t passed = count_of(brick.passed);
    const BrickView before = tree_.find(brick.first);
    Status<Refusal> done = Done{};
    if (before.values == nullptr && hits.empty() && passed == kBrickVoxels) {
        const float after = miss.added_to(before.value);
        if (after != before.value) done = change(brick.first, [&] { tree_.set_all(brick.first, after); });
        if (done && before.is_unknown()) known_voxels_ += kBrickVoxels;
    } else if (before.values != nullptr || !hits.empty() || miss.added_to(before.value) != before.value) {
        done = change(brick.first, [&] {
            BrickValues& values = tree_.open(brick.first);
            known_voxels_ += add_to_voxels(values, brick.passed, miss);
            for (const CellTerm& hit : hits) add(values[hit.cell], hit.log_odds);
            if (hits.empty() && are_alike(values)) tree_.set_all(brick.first, values.front());
        });
    }
    counters_.*(done ? &MapCounters::applied : done.error()) += passed + hits.size();
}

std::optional<float> FusedMap::log_odds(VoxelKey key) const noexcept {
    const float value = tree_.find(brick_of(key)).at(cell_of(key));
    return std::isnan(value) ? std::nullopt : std::optional<float>(value);
}

Occupancy FusedMap::occupancy(VoxelKey key) const noexcept {
    const auto value = log_odds(key);
    return value ? occupancy_of(*value) : Occupancy::unknown;
}

Occupancy FusedMap::occupancy_of(float log_odds) const noexcept {
    return log_odds >= config_.log_odds_occupied ? Occupancy::occupied : Occupancy::free;
}

const MapConfig& FusedMap::config() const noexcept {
    return config_;
}
const VoxelLattice& FusedMap::lattice() const noexcept {
    return lattice_;
}
double FusedMap::resolution_m() const noexcept {
    return config_.resolution_m;
}
const MapCounters& FusedMap::counters() const noexcept {
    return counters_;
}
std::size_t FusedMap::known_voxels() const noexcept {
    return known_voxels_;
}
std::size_t FusedMap::memory_bytes() const noexcept {
    return bytes_at_most(tree_);
}

std::optional<VoxelKey> FusedMap::key_of(const Eigen::Vector3d& p_map) const noexcept {
    return lattice_.key_of(p_map);
}
Eigen::Vector3d FusedMap::centre_of(VoxelKey key) const noexcept {
    return lattice_.centre_of(key);
}

std::vector<MapBrick> FusedMap::bricks() const {
    std::vector<MapBrick> ordered;
    ordered.reserve(tree_.bricks());
    tree_.for_each([&](MortonCode brick, const BrickView& view) { ordered.push_back({brick, view}); });
    return ordered;
}

void FusedMap::for_each_known(const std::function<void(VoxelKey, float)>& visit) const {
    tree_.for_each([&](MortonCode brick, const BrickView& view) {
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
            const float log_odds = view.at(cell);
            if (!std::isnan(log_odds)) visit(key_of_morton(brick + cell), log_odds);
        }
    });
}

void FusedMap::for_each_difference(const FusedMap& before,
                                   const std::function<void(const MapBrick&)>& visit) const {
    tree_.for_each_difference(before.tree_, [&](MortonCode brick) { visit({brick, tree_.find(brick)}); });
}

bool FusedMap::set_cube(const VoxelCube& cube, float log_odds) {
    if (!std::isfinite(log_odds)) return false;
    const std::size_t bricks = (std::size_t{1} << (3 * cube.height)) / kBrickVoxels;
    // At once: a file may claim the whole octree.
    if (bricks > bytes_of(config_.memory_max_mib) / BrickTree::kBrickBytes) return false;
    // Adding 0 turns a -0 into a 0: equal values must be equal bytes in a file.
    const float value = std::clamp(log_odds, config_.log_odds_min, config_.log_odds_max) + 0.0F;
    const MortonCode first = morton_of(cube.lowest);
    const MortonCode end = first + (MortonCode{1} << (3 * cube.height));
    const MortonCode step = std::min<MortonCode>(end - first, kBrickVoxels);
    for (MortonCode code = first; code < end; code += step) {
        const MortonCode brick = code & ~MortonCode{kBrickVoxels - 1};
        const BrickView before = tree_.find(brick);
        if (before.is_unknown() && !has_room_for(brick)) return false;
        if (step == kBrickVoxels) {
            for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
                known_voxels_ += std::isnan(before.at(cell)) ? 1U : 0U;
            }
            tree_.set_all(brick, value);
            continue;
        }
        BrickValues& values = tree_.open(brick);
        for (std::size_t cell = code % kBrickVoxels, last = cell + step; cell < last; ++cell) {
            known_voxels_ += std::isnan(values[cell]) ? 1U : 0U;
            values[cell] = value;
        }
    }
    return true;
}

}  // namespace octoskin
