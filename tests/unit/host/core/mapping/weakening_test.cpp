// VoxelRules::weaken for every kind of voxel, and WeakeningWriter, which does the same in a map.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

constexpr VoxelKey kKey{32768, 32768, 32768};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kAll = std::numeric_limits<float>::lowest();

std::uint32_t bits_of(float value) {
    return std::isnan(value) ? 0x7FC0'0000U : std::bit_cast<std::uint32_t>(value);
}

std::vector<MapConfig> configurations() {
    MapConfig high = denoised_mapping().map;
    high.log_odds_occupied = 0.25F;
    MapConfig low = denoised_mapping().map;
    low.log_odds_occupied = -0.5F;
    return {denoised_mapping().map, paper_mapping().map, high, low};
}

/// Every combination of a few priors and counts, as measurements leave it.
std::vector<VoxelState> states(const MapConfig& config, bool has_counts) {
    const VoxelRules rules(config);
    const float occupied = config.log_odds_occupied;
    std::vector<VoxelState> states;
    for (const float prior : {kNan, -2.0F, -0.4F, -0.0F, 0.0F, std::nextafter(occupied, -9.0F), occupied,
                              std::nextafter(occupied, 9.0F), 0.9F, 3.5F}) {
        for (const float hits : {0.0F, 0.3F, 0.8F, 1.0F, 5.0F, 10.0F}) {
            for (const float misses : {0.0F, 0.3F, 1.65F, 1.7F, 5.0F, 10.0F}) {
                if (!has_counts && hits + misses > 0.0F) continue;
                VoxelState state{.log_odds = kNan, .prior = prior, .hits = hits, .misses = misses};
                rules.fuse(state);
                states.push_back(state);
            }
        }
    }
    return states;
}

/// What the counts say of a voxel of which nothing else is known.
Occupancy by_counts_alone(const CountModel& model, float hits, float misses) {
    const double share = (static_cast<double>(model.prior_hits) + static_cast<double>(hits)) /
                         static_cast<double>(model.prior_hits + hits + model.prior_misses + misses);
    const bool is_occupied = share >= static_cast<double>(model.occupied_probability);
    if (is_occupied && hits >= model.hits_min) return Occupancy::occupied;
    return misses > model.misses_min ? Occupancy::free : Occupancy::unknown;
}

TEST(Weakening, leaves_what_range_sensors_have_counted) {
    for (const MapConfig& config : configurations()) {
        const VoxelRules rules(config);
        for (const VoxelState& before : states(config, true)) {
            VoxelState after = before;
            rules.weaken(after, kAll);
            EXPECT_EQ(after.hits, before.hits);
            EXPECT_EQ(after.misses, before.misses);
            if (!(before.prior >= config.log_odds_occupied)) {
                EXPECT_EQ(bits_of(after.prior), bits_of(before.prior));
                EXPECT_EQ(bits_of(after.log_odds), bits_of(before.log_odds)) << before.prior;
                continue;
            }
            EXPECT_TRUE(std::isnan(after.prior));
            const Occupancy expected = before.hits + before.misses == 0.0F
                                           ? Occupancy::unknown
                                           : by_counts_alone(config.counts, before.hits, before.misses);
            EXPECT_EQ(rules.occupancy(after.log_odds), expected) << before.hits << " " << before.misses;
            VoxelState anew{.log_odds = kNan, .prior = kNan, .hits = before.hits, .misses = before.misses};
            rules.fuse(anew);
            EXPECT_EQ(bits_of(after.log_odds), bits_of(anew.log_odds));
        }
    }
}

TEST(Weakening, takes_from_what_is_occupied_until_it_is_unknown_and_nothing_from_others) {
    const VoxelRules rules(denoised_mapping().map);
    VoxelState voxel{.log_odds = 0.9F, .prior = 0.9F};
    for (const float left : {0.9F - 0.4F, 0.9F - 0.4F - 0.4F}) {
        rules.weaken(voxel, -0.4F);
        EXPECT_EQ(voxel.log_odds, left);
        EXPECT_EQ(voxel.prior, left);
    }
    rules.weaken(voxel, -0.4F);
    EXPECT_EQ(rules.occupancy(voxel.log_odds), Occupancy::unknown);
    EXPECT_TRUE(std::isnan(voxel.prior));
    for (const float prior : {kNan, -0.4F}) {
        VoxelState other{.log_odds = prior, .prior = prior};
        rules.weaken(other, -0.4F);
        EXPECT_EQ(bits_of(other.log_odds), bits_of(prior));
    }
}

/// A map with these voxels, one after the other from kKey's brick on, measured by a camera 5 s ago.
FusedMap map_of(const MapConfig& config, const std::vector<VoxelState>& states, bool has_counts) {
    MapLayers layers;
    layers.ages.advance_time(HostTime{0});
    for (std::size_t i = 0; i < states.size(); ++i) {
        const MortonCode brick = brick_of(kKey) + i / kBrickVoxels * kBrickVoxels;
        const std::size_t cell = i % kBrickVoxels;
        layers.log_odds.open(brick)[cell] = states[i].log_odds;
        layers.known_voxels += std::isnan(states[i].log_odds) ? 0U : 1U;
        BrickMask voxel{};
        put_in(voxel, cell);
        layers.ages.confirm(brick, voxel, SensorKind::camera);
        if (!has_counts) continue;
        if (!layers.counts.has(brick)) layers.counts.begin(brick, BrickView{});
        layers.counts.prior.open(brick)[cell] = states[i].prior;
        layers.counts.hits.open(brick)[cell] = states[i].hits;
        layers.counts.misses.open(brick)[cell] = states[i].misses;
    }
    FusedMap map(config, std::move(layers), false);
    map.advance_time(HostTime{5'000'000'000});
    return map;
}

/// All of the first `voxels` voxels from kKey's brick on.
Evidence all_of(std::size_t voxels, float term) {
    Evidence evidence;
    evidence.miss = term;
    evidence.rule = EvidenceRule::weaken;
    for (std::size_t i = 0; i < voxels; ++i)
        put_in(evidence.last(brick_of(kKey) + i / kBrickVoxels * kBrickVoxels).voxels, i % kBrickVoxels);
    return evidence;
}

void expect_weakened(const MapConfig& config, bool has_counts, float term) {
    const VoxelRules rules(config);
    const std::vector<VoxelState> before = states(config, has_counts);
    FusedMap map = map_of(config, before, has_counts);
    map.apply(all_of(before.size(), term));
    std::size_t known = 0;
    std::size_t changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        SCOPED_TRACE(i);
        VoxelState expected = before[i];
        rules.weaken(expected, term);
        const VoxelKey key = key_of_morton(brick_of(kKey) + i);
        const MapLayers& layers = map.layers();
        EXPECT_EQ(bits_of(layers.log_odds.find(brick_of(key)).at(cell_of(key))), bits_of(expected.log_odds));
        if (has_counts) {
            EXPECT_EQ(bits_of(layers.counts.prior.find(brick_of(key)).at(cell_of(key))),
                      bits_of(expected.prior));
            EXPECT_EQ(layers.counts.hits.find(brick_of(key)).at(cell_of(key)), expected.hits);
            EXPECT_EQ(layers.counts.misses.find(brick_of(key)).at(cell_of(key)), expected.misses);
        }
        const bool is_known = !std::isnan(expected.log_odds);
        known += is_known ? 1U : 0U;
        changed += before[i].prior >= config.log_odds_occupied ? 1U : 0U;
        const auto confirmed = is_known ? std::optional(Confirmation{5, SensorKind::camera}) : std::nullopt;
        EXPECT_EQ(map.confirmation(key), confirmed);
        const bool was_retracted = before[i].prior >= config.log_odds_occupied;
        const bool has_stamp = layers.ages.find(brick_of(key)).at(cell_of(key)) != 0;
        EXPECT_EQ(has_stamp, is_known || !was_retracted || expected.hits + expected.misses > 0.0F);
    }
    EXPECT_EQ(map.known_voxels(), known);
    EXPECT_EQ(map.counters().applied, changed);
    EXPECT_EQ(map.counters().refused(), 0U);
    if (term != kAll) return;
    // Nothing is left to take.
    const FusedMap first = map.copy();
    map.apply(all_of(before.size(), term));
    EXPECT_EQ(map.counters(), first.counters());
}

TEST(Weakening, is_written_as_the_rule_says_for_voxels_of_every_kind) {
    for (const MapConfig& config : configurations()) {
        for (const float term : {kAll, -0.4F}) {
            expect_weakened(config, false, term);
            expect_weakened(config, true, term);
        }
    }
}

Evidence image_of(std::vector<VoxelUpdate> updates) {
    Evidence terms;
    terms.miss = -0.4F;
    terms.take_image(std::move(updates));
    return terms;
}

TEST(Weakening, gives_the_memory_of_a_brick_back_when_nothing_of_it_is_known) {
    FusedMap map(denoised_mapping().map);
    map.advance_time(HostTime{0});
    map.apply(image_of({{kKey, 0.8F}, {key_of_morton(morton_of(kKey) + 3), 0.8F}}));
    EXPECT_EQ(map.known_voxels(), 2U);
    EXPECT_EQ(map.bricks().size(), 1U);
    map.apply(all_of(1, kAll));
    EXPECT_EQ(map.known_voxels(), 1U);
    EXPECT_EQ(map.bricks().size(), 1U);
    map.apply(all_of(512, kAll));
    EXPECT_EQ(map.known_voxels(), 0U);
    EXPECT_TRUE(map.bricks().empty());
    EXPECT_EQ(map.layers().log_odds.memory_bytes(), 0U);
}

TEST(Weakening, lets_counts_without_effect_expire) {
    MapConfig config = denoised_mapping().map;
    config.age = {.stale_after_s = 1, .unknown_after_s = 10};
    FusedMap map(config);
    map.advance_time(HostTime{0});
    map.apply(image_of({{kKey, 0.8F}}));
    ConeVoxels cone;
    cone.cap = {{kKey, 1.0F}};
    ConeModel model = denoised_mapping().cone;
    model.hit_mass = 0.5F;  // below hits_min
    feed(map, cone, model);
    EXPECT_EQ(map.occupancy(kKey), Occupancy::occupied);
    map.apply(all_of(1, kAll));
    EXPECT_EQ(map.occupancy(kKey), Occupancy::unknown);
    EXPECT_EQ(map.layers().counts.hits.bricks(), 1U);
    map.advance_time(HostTime{11'000'000'000});
    map.apply(image_of({{{32800, 32800, 32800}, 0.8F}}));
    EXPECT_EQ(map.layers().counts.hits.bricks(), 0U);
}

TEST(Weakening, leaves_a_copy_of_the_map_as_it_was) {
    FusedMap map(denoised_mapping().map);
    map.apply(image_of({{kKey, 0.8F}}));
    const FusedMap copy = map.copy();
    map.apply(all_of(1, kAll));
    EXPECT_EQ(copy.occupancy(kKey), Occupancy::occupied);
    EXPECT_EQ(copy.known_voxels(), 1U);
    EXPECT_EQ(map.known_voxels(), 0U);
}

}  // namespace
}  // namespace octoskin
