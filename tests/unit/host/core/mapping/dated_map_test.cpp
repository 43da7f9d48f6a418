// When voxels were confirmed, by what, and what becomes of those that nobody confirms. The oracle of the
// random test keeps a time and a kind for each voxel.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

constexpr std::uint16_t kZero = 32768;

VoxelKey key_at(int x, int y = 0, int z = 0) {
    return {static_cast<std::uint16_t>(kZero + x), static_cast<std::uint16_t>(kZero + y),
            static_cast<std::uint16_t>(kZero + z)};
}
HostTime at_s(double seconds) {
    return {static_cast<std::int64_t>(seconds * 1e9)};
}
MapConfig aging(std::uint32_t stale_after_s, std::uint32_t unknown_after_s) {
    MapConfig config;
    config.age = {stale_after_s, unknown_after_s};
    return config;
}
std::vector<VoxelUpdate> one(VoxelKey key, float term) {
    return {{key, term}};
}
Evidence image_of(std::vector<VoxelUpdate> updates) {
    Evidence terms;
    terms.miss = -0.4F;
    terms.take_image(std::move(updates));
    return terms;
}
Confirmation by(SensorKind kind, std::uint32_t age_s) {
    return {age_s, kind};
}

TEST(DatedMap, keeps_no_times_before_it_is_told_one) {
    FusedMap map(aging(1, 2));
    feed(map, one(key_at(0), 1.0F));
    EXPECT_FALSE(map.confirmation(key_at(0)).has_value());
    EXPECT_FALSE(map.is_stale(key_at(0)));
    EXPECT_EQ(map.layers().ages.heap_bytes(), 0U);
}

TEST(DatedMap, knows_when_and_by_what_a_voxel_was_last_confirmed) {
    FusedMap map(MapConfig{});
    map.advance_time(at_s(100.9));
    feed(map, one(key_at(0), -0.4F));
    feed(map, image_of({{key_at(1), -0.4F}, {key_at(2), 0.8F}}));
    map.advance_time(at_s(107.0));
    feed(map, one(key_at(2), 0.5F));
    EXPECT_EQ(map.confirmation(key_at(0)), by(SensorKind::range, 7));
    EXPECT_EQ(map.confirmation(key_at(1)), by(SensorKind::camera, 7));
    EXPECT_EQ(map.confirmation(key_at(2)), by(SensorKind::range, 0));
    EXPECT_FALSE(map.confirmation(key_at(3)).has_value()) << "unknown";
}

TEST(DatedMap, is_confirmed_by_what_changes_nothing_at_a_clamp_but_not_by_a_term_of_zero) {
    FusedMap map(MapConfig{});
    map.advance_time(at_s(0));
    for (int i = 0; i < 9; ++i) feed(map, one(key_at(0), -0.4F));
    feed(map, one(key_at(1), -0.4F));
    map.advance_time(at_s(5));
    feed(map, one(key_at(0), -0.4F));
    feed(map, one(key_at(1), 0.0F));
    EXPECT_EQ(map.confirmation(key_at(0))->age_s, 0U);
    EXPECT_EQ(map.confirmation(key_at(1))->age_s, 5U);
}

TEST(DatedMap, has_what_it_held_when_its_clock_began_stale_until_it_is_confirmed_or_unknown) {
    FusedMap map(aging(10, 20));
    feed(map, one(key_at(0), -0.4F));
    feed(map, one(key_at(100), -0.4F));
    map.advance_time(at_s(50));
    EXPECT_FALSE(map.confirmation(key_at(0)).has_value()) << "nobody knows";
    EXPECT_TRUE(map.is_stale(key_at(0)));
    feed(map, one(key_at(100), -0.4F));
    EXPECT_FALSE(map.is_stale(key_at(100)));
    map.advance_time(at_s(69.9));
    EXPECT_EQ(map.known_voxels(), 2U);
    feed(map, one(key_at(100), -0.4F));
    map.advance_time(at_s(70));
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::unknown);
    EXPECT_EQ(map.known_voxels(), 1U);
}

TEST(DatedMap, knows_no_more_of_what_was_before_its_clock_when_that_has_run_for_days) {
    FusedMap map(aging(10, 0));
    feed(map, one(key_at(0), -0.4F));
    for (double s = 0; s < 50'000; s += 900) map.advance_time(at_s(s));
    EXPECT_FALSE(map.confirmation(key_at(0)).has_value());
    EXPECT_TRUE(map.is_stale(key_at(0)));
}

TEST(DatedMap, becomes_stale_and_then_unknown) {
    FusedMap map(aging(10, 20));
    map.advance_time(at_s(0));
    feed(map, one(key_at(0), 3.0F));
    feed(map, one(key_at(100), -0.4F));
    map.advance_time(at_s(19));
    EXPECT_TRUE(map.is_stale(key_at(0)));
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied);
    EXPECT_EQ(map.known_voxels(), 2U);
    feed(map, one(key_at(100), -0.4F));
    map.advance_time(at_s(20));
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::unknown);
    EXPECT_FALSE(map.is_stale(key_at(0)));
    EXPECT_EQ(map.occupancy(key_at(100)), Occupancy::free);
    EXPECT_EQ(map.known_voxels(), 1U);
    feed(map, one(key_at(0), 0.5F));
    EXPECT_EQ(map.log_odds(key_at(0)), 0.5F) << "as if nobody had ever been there";
    map.advance_time(at_s(1000));
    EXPECT_EQ(map.known_voxels(), 0U);
    EXPECT_EQ(map.heap_bytes(), 0U);
}

TEST(DatedMap, forgets_counts_of_what_it_forgets) {
    FusedMap map(aging(0, 5));
    map.advance_time(at_s(0));
    ConeVoxels cone;
    cone.passed = {key_at(0)};
    for (int i = 0; i < 20; ++i) feed(map, cone, {});
    EXPECT_EQ(map.confirmation(key_at(0)), by(SensorKind::range, 0));
    map.advance_time(at_s(5));
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::unknown);
    EXPECT_FALSE(map.layers().counts.has(brick_of(key_at(0)))) << "an emptied brick is given back";
    feed(map, cone, {});
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::unknown) << "one reading does not free it";
}

TEST(DatedMap, has_of_a_cap_only_what_is_occupied_confirmed) {
    FusedMap map(MapConfig{});
    map.advance_time(at_s(0));
    feed(map, one(key_at(0), -2.0F));
    for (int i = 0; i < 4; ++i) feed(map, one(key_at(1), 1.0F));
    map.advance_time(at_s(30));
    ConeVoxels cone;
    cone.cap = {{key_at(0), 1.0F}, {key_at(1), 1.0F}};
    feed(map, cone, {});
    EXPECT_EQ(map.confirmation(key_at(0))->age_s, 30U);
    EXPECT_EQ(map.confirmation(key_at(1)), by(SensorKind::range, 0));
}

TEST(DatedMap, adds_no_hits_up_over_longer_than_it_knows_anything) {
    FusedMap map(aging(0, 600));
    ConeVoxels cone;  // a hit of a hundred voxels marks none of them
    for (int x = 0; x < 100; ++x) cone.cap.push_back({key_at(x), 1.0F});
    for (int hour = 0; hour < 100; ++hour) {
        map.advance_time(at_s(3600.0 * hour));
        feed(map, cone, {});
    }
    EXPECT_EQ(map.known_voxels(), 0U);
    EXPECT_FALSE(map.confirmation(key_at(0)).has_value()) << "unknown";
    map.advance_time(at_s(3600.0 * 100));
    EXPECT_TRUE(map.layers().counts.empty());
    EXPECT_EQ(map.heap_bytes(), 0U);
    for (int reading = 0; reading < 100; ++reading) feed(map, cone, {});
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied) << "so many would have marked it at once";
}

TEST(DatedMap, forgets_hits_of_an_unknown_voxel_whose_neighbours_are_confirmed) {
    FusedMap map(aging(0, 5));
    ConeVoxels cone;
    for (int x = 0; x < 100; ++x) cone.cap.push_back({key_at(x), 1.0F});
    for (int second = 0; second < 800; second += 4) {
        map.advance_time(at_s(second));
        if (second % 8 == 0) feed(map, cone, {});
        feed(map, one(key_at(0, 1), -0.4F));
    }
    EXPECT_EQ(map.known_voxels(), 1U) << "each was forgotten before the next";
}

TEST(DatedMap, is_confirmed_by_a_cone_of_which_one_voxel_finds_no_room) {
    MapConfig config = aging(10, 60);
    config.memory_max_mib = 1;
    FusedMap map(config);
    map.advance_time(at_s(0));
    ConeVoxels cone;
    cone.passed = {key_at(0), key_at(1)};
    for (int i = 0; i < 20; ++i) feed(map, cone, {});
    for (int x = 1; x < 2000; ++x) feed(map, one(key_at(-8 * x), -0.4F));
    ASSERT_GT(map.counters().no_room, 0U);
    cone.passed.push_back(key_at(0, 4000));
    const auto before = map.counters();
    for (int second = 1; second <= 20; ++second) {
        map.advance_time(at_s(second));
        feed(map, cone, {});
    }
    EXPECT_GT(map.counters().no_room, before.no_room) << "as soon as it would be free";
    EXPECT_EQ(map.confirmation(key_at(0)), by(SensorKind::range, 0));
    EXPECT_EQ(map.confirmation(key_at(1)), by(SensorKind::range, 0));
}

TEST(DatedMap, waits_for_late_measurements_and_follows_a_clock_that_was_set_back) {
    FusedMap map(MapConfig{});
    map.advance_time(at_s(100));
    feed(map, one(key_at(0), 1.0F));
    map.advance_time(at_s(103));
    map.advance_time(at_s(102));
    EXPECT_EQ(map.confirmation(key_at(0))->age_s, 3U);
    map.advance_time(at_s(7));
    EXPECT_EQ(map.confirmation(key_at(0))->age_s, 3U);
    map.advance_time(at_s(9));
    EXPECT_EQ(map.confirmation(key_at(0))->age_s, 5U);
}

TEST(DatedMap, grows_no_older_where_time_leaps_and_goes_on_growing_old_after) {
    for (const int leap_s : {1000, 100'000, -50, -100'000}) {
        FusedMap map(aging(10, 20));
        map.advance_time(at_s(100));
        feed(map, one(key_at(0), 1.0F));
        map.advance_time(at_s(103));
        map.jump_time(std::chrono::seconds(leap_s));
        map.advance_time(at_s(104 + leap_s));
        ASSERT_TRUE(map.confirmation(key_at(0)).has_value()) << leap_s;
        EXPECT_EQ(map.confirmation(key_at(0))->age_s, 4U);
        map.advance_time(at_s(119 + leap_s));
        EXPECT_EQ(map.confirmation(key_at(0))->age_s, 19U);
        map.advance_time(at_s(120 + leap_s));
        EXPECT_EQ(map.known_voxels(), 0U);
    }
}

TEST(DatedMap, leaps_by_the_nearest_second) {
    FusedMap map(MapConfig{});
    map.advance_time(at_s(100.5));
    feed(map, one(key_at(0), 1.0F));
    map.jump_time(std::chrono::milliseconds(2'700));
    map.advance_time(at_s(105.2));  // 2.0 s have passed
    EXPECT_EQ(map.confirmation(key_at(0))->age_s, 2U);
}

TEST(DatedMap, tells_ages_over_days) {
    FusedMap map(MapConfig{});
    map.advance_time(at_s(-3));
    feed(map, one(key_at(0), 1.0F));
    for (double s = 0; s < 200'000; s += 997) {
        map.advance_time(at_s(s));
        feed(map, one(key_at(1), 1.0F));
        EXPECT_EQ(map.confirmation(key_at(0))->age_s, std::min(s + 3, 8191.0));
        EXPECT_EQ(map.confirmation(key_at(1))->age_s, 0U);
    }
    map.advance_time(at_s(1e6));
    EXPECT_EQ(map.confirmation(key_at(1)), by(SensorKind::range, 8191));
}

TEST(DatedMap, forgets_in_time_when_its_clock_is_brought_up_meanwhile) {
    FusedMap map(aging(0, 7000));
    for (int second = 0; second <= 8000; second += 1000) {
        map.advance_time(at_s(second));
        feed(map, one(key_at(100), 1.0F));
    }
    feed(map, one(key_at(0), 1.0F));
    map.advance_time(at_s(9000));  // beyond what a stamp can hold
    feed(map, one(key_at(100), 1.0F));
    map.advance_time(at_s(14'999));
    EXPECT_EQ(map.confirmation(key_at(0))->age_s, 6999U);
    map.advance_time(at_s(15'000));
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::unknown);
    map.advance_time(at_s(15'999));
    EXPECT_EQ(map.known_voxels(), 1U);
    map.advance_time(at_s(16'000));
    EXPECT_EQ(map.known_voxels(), 0U);
}

TEST(DatedMap, keeps_what_was_when_a_copy_goes_on) {
    FusedMap map(aging(10, 20));
    map.advance_time(at_s(0));
    feed(map, one(key_at(0), 1.0F));
    FusedMap copy = map.copy();
    copy.advance_time(at_s(20));
    EXPECT_EQ(copy.known_voxels(), 0U);
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied);
    EXPECT_EQ(map.confirmation(key_at(0))->age_s, 0U);
}

TEST(DatedMap, copies_nothing_that_is_confirmed_again_within_a_second) {
    FusedMap map(MapConfig{});
    map.advance_time(at_s(0));
    const Evidence image = image_of({{key_at(0), -0.4F}, {key_at(1), 0.8F}});
    feed(map, image);
    const FusedMap copy = map.copy();
    map.advance_time(at_s(0.9));
    feed(map, image);
    copy.layers().ages.stamps().for_each_difference(map.layers().ages.stamps(),
                                                    [](MortonCode) { ADD_FAILURE() << "nothing changed"; });
}

TEST(DatedMap, has_its_times_within_a_bound_and_counts_what_has_none) {
    MapConfig config = aging(10, 0);
    config.memory_max_mib = 1;
    FusedMap map(config);
    map.advance_time(at_s(0));
    std::vector<VoxelUpdate> updates;  // each in a brick and in nodes of its own: the worst there is
    for (int x = 0; x < 2000; ++x) updates.push_back({key_at(64 * (x % 100), 64 * (x / 100)), -0.4F});
    feed(map, updates);
    EXPECT_LE(map.layers().ages.heap_bytes(), std::size_t{9} << 16U);
    EXPECT_LE(map.memory_bytes(), std::size_t{1} << 20U);
    std::uint64_t undated = 0;
    map.for_each_known([&](VoxelKey key, float) {
        undated += map.confirmation(key) ? 0U : 1U;
        EXPECT_EQ(map.is_stale(key), !map.confirmation(key)) << "what nobody knows of is not relied on";
    });
    EXPECT_EQ(map.counters().undated, undated);
}

TEST(DatedMap, that_was_saved_grows_older_by_what_it_is_given_until_its_first_measurement) {
    FusedMap map(aging(10, 0));
    EXPECT_FALSE(map.wait(5)) << "it has no time";
    map.advance_time(at_s(100));
    feed(map, one(key_at(0), 1.0F));
    EXPECT_FALSE(map.wait(5)) << "it goes on";
    map.begin_to_wait();
    EXPECT_TRUE(map.wait(3));
    EXPECT_FALSE(map.wait(3)) << "in all";
    EXPECT_FALSE(map.wait(2));
    EXPECT_TRUE(map.wait(8));
    EXPECT_EQ(map.confirmation(key_at(0)), by(SensorKind::range, 8));
    EXPECT_FALSE(map.is_stale(key_at(0)));
    map.advance_time(at_s(5'000'000));  // of another scale
    EXPECT_EQ(map.confirmation(key_at(0)), by(SensorKind::range, 8));
    EXPECT_FALSE(map.wait(100)) << "it has begun";
    map.advance_time(at_s(5'000'002));
    EXPECT_EQ(map.confirmation(key_at(0)), by(SensorKind::range, 10));
    EXPECT_TRUE(map.is_stale(key_at(0)));
    map.begin_to_wait();
    EXPECT_TRUE(map.wait(std::int64_t{1} << 40U));
    EXPECT_EQ(map.confirmation(key_at(0)), by(SensorKind::range, VoxelAges::kAgeMax_s));
    map.begin_to_wait();
    EXPECT_TRUE(map.wait(std::int64_t{1} << 40U));
    EXPECT_TRUE(VoxelAges::is_possible(map.layers().ages.clock()));
}

TEST(DatedMap, forgets_while_it_waits_what_no_sensor_has_seen_for_too_long) {
    FusedMap map(aging(10, 20));
    map.advance_time(at_s(0));
    feed(map, one(key_at(0), 1.0F));
    map.begin_to_wait();
    EXPECT_TRUE(map.wait(19));
    EXPECT_EQ(map.known_voxels(), 1U);
    EXPECT_TRUE(map.wait(21));
    EXPECT_EQ(map.known_voxels(), 0U);
}

TEST(DatedMap, without_its_times_has_all_voxels_stale_and_forgets_them_as_it_would_a_files) {
    FusedMap map(aging(10, 20));
    map.advance_time(at_s(100));
    feed(map, one(key_at(0), 1.0F));
    map.clear_times();
    map.advance_time(at_s(3));
    EXPECT_FALSE(map.confirmation(key_at(0)));
    EXPECT_TRUE(map.is_stale(key_at(0)));
    map.advance_time(at_s(22));
    EXPECT_EQ(map.known_voxels(), 1U);
    map.advance_time(at_s(24));
    EXPECT_EQ(map.known_voxels(), 0U);
}

/// A hit that may be of any of a hundred voxels marks none of them.
ConeVoxels hit_of_nothing_known() {
    ConeVoxels cone;
    for (int x = 0; x < 100; ++x) cone.cap.push_back({key_at(x), 1.0F});
    return cone;
}

TEST(DatedMap, without_its_times_forgets_counts_of_what_is_unknown_measured_or_not) {
    for (const bool is_measured : {false, true}) {
        FusedMap map(aging(0, 5));
        map.advance_time(at_s(100));
        feed(map, hit_of_nothing_known(), {});
        map.clear_times();
        const auto pass = [&](std::int64_t seconds) {
            is_measured ? map.advance_time(at_s(static_cast<double>(seconds))) : void(map.wait(seconds));
        };
        pass(0);
        pass(4);
        EXPECT_FALSE(map.layers().counts.empty());
        pass(5);
        EXPECT_TRUE(map.layers().counts.empty()) << is_measured;
        EXPECT_EQ(map.heap_bytes(), 0U);
    }
}

TEST(DatedMap, without_its_times_has_its_voxels_stale_at_once) {
    FusedMap map(aging(10, 0));
    map.advance_time(at_s(100));
    feed(map, one(key_at(0), 1.0F));
    map.clear_times();
    EXPECT_TRUE(map.is_stale(key_at(0)));
    EXPECT_FALSE(map.confirmation(key_at(0)));
}

/// With counts alone in some bricks, and one in which a voxel became known later.
FusedMap map_that_keeps_all() {
    FusedMap map(aging(0, 0));
    map.advance_time(at_s(0));
    feed(map, hit_of_nothing_known(), {});
    feed(map, one(key_at(0, 1), -0.4F));
    return map;
}

TEST(DatedMap, forgets_counts_of_before_voxels_were_to_expire) {
    FusedMap map = map_that_keeps_all();
    map.limit(aging(0, 5));
    map.advance_time(at_s(4));
    feed(map, one(key_at(0, 1), -0.4F));
    EXPECT_EQ(map.layers().counts.hits.bricks(), 13U);
    map.advance_time(at_s(5));
    EXPECT_EQ(map.layers().counts.hits.bricks(), 1U) << "it has the prior of the voxel that is known";
    EXPECT_EQ(map.layers().counts.hits.find(brick_of(key_at(1))).at(cell_of(key_at(1))), 0.0F);
    EXPECT_EQ(map.confirmation(key_at(0, 1)), by(SensorKind::range, 1));
    map.advance_time(at_s(9));
    EXPECT_TRUE(map.layers().counts.empty());
    EXPECT_EQ(map.heap_bytes(), 0U);
}

TEST(DatedMap, forgets_counts_that_were_saved_where_nothing_expired) {
    const FusedMap saved = map_that_keeps_all();
    FusedMap map(aging(0, 5), saved.layers(), saved.has_undated());
    map.begin_to_wait();
    EXPECT_TRUE(map.wait(5));
    EXPECT_TRUE(map.layers().counts.empty());
    EXPECT_EQ(map.known_voxels(), 0U);
}

TEST(VoxelAges, look_at_all_that_was_there_before_though_other_voxels_of_its_brick_are_confirmed) {
    constexpr MortonCode kBricks = 300;
    VoxelAges ages;
    (void)ages.advance_time(at_s(0));
    BrickMask confirmed{};
    put_in(confirmed, 7);
    for (MortonCode i = 0; i < kBricks; ++i) ages.confirm(i * kBrickVoxels, confirmed, SensorKind::range);
    const auto looked_at = [&] {
        std::size_t found = 0;
        ages.look_at_due(1, VoxelAges::kOfBefore + 1, [&](MortonCode brick) {
            found += ages.find(brick).at(8) == VoxelAges::kOfBefore ? 1U : 0U;
        });
        return found;
    };
    EXPECT_EQ(looked_at(), 0U);
    BrickMask there = confirmed;
    put_in(there, 8);
    for (MortonCode i = 0; i < kBricks; ++i) ages.take_from_before(i * kBrickVoxels, there);
    EXPECT_EQ(ages.find(0).at(7), ages.stamp(SensorKind::range));
    EXPECT_EQ(ages.find(0).at(9), 0U);
    EXPECT_GE(looked_at(), kBricks);
}

// Oracle: a std::map of times and kinds, the same terms without a clock for the log-odds.
TEST(DatedMap, equals_a_time_and_a_kind_kept_for_each_voxel) {
    struct Dated {
        int second = 0;
        SensorKind kind = SensorKind::none;
    };
    std::mt19937 random(3);
    const auto any_key = [&] {
        return key_at(static_cast<int>(random() % 20), static_cast<int>(random() % 9),
                      static_cast<int>(random() % 3));
    };
    FusedMap map(aging(4, 9));
    std::map<VoxelKey, Dated> oracle;
    int second = 0;
    map.advance_time(at_s(0));
    for (int step = 0; step < 400; ++step) {
        second += static_cast<int>(random() % 3);
        map.advance_time(at_s(second + 0.5));
        std::erase_if(oracle, [&](const auto& entry) { return second - entry.second.second >= 9; });
        std::set<VoxelKey> keys;
        for (unsigned i = 0; i < random() % 60; ++i) keys.insert(any_key());
        std::vector<VoxelUpdate> updates;
        for (const VoxelKey key : keys) updates.push_back({key, random() % 2 == 0 ? -0.4F : 0.7F});
        const bool is_image = random() % 2 == 0;
        is_image ? feed(map, image_of(updates)) : feed(map, updates);
        for (const VoxelKey key : keys)
            oracle[key] = {second, is_image ? SensorKind::camera : SensorKind::range};
        ASSERT_EQ(map.known_voxels(), oracle.size()) << "step " << step;
        for (const auto& [key, dated] : oracle) {
            ASSERT_EQ(map.confirmation(key),
                      by(dated.kind, static_cast<std::uint32_t>(second - dated.second)));
            ASSERT_EQ(map.is_stale(key), second - dated.second >= 4);
        }
    }
}

}  // namespace
}  // namespace octoskin
