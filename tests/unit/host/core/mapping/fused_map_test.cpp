#include "host/core/mapping/fused_map.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "host/core/voxels/morton.hpp"
#include "tests/support/octomap_oracle.hpp"

namespace octoskin {
namespace {

constexpr VoxelKey kKey{32768, 32767, 40000};

void apply_one(FusedMap& map, VoxelKey key, float log_odds) {
    feed(map, std::vector<VoxelUpdate>{{key, log_odds}});
}

TEST(FusedMap, begins_unknown_everywhere) {
    const FusedMap map(MapConfig{});
    EXPECT_EQ(map.occupancy(kKey), Occupancy::unknown);
    EXPECT_FALSE(map.log_odds(kKey).has_value());
    EXPECT_EQ(map.known_voxels(), 0U);
}

TEST(FusedMap, adds_terms_and_tells_the_three_states_apart) {
    FusedMap map(MapConfig{});
    apply_one(map, kKey, 0.75F);
    EXPECT_EQ(map.log_odds(kKey), 0.75F);
    EXPECT_EQ(map.occupancy(kKey), Occupancy::occupied);
    apply_one(map, kKey, -1.0F);
    EXPECT_EQ(map.log_odds(kKey), -0.25F);
    EXPECT_EQ(map.occupancy(kKey), Occupancy::free);
    EXPECT_EQ(map.occupancy({32769, 32767, 40000}), Occupancy::unknown);
    EXPECT_EQ(map.known_voxels(), 1U);
}

TEST(FusedMap, calls_a_voxel_at_exactly_zero_occupied) {
    FusedMap map(MapConfig{});
    apply_one(map, kKey, 0.5F);
    apply_one(map, kKey, -0.5F);
    EXPECT_EQ(map.log_odds(kKey), 0.0F);
    EXPECT_EQ(map.occupancy(kKey), Occupancy::occupied);
}

TEST(FusedMap, is_not_touched_by_a_term_of_zero) {
    FusedMap map(MapConfig{});
    apply_one(map, kKey, 0.0F);
    apply_one(map, kKey, -0.0F);
    EXPECT_EQ(map.occupancy(kKey), Occupancy::unknown);
    EXPECT_EQ(map.known_voxels(), 0U);
    EXPECT_EQ(map.counters(), (MapCounters{.zero = 2}));
}

TEST(FusedMap, refuses_and_counts_terms_that_are_not_finite) {
    FusedMap map(MapConfig{});
    apply_one(map, kKey, 1.0F);
    apply_one(map, kKey, std::numeric_limits<float>::quiet_NaN());
    apply_one(map, kKey, std::numeric_limits<float>::infinity());
    apply_one(map, {1, 2, 3}, -std::numeric_limits<float>::infinity());
    EXPECT_EQ(map.log_odds(kKey), 1.0F);
    EXPECT_EQ(map.known_voxels(), 1U);
    EXPECT_EQ(map.counters(), (MapCounters{.applied = 1, .not_finite = 3}));
}

TEST(FusedMap, clamps_after_every_term_and_not_only_at_the_end) {
    FusedMap map(MapConfig{});
    feed(map, std::vector<VoxelUpdate>{{kKey, 3.0F}, {kKey, 3.0F}, {kKey, -1.0F}});
    EXPECT_EQ(map.log_odds(kKey), 2.5F);
    feed(map, std::vector<VoxelUpdate>{{kKey, -9.0F}, {kKey, 0.5F}});
    EXPECT_EQ(map.log_odds(kKey), -1.5F);
}

TEST(FusedMap, takes_no_new_space_beyond_its_memory_but_goes_on_updating) {
    MapConfig config;
    config.memory_max_mib = 1;  // 465 bricks of 2,064 bytes in 160 nodes of 544
    FusedMap map(config);
    std::vector<VoxelUpdate> updates;
    for (unsigned i = 0; i < 600; ++i) updates.push_back({{static_cast<std::uint16_t>(8 * i), 0, 0}, 1.0F});
    feed(map, updates);
    EXPECT_EQ(map.counters(), (MapCounters{.applied = 465, .no_room = 135}));
    EXPECT_EQ(map.occupancy({8 * 599, 0, 0}), Occupancy::unknown);
    feed(map, updates);
    EXPECT_EQ(map.log_odds({0, 0, 0}), 2.0F);
    EXPECT_EQ(map.known_voxels(), 465U);
    EXPECT_FALSE(map.set_cube({.lowest = {60000, 0, 0}, .height = 0}, 1.0F));
}

TEST(FusedMap, gives_every_voxel_of_a_cube_the_value_and_no_other) {
    for (const unsigned height : {0U, 1U, 2U, 3U, 4U, 5U}) {
        FusedMap map(MapConfig{});
        const VoxelKey lowest{32768, 32, 64};
        ASSERT_TRUE(map.set_cube({.lowest = lowest, .height = height}, -9.0F));
        const unsigned edge = 1U << height;
        EXPECT_EQ(map.known_voxels(), edge * edge * edge);
        map.for_each_known([&](VoxelKey key, float log_odds) {
            EXPECT_EQ(log_odds, -2.0F);
            EXPECT_LT(key.x - lowest.x, static_cast<int>(edge));
            EXPECT_LT(key.y - lowest.y, static_cast<int>(edge));
            EXPECT_LT(key.z - lowest.z, static_cast<int>(edge));
            EXPECT_GE(key.x, lowest.x);
            EXPECT_GE(key.y, lowest.y);
            EXPECT_GE(key.z, lowest.z);
        });
    }
    FusedMap map(MapConfig{});
    EXPECT_FALSE(map.set_cube({.lowest = kKey}, std::numeric_limits<float>::quiet_NaN()));
    EXPECT_EQ(map.known_voxels(), 0U);
}

TEST(FusedMap, keeps_no_negative_zero) {
    FusedMap map(MapConfig{});
    ASSERT_TRUE(map.set_cube({.lowest = kKey}, -0.0F));
    ASSERT_EQ(map.log_odds(kKey), 0.0F);
    EXPECT_FALSE(std::signbit(*map.log_odds(kKey)));
}

TEST(FusedMap, is_walked_in_morton_order_whatever_the_order_of_filling) {
    std::vector<VoxelUpdate> updates;
    std::mt19937 random(3);
    std::uniform_int_distribution<unsigned> any(32700, 32850);
    const auto draw = [&] { return static_cast<std::uint16_t>(any(random)); };
    for (int i = 0; i < 2000; ++i) updates.push_back({{draw(), draw(), draw()}, 0.5F});
    FusedMap forwards(MapConfig{});
    feed(forwards, updates);
    std::reverse(updates.begin(), updates.end());
    FusedMap backwards(MapConfig{});
    feed(backwards, updates);

    std::vector<VoxelKey> order;
    forwards.for_each_known([&](VoxelKey key, float) { order.push_back(key); });
    std::vector<VoxelKey> other_order;
    backwards.for_each_known([&](VoxelKey key, float) { other_order.push_back(key); });
    EXPECT_EQ(order, other_order);
    EXPECT_EQ(order.size(), forwards.known_voxels());
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end(),
                               [](VoxelKey a, VoxelKey b) { return morton_of(a) < morton_of(b); }));
}

TEST(FusedMap, finds_the_voxel_of_a_point_and_none_for_a_nan) {
    const FusedMap map(MapConfig{});
    EXPECT_EQ(map.key_of({0.05, -0.01, 0.0}), (VoxelKey{32769, 32767, 32768}));
    EXPECT_FALSE(map.key_of({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}).has_value());
    EXPECT_FALSE(map.key_of({0.0, 0.0, 2000.0}).has_value());
}

// Oracle: OctoMap's updateNode, one call per term, compared bit for bit.
TEST(FusedMap, equals_octomaps_update_node_sequence_bit_for_bit) {
    constexpr unsigned kSeed = 11;
    std::mt19937 random(kSeed);
    std::uniform_int_distribution<unsigned> any(32760, 32776);
    std::uniform_real_distribution<float> any_term(-0.9F, 1.1F);
    const auto draw = [&] { return static_cast<std::uint16_t>(any(random)); };
    const MapConfig config;
    FusedMap map(config);
    oracle::ClampedTree tree(config);
    std::vector<VoxelUpdate> updates;
    for (int i = 0; i < 40'000; ++i) updates.push_back({{draw(), draw(), draw()}, any_term(random)});
    feed(map, updates);
    for (const auto& update : updates) tree.updateNode(oracle::key_of(update.key), update.log_odds);
    EXPECT_EQ(oracle::voxels_of(map), oracle::voxels_of(tree)) << "seed " << kSeed;
}

}  // namespace
}  // namespace octoskin
