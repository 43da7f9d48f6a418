#include "host/core/mapping/fused_map.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "host/core/bricks/brick_runs.hpp"

namespace octoskin {
namespace {

constexpr std::size_t bytes_of(std::uint32_t memory_mib) {
    return std::size_t{memory_mib} << 20U;
}

/// If each voxel had a value of its own.
std::size_t bytes_at_most(const BrickTree& tree) {
    return tree.nodes() * BrickTree::kNodeBytes + tree.bricks() * BrickTree::kBrickBytes;
}

CountFusion fusion_of(const MapConfig& config) {
    return {config.counts, config.log_odds_min, config.log_odds_max, config.log_odds_occupied};
}

}  // namespace

FusedMap::FusedMap(const MapConfig& config)
    : config_(config), lattice_(config.resolution_m), fusion_(fusion_of(config)) {
    assert(std::isfinite(config.log_odds_min) && std::isfinite(config.log_odds_max));
    assert(config.log_odds_min <= 0.0F && config.log_odds_max >= 0.0F);
}

namespace {

BrickTree clamped_tree(const BrickTree& tree, float min, float max) {
    const auto clamp = [&](float& log_odds) {  // a NaN, which is an unknown voxel, stays one
        log_odds = std::clamp(log_odds, min, max);
    };
    BrickTree clamped = tree;
    tree.for_each([&](MortonCode brick, const BrickView& view) {
        if (view.values != nullptr) {
            std::ranges::for_each(clamped.open(brick), clamp);
        } else {
            float value = view.value;
            clamp(value);
            clamped.set_all(brick, value);
        }
    });
    return clamped;
}

}  // namespace

void FusedMap::limit(const MapConfig& config) {
    assert(config.resolution_m == config_.resolution_m);
    const bool clamps_change =
        config.log_odds_min != config_.log_odds_min || config.log_odds_max != config_.log_odds_max;
    const bool fusion_changes = clamps_change || config.counts != config_.counts ||
                                config.log_odds_occupied != config_.log_odds_occupied;
    FusedMap next(*this);
    if (clamps_change) {
        next.tree_ = clamped_tree(tree_, config.log_odds_min, config.log_odds_max);
        next.counts_.other = clamped_tree(counts_.other, config.log_odds_min, config.log_odds_max);
    }
    next.config_ = config;
    next.counters_ = {};
    next.fusion_ = fusion_of(config);
    if (fusion_changes) counts_.hits.for_each([&](MortonCode brick, const BrickView&) { next.fuse(brick); });
    *this = std::move(next);
}

bool FusedMap::has_room_for(MortonCode brick) const noexcept {
    const std::size_t more = tree_.nodes_missing(brick) * BrickTree::kNodeBytes + BrickTree::kBrickBytes;
    return bytes_at_most(tree_) + more <= bytes_of(config_.memory_max_mib);
}

void FusedMap::add(float& voxel, const ClampedTerm& term) noexcept {
    known_voxels_ += std::isnan(voxel) ? 1U : 0U;
    voxel = term.added_to(voxel);
}

void FusedMap::apply(std::span<const VoxelUpdate> updates, SensorKind kind) {
    const auto all = updates;
    const std::uint64_t no_memory = counters_.no_memory;
    while (!updates.empty()) {
        std::size_t done = counts_.empty() ? apply_owned(updates) : 0;
        if (done == 0) {
            done = length_of_first_run(updates);
            const bool is_counted = !counts_.empty() && counts_.has(brick_of(updates.front().key));
            is_counted ? apply_beside_counts(updates.first(done)) : apply_run(updates.first(done));
        }
        updates = updates.subspan(done);
    }
    // What had no room is in an unknown brick, which is not dated.
    if (confirmations_.has_begun() && counters_.no_memory == no_memory) confirm(all, kind);
}

/// Takes updates as long as their voxels have a place each and nothing has to be refused, and returns how
/// many: all of a beam in known space. Its voxels lie in many bricks, and most of a map is in no cache: all
/// bricks are asked for, then all voxels, before the first is written.
std::size_t FusedMap::apply_owned(std::span<const VoxelUpdate> updates) noexcept {
    BrickRuns found;
    find_runs(updates, found);
    BricksOfRuns<float> bricks;  // NOLINT: as many as there are runs are set
    own_bricks(tree_, updates, found, bricks);
    std::array<float*, BrickRuns::kUpdatesMax> voxels;  // NOLINT: as many as there are updates are set
    for (std::size_t i = 0; i < found.updates; ++i) {
        voxels[i] = bricks[found.run_of[i]] + found.cell_of[i];
        __builtin_prefetch(voxels[i], 1);
    }
    known_voxels_ +=
        add_to_each(std::span<float* const>(voxels).first(found.updates), updates, clamped(0.0F));
    counters_.applied += found.updates;
    return found.updates;
}

/// Terms of one brick, which is made for the first of them that it is needed for.
void FusedMap::apply_run(std::span<const VoxelUpdate> run) noexcept {
    const MortonCode brick = brick_of(run.front().key);
    BrickValues* values = tree_.own(brick);
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
        add((*values)[cell_of(update.key)], clamped(update.log_odds));
        ++counters_.applied;
    }
}

void FusedMap::apply(const DepthTerms& terms, std::span<const BrickTerms> bricks) {
    assert(std::isfinite(terms.miss));
    for (const BrickTerms& brick : bricks) {
        const bool is_counted = !counts_.empty() && counts_.has(brick.first);
        const std::uint64_t refused = counters_.refused();
        is_counted ? apply_beside_counts(terms, brick) : apply_brick(terms, brick);
        if (confirmations_.has_begun() && counters_.refused() == refused) confirm(terms, brick);
    }
}

void FusedMap::apply_brick(const DepthTerms& terms, const BrickTerms& brick) noexcept {
    const auto hits = terms.hits_of(brick);
    const ClampedTerm miss = passed_term(terms.miss);
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
            for (const CellTerm& hit : hits) add(values[hit.cell], hit_term(hit.log_odds));
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
    assert(counts_.empty());
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
