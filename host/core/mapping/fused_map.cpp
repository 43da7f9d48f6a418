#include "host/core/mapping/fused_map.hpp"

#include <cassert>
#include <cmath>
#include <new>
#include <utility>

#include "host/core/mapping/brick_editor.hpp"
#include "host/core/mapping/count_writer.hpp"
#include "host/core/mapping/image_writer.hpp"
#include "host/core/mapping/term_writer.hpp"
#include "host/core/mapping/weakening_writer.hpp"

namespace octoskin {

FusedMap::FusedMap(const MapConfig& config)
    : config_(config), lattice_(config.resolution_m), rules_(config) {}

FusedMap::FusedMap(const MapConfig& config, MapLayers layers, bool has_undated)
    : config_(config),
      lattice_(config.resolution_m),
      rules_(config),
      layers_(std::move(layers)),
      has_undated_(has_undated) {}

BrickEditor FusedMap::editor() noexcept {
    return {layers_, rules_, config_, counters_};
}

void FusedMap::apply(const Evidence& evidence, const EvidenceOptions& options) {
    BrickEditor editor = this->editor();
    if (evidence.rule == EvidenceRule::image) return ImageWriter(editor).write(evidence);
    if (evidence.rule == EvidenceRule::weaken) return WeakeningWriter(editor, options).write(evidence);
    if (evidence.rule == EvidenceRule::terms) return TermWriter(editor).write(evidence);
    CountWriter(editor, options).write(evidence);
}

void FusedMap::advance_time(HostTime now) noexcept {
    has_undated_ = has_undated_ || !layers_.ages.has_begun();
    try {
        if (layers_.ages.advance_time(now)) date_and_expire();
    } catch (const std::bad_alloc&) {  // expiry and missing time stamps follow in a later second
        ++counters_.undated;
        ++counters_.ages_without_memory;
    }
}

bool FusedMap::wait(std::int64_t seconds) noexcept {
    bool is_older = false;
    try {
        is_older = layers_.ages.wait(seconds);
        if (is_older) date_and_expire();
    } catch (const std::bad_alloc&) {
        ++counters_.undated;
        ++counters_.ages_without_memory;
    }
    return is_older;
}

void FusedMap::date_and_expire() {
    BrickEditor editor = this->editor();
    if (has_undated_) editor.date_all();
    has_undated_ = false;
    if (config_.age.unknown_after_s > 0) editor.expire();
}

void FusedMap::begin_to_wait() noexcept {
    layers_.ages.begin_to_wait();
    has_undated_ = true;  // it may come from a configuration without expiry
}

void FusedMap::clear_times() noexcept {
    layers_.ages = {};
    begin_to_wait();
}

void FusedMap::limit(const MapConfig& config) {
    assert(config.resolution_m == config_.resolution_m);
    const bool clamps_change =
        config.log_odds_min != config_.log_odds_min || config.log_odds_max != config_.log_odds_max;
    const bool rules_change = clamps_change || config.counts != config_.counts ||
                              config.log_odds_occupied != config_.log_odds_occupied;
    FusedMap next(*this);
    next.config_ = config;
    next.rules_ = VoxelRules(config);
    next.counters_ = {};
    // Without expiry, voxels with counts only have no time stamps.
    next.has_undated_ = has_undated_ || (config_.age.unknown_after_s == 0 && config.age.unknown_after_s > 0);
    BrickEditor editor = next.editor();
    if (clamps_change) editor.clamp_all();
    if (rules_change) editor.fuse_all();
    *this = std::move(next);
}

void FusedMap::clear_counts_of(const Evidence& terms) {
    if (layers_.counts.empty()) return;
    for (const BrickEvidence& brick : terms.bricks) {
        BrickMask voxels = brick.voxels;
        for (const CellTerm& cell : terms.cells_of(brick))
            if (is_plain(cell.term)) put_in(voxels, cell.cell);
        if (voxels != BrickMask{} && layers_.counts.has(brick.first))
            layers_.counts.expire(brick.first, voxels);
    }
}

bool FusedMap::set_cube(const VoxelCube& cube, float log_odds) {
    return std::isfinite(log_odds) && editor().fill(cube, log_odds);
}

std::optional<float> FusedMap::log_odds(VoxelKey key) const noexcept {
    const float value = layers_.log_odds.find(brick_of(key)).at(cell_of(key));
    return std::isnan(value) ? std::nullopt : std::optional<float>(value);
}

Occupancy FusedMap::occupancy(VoxelKey key) const noexcept {
    return occupancy_of(layers_.log_odds.find(brick_of(key)).at(cell_of(key)));
}

std::optional<Confirmation> FusedMap::confirmation(VoxelKey key) const noexcept {
    if (occupancy(key) == Occupancy::unknown) return std::nullopt;
    return layers_.ages.confirmation_of(layers_.ages.find(brick_of(key)).at(cell_of(key)));
}

std::uint16_t FusedMap::stale_stamp() const noexcept {
    const bool has_horizon = config_.age.stale_after_s > 0 && layers_.ages.has_begun();
    return has_horizon ? layers_.ages.stamp_before(config_.age.stale_after_s) : std::uint16_t{0};
}

bool FusedMap::is_stale(VoxelKey key) const noexcept {
    return occupancy(key) != Occupancy::unknown &&
           layers_.ages.find(brick_of(key)).at(cell_of(key)) < stale_stamp();
}

std::size_t FusedMap::known_voxels_at(HostTime now) const {
    const std::int64_t passed_s = layers_.ages.seconds_to(now);
    const std::uint32_t unknown_after_s = config_.age.unknown_after_s;
    if (passed_s == 0 || unknown_after_s == 0) return known_voxels();
    return known_voxels() - count_due(layers_, unknown_after_s, passed_s);
}

std::size_t FusedMap::memory_bytes() const noexcept {
    return bytes_at_most(layers_.log_odds);
}

std::optional<VoxelKey> FusedMap::key_of(const Eigen::Vector3d& p_map) const noexcept {
    return lattice_.key_of(p_map);
}
Eigen::Vector3d FusedMap::centre_of(VoxelKey key) const noexcept {
    return lattice_.centre_of(key);
}

std::vector<MapBrick> FusedMap::bricks() const {
    std::vector<MapBrick> ordered;
    ordered.reserve(layers_.log_odds.bricks());
    layers_.log_odds.for_each([&](MortonCode brick, const BrickView& view) {
        ordered.push_back({brick, view});
    });
    return ordered;
}

void FusedMap::for_each_known(const std::function<void(VoxelKey, float)>& visit) const {
    layers_.log_odds.for_each([&](MortonCode brick, const BrickView& view) {
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
            const float log_odds = view.at(cell);
            if (!std::isnan(log_odds)) visit(key_of_morton(brick + cell), log_odds);
        }
    });
}

void FusedMap::for_each_difference(const FusedMap& before,
                                   const std::function<void(const MapBrick&)>& visit) const {
    layers_.log_odds.for_each_difference(before.layers_.log_odds, [&](MortonCode brick) {
        visit({brick, layers_.log_odds.find(brick)});
    });
}

}  // namespace octoskin
