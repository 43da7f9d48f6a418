#include "host/core/mapping/fused_map.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <new>
#include <unordered_map>
#include <utility>
#include <vector>

namespace octoskin {
namespace {

/// Unknown voxels of a brick hold a NaN, so that one load tells known from unknown. No term, clamp or file
/// can put one there: all of them are checked for finiteness on the way in.
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

using Brick = std::array<float, kBrickVoxels>;
constexpr std::size_t kBytesPerBrick = sizeof(Brick) + 64;  // and its entry in the index

std::size_t bricks_in(std::uint32_t memory_max_mib) {
    return (std::size_t{memory_max_mib} << 20U) / kBytesPerBrick;
}

/// Place of a voxel in its brick, in Morton order.
std::size_t cell_of(VoxelKey key) {
    constexpr std::array<std::uint8_t, 8> kSpread = {0, 1, 8, 9, 64, 65, 72, 73};
    return static_cast<std::size_t>(kSpread[key.x & 7U] | (kSpread[key.y & 7U] << 1U) |
                                    (kSpread[key.z & 7U] << 2U));
}

std::uint64_t brick_id_of(VoxelKey key) {
    return static_cast<std::uint64_t>(key.x >> kBrickHeight) |
           (static_cast<std::uint64_t>(key.y >> kBrickHeight) << 16U) |
           (static_cast<std::uint64_t>(key.z >> kBrickHeight) << 32U);
}

VoxelKey lowest_key_of(std::uint64_t brick_id) {
    const auto axis = [&](unsigned shift) {
        return static_cast<std::uint16_t>(((brick_id >> shift) & 0xFFFFU) << kBrickHeight);
    };
    return {axis(0), axis(16), axis(32)};
}

}  // namespace

struct FusedMap::Bricks {
    std::deque<Brick> storage;  // a deque, so that growing moves no brick
    std::unordered_map<std::uint64_t, Brick*> by_id;
    std::size_t bricks_max = 0;
    std::size_t known_voxels = 0;

    [[nodiscard]] const Brick* find(VoxelKey key) const {
        const auto found = by_id.find(brick_id_of(key));
        return found == by_id.end() ? nullptr : found->second;
    }
    /// The brick of this id, made if it is new; null if it is and there is no room. Throws std::bad_alloc,
    /// and then nothing is changed.
    [[nodiscard]] Brick* find_or_make(std::uint64_t id) {
        if (const auto found = by_id.find(id); found != by_id.end()) return found->second;
        if (storage.size() >= bricks_max) return nullptr;
        Brick* const brick = &storage.emplace_back();
        try {
            by_id.emplace(id, brick);
        } catch (...) {  // else room would be taken that nobody finds again
            storage.pop_back();
            throw;
        }
        brick->fill(kUnknown);
        return brick;
    }
    void set(Brick& brick, std::size_t cell, float log_odds) {
        known_voxels += std::isnan(brick[cell]) ? 1U : 0U;
        brick[cell] = log_odds;
    }
};

FusedMap::FusedMap(const MapConfig& config)
    : config_(config), lattice_(config.resolution_m), bricks_(std::make_unique<Bricks>()) {
    assert(std::isfinite(config.log_odds_min) && std::isfinite(config.log_odds_max));
    assert(config.log_odds_min <= 0.0F && config.log_odds_max >= 0.0F);
    bricks_->bricks_max = bricks_in(config.memory_max_mib);
}
FusedMap::FusedMap(FusedMap&&) noexcept = default;
FusedMap& FusedMap::operator=(FusedMap&&) noexcept = default;
FusedMap::~FusedMap() = default;

FusedMap FusedMap::copy() const {
    FusedMap other(config_);
    other.counters_ = counters_;
    other.bricks_->known_voxels = bricks_->known_voxels;
    other.bricks_->bricks_max = std::max(bricks_->bricks_max, bricks_->storage.size());
    for (const auto& [id, brick] : bricks_->by_id) *other.bricks_->find_or_make(id) = *brick;
    return other;
}

void FusedMap::limit(const MapConfig& config) {
    assert(config.resolution_m == config_.resolution_m);
    const bool clamps_change =
        config.log_odds_min != config_.log_odds_min || config.log_odds_max != config_.log_odds_max;
    config_ = config;
    counters_ = {};
    bricks_->bricks_max = bricks_in(config.memory_max_mib);
    if (!clamps_change) return;
    for (Brick& brick : bricks_->storage) {
        for (float& log_odds : brick) {  // a NaN, which is an unknown voxel, stays one
            log_odds = std::clamp(log_odds, config.log_odds_min, config.log_odds_max);
        }
    }
}

void FusedMap::apply(std::span<const VoxelUpdate> updates) {
    std::uint64_t brick_id = std::numeric_limits<std::uint64_t>::max();  // no brick has this one
    Brick* brick = nullptr;
    std::uint64_t* refused = nullptr;  // where those count for which there is no brick
    for (const VoxelUpdate& update : updates) {
        if (!std::isfinite(update.log_odds)) {
            ++counters_.not_finite;
            continue;
        }
        if (update.log_odds == 0.0F) {
            ++counters_.zero;
            continue;
        }
        if (const std::uint64_t id = brick_id_of(update.key); id != brick_id) {
            brick_id = id;
            refused = &counters_.no_room;
            try {
                brick = bricks_->find_or_make(id);
            } catch (const std::bad_alloc&) {
                brick = nullptr;
                refused = &counters_.no_memory;
            }
        }
        if (brick == nullptr) {
            ++*refused;
            continue;
        }
        const std::size_t cell = cell_of(update.key);
        const float before = std::isnan((*brick)[cell]) ? 0.0F : (*brick)[cell];
        bricks_->set(*brick, cell,
                     std::clamp(before + update.log_odds, config_.log_odds_min, config_.log_odds_max));
        ++counters_.applied;
    }
}

std::optional<float> FusedMap::log_odds(VoxelKey key) const noexcept {
    const Brick* const brick = bricks_->find(key);
    if (brick == nullptr) return std::nullopt;
    const float value = (*brick)[cell_of(key)];
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
    return bricks_->known_voxels;
}

std::size_t FusedMap::memory_bytes() const noexcept {
    return bricks_->storage.size() * kBytesPerBrick;
}

std::optional<VoxelKey> FusedMap::key_of(const Eigen::Vector3d& p_map) const noexcept {
    return lattice_.key_of(p_map);
}
Eigen::Vector3d FusedMap::centre_of(VoxelKey key) const noexcept {
    return lattice_.centre_of(key);
}

std::vector<MapBrick> FusedMap::bricks() const {
    std::vector<MapBrick> ordered;
    ordered.reserve(bricks_->by_id.size());
    for (const auto& [id, brick] : bricks_->by_id) ordered.push_back({morton_of(lowest_key_of(id)), *brick});
    std::ranges::sort(ordered, {}, &MapBrick::first);
    return ordered;
}

void FusedMap::for_each_known(const std::function<void(VoxelKey, float)>& visit) const {
    for (const MapBrick& brick : bricks()) {
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
            const float log_odds = brick.log_odds[cell];
            if (!std::isnan(log_odds)) visit(key_of_morton(brick.first + cell), log_odds);
        }
    }
}

bool FusedMap::set_cube(const VoxelCube& cube, float log_odds) {
    if (!std::isfinite(log_odds)) return false;
    const std::size_t bricks = (std::size_t{1} << (3 * cube.height)) / kBrickVoxels;
    if (bricks > bricks_->bricks_max) return false;  // at once: a file may claim the whole octree
    // Adding 0 turns a -0 into a 0: equal values must be equal bytes in a file.
    const float value = std::clamp(log_odds, config_.log_odds_min, config_.log_odds_max) + 0.0F;
    const MortonCode first = morton_of(cube.lowest);
    const MortonCode end = first + (MortonCode{1} << (3 * cube.height));
    const MortonCode step = std::min<MortonCode>(end - first, kBrickVoxels);
    for (MortonCode code = first; code < end; code += step) {
        Brick* const brick = bricks_->find_or_make(brick_id_of(key_of_morton(code)));
        if (brick == nullptr) return false;
        const std::size_t cell = code % kBrickVoxels;
        for (std::size_t offset = 0; offset < step; ++offset) bricks_->set(*brick, cell + offset, value);
    }
    return true;
}

}  // namespace octoskin
