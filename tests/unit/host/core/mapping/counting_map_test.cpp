// Maps in which range sensors that see a cone have counted. The oracle keeps every voxel's counts in a
// std::map and does the arithmetic of docs/concepts/map.md in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "host/core/mapping/fused_map.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

constexpr std::uint16_t kZero = 32768;

VoxelKey key_at(int x, int y = 0, int z = 0) {
    return {static_cast<std::uint16_t>(kZero + x), static_cast<std::uint16_t>(kZero + y),
            static_cast<std::uint16_t>(kZero + z)};
}

MapConfig map_config() {
    MapConfig config;
    config.counts = {.prior_hits = 0.4F,
                     .prior_misses = 0.6F,
                     .occupied_hits = 25.0F,
                     .free_misses = 8.0F,
                     .occupied_probability = 0.45F,
                     .hits_min = 0.35F,
                     .misses_min = 0.7F,
                     .counts_max = 20.0F,
                     .image_clears = 0.25F,
                     .image_marks = 0.0F,
                     .range_clears = 0.0F};
    return config;
}

struct Oracle {
    struct Voxel {
        std::optional<double> other;
        double hits = 0.0;
        double misses = 0.0;
        bool was_known = false;
        [[nodiscard]] double for_it() const { return 0.4 + hits + 25.0 * std::max(0.0, known()) / 3.5; }
        [[nodiscard]] double against_it() const { return 0.6 + misses + 8.0 * std::max(0.0, -known()) / 2.0; }
        [[nodiscard]] double probability() const { return for_it() / (for_it() + against_it()); }
        [[nodiscard]] double known() const { return other.value_or(0.0); }
        [[nodiscard]] bool is_counted() const { return hits > 0.0 || misses > 0.0; }
        /// Single precision may lie on the other side of a threshold.
        [[nodiscard]] bool is_on_edge() const {
            return std::abs(hits - 0.35) < 1e-4 || std::abs(misses - 0.7) < 1e-4 ||
                   (other && std::abs(*other) < 1e-4);
        }
        [[nodiscard]] std::optional<double> log_odds() const {
            if (!is_counted()) return other;
            const double sum = std::clamp(std::log(for_it() / against_it() * 0.55 / 0.45), -2.0, 3.5);
            const bool is_marked = probability() >= 0.45 && (hits >= 0.35 || (other && *other >= 0.0));
            if (is_marked) return sum;
            if (!other && misses <= 0.7 && !was_known) return std::nullopt;
            return std::min(sum, -1e-30);
        }
        void settle() {
            const double sum = hits + misses;
            hits *= sum > 20.0 ? 20.0 / sum : 1.0;
            misses *= sum > 20.0 ? 20.0 / sum : 1.0;
            was_known = log_odds().has_value();
        }
    };
    std::map<VoxelKey, Voxel> voxels;

    void add(VoxelKey key, double term) {
        Voxel& voxel = voxels[key];
        voxel.other = std::clamp(voxel.known() + term, -2.0, 3.5);
        voxel.was_known = true;
    }
    /// An image all of whose rays pass the voxel.
    void see_through(VoxelKey key) {
        Voxel& voxel = voxels[key];
        voxel.hits = 0.75 * voxel.hits < 0.01 ? 0.0 : 0.75 * voxel.hits;
        add(key, -0.4);
    }
    void count(const ConeVoxels& cone, const ConeModel& model) {
        double sum = 0.0;
        for (const CapVoxel& cap : cone.cap)
            sum += static_cast<double>(cap.weight) * voxels[cap.key].probability();
        std::map<VoxelKey, double> shares;
        for (const CapVoxel& cap : cone.cap)
            shares[cap.key] = static_cast<double>(model.hit_mass) * static_cast<double>(cap.weight) *
                              voxels[cap.key].probability() / sum;
        for (const auto& [key, share] : shares) {
            voxels[key].hits += share;
            voxels[key].settle();
        }
        for (const VoxelKey key : cone.passed) {
            voxels[key].misses += static_cast<double>(model.miss_mass);
            voxels[key].settle();
        }
    }
};

void expect_equal(const FusedMap& map, const Oracle& oracle) {
    std::size_t known = 0;
    std::size_t on_edge = 0;
    for (const auto& [key, voxel] : oracle.voxels) {
        const auto expected = voxel.log_odds();
        const auto found = map.log_odds(key);
        if (voxel.is_on_edge()) {
            ++on_edge;
            known += found ? 1U : 0U;
            continue;
        }
        ASSERT_EQ(found.has_value(), expected.has_value());
        known += expected ? 1U : 0U;
        if (expected) {
            ASSERT_NEAR(*found, *expected, 2e-4);
        }
    }
    EXPECT_EQ(map.known_voxels(), known);
    EXPECT_LE(on_edge, oracle.voxels.size() / 20);
}

TEST(CountingMap, shares_a_hit_by_weight_and_what_was_known) {
    FusedMap map(map_config());
    feed(map, std::vector<VoxelUpdate>{{key_at(0), 3.5F}});
    ConeVoxels cone;
    cone.cap = {{key_at(0), 1.0F}, {key_at(1), 1.0F}, {key_at(2), 0.5F}};
    feed(map, cone, {});
    // P before: 25.4 / 26 = 0.97692, 0.4, 0.4; their weighted sum 1.57692.
    const CountLayer& counts = map.layers().counts;
    const MortonCode brick = brick_of(key_at(0));
    EXPECT_NEAR(counts.hits.find(brick).at(cell_of(key_at(0))), 0.61951, 1e-5);
    EXPECT_NEAR(counts.hits.find(brick).at(cell_of(key_at(1))), 0.25366, 1e-5);
    EXPECT_NEAR(counts.hits.find(brick).at(cell_of(key_at(2))), 0.12683, 1e-5);
}

TEST(CountingMap, leaves_unknown_what_a_cap_merely_touches) {
    FusedMap map(map_config());
    ConeVoxels cone;
    for (int x = 0; x < 4; ++x) cone.cap.push_back({key_at(x), 1.0F});
    feed(map, cone, {});  // a quarter of a hit each, less than 0.35
    EXPECT_EQ(map.known_voxels(), 0U);
    feed(map, cone, {});
    EXPECT_EQ(map.known_voxels(), 4U);
    EXPECT_EQ(map.occupancy(key_at(2)), Occupancy::occupied);
}

TEST(CountingMap, frees_what_is_passed_but_not_a_surface_that_the_camera_is_sure_of) {
    FusedMap map(map_config());
    for (int i = 0; i < 4; ++i) feed(map, std::vector<VoxelUpdate>{{key_at(0), 1.0F}});
    ConeVoxels cone;
    cone.passed = {key_at(0), key_at(1)};
    for (int i = 0; i < 100; ++i) feed(map, cone, {});
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied);
    EXPECT_EQ(map.occupancy(key_at(1)), Occupancy::free);
}

TEST(CountingMap, is_fused_anew_when_the_camera_speaks_after_the_counts) {
    FusedMap map(map_config());
    ConeVoxels cone;
    cone.cap = {{key_at(0), 1.0F}};
    feed(map, cone, {});
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied);
    Evidence terms;
    terms.miss = -0.4F;
    terms.take_image({{key_at(0), -0.4F}});
    feed(map, terms);  // 0.75 hits are left, and 1.6 misses are as good as known
    EXPECT_NEAR(map.log_odds(key_at(0)).value(), std::log(1.15 / 2.2 * 0.55 / 0.45), 1e-5);
}

TEST(CountingMap, loses_hits_where_every_image_sees_through) {
    FusedMap map(map_config());
    ConeVoxels cone;
    cone.cap = {{key_at(0), 1.0F}};
    for (int i = 0; i < 20; ++i) feed(map, cone, {});
    Evidence terms;
    terms.miss = -0.4F;
    terms.take_image({{key_at(0), -0.4F}});
    for (int i = 0; i < 40; ++i) feed(map, terms);
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::free);
    EXPECT_EQ(map.layers().counts.hits.find(brick_of(key_at(0))).at(cell_of(key_at(0))), 0.0F);
}

TEST(CountingMap, equals_the_arithmetic_of_every_voxel_on_its_own) {
    std::mt19937 random(7);
    std::uniform_int_distribution<int> place(0, 11);
    std::uniform_real_distribution<float> real(0.01F, 1.0F);
    FusedMap map(map_config());
    Oracle oracle;
    const ConeModel model{.hit_mass = 0.8F, .miss_mass = 0.6F};
    const auto any_key = [&] { return key_at(place(random), place(random), place(random) / 3); };
    for (int step = 0; step < 600; ++step) {
        if (step % 3 == 0) {
            std::map<VoxelKey, float> terms;
            for (int i = 0; i < 40; ++i) terms[any_key()] = real(random) > 0.4F ? -0.4F : 0.5F;
            std::vector<VoxelUpdate> updates;
            for (const auto& [key, term] : terms) {
                updates.push_back({key, term});
                step % 6 == 0 && term < 0.0F ? oracle.see_through(key)
                                             : oracle.add(key, static_cast<double>(term));
            }
            Evidence depth;
            depth.miss = -0.4F;
            depth.take_image(updates);
            step % 6 == 0 ? feed(map, depth) : feed(map, updates);
        } else {
            ConeVoxels cone;
            std::map<VoxelKey, float> cap;
            for (int i = 0; i < 10; ++i) cap[any_key()] = real(random);
            for (const auto& [key, weight] : cap) cone.cap.push_back({key, weight});
            std::set<VoxelKey> passed;  // each once, as a cone passes them
            while (passed.size() < 3) passed.insert(any_key());
            cone.passed.assign(passed.begin(), passed.end());
            feed(map, cone, model);
            oracle.count(cone, model);
        }
    }
    expect_equal(map, oracle);
}

TEST(CountingMap, copies_keep_what_they_were_and_go_on_the_same_way) {
    FusedMap map(map_config());
    ConeVoxels cone;
    cone.cap = {{key_at(0), 1.0F}, {key_at(1), 0.5F}};
    cone.passed = {key_at(-1)};
    feed(map, cone, {});
    FusedMap copy = map.copy();
    const auto before = copy.log_odds(key_at(0));
    feed(map, cone, {});
    EXPECT_EQ(copy.log_odds(key_at(0)), before);
    feed(copy, cone, {});
    EXPECT_EQ(copy.log_odds(key_at(0)), map.log_odds(key_at(0)));
    EXPECT_EQ(copy.log_odds(key_at(-1)), map.log_odds(key_at(-1)));
}

TEST(CountingMap, tells_what_changed) {
    FusedMap map(map_config());
    ConeVoxels cone;
    cone.cap = {{key_at(0), 1.0F}};
    cone.passed = {key_at(-1)};
    std::vector<VoxelUpdate> changes;
    feed(map, cone, {.hit_mass = 1.0F, .miss_mass = 1.0F}, false, &changes);
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_EQ(changes[0], (VoxelUpdate{key_at(0), map.log_odds(key_at(0)).value()}));
    EXPECT_EQ(changes[1], (VoxelUpdate{key_at(-1), map.log_odds(key_at(-1)).value()}));
}

TEST(CountingMap, counts_within_three_quarters_more_memory) {
    MapConfig config = map_config();
    config.memory_max_mib = 1;
    FusedMap map(config);
    ConeVoxels cone;
    for (int x = 0; x < 1000; ++x) cone.passed.push_back(key_at(8 * x));
    feed(map, cone, {});
    EXPECT_GT(map.counters().no_room, 0U);
    EXPECT_EQ(map.counters().applied + map.counters().no_room, 1000U);
    EXPECT_LE(map.layers().counts.heap_bytes(), std::size_t{3} << 18U);
    EXPECT_LE(map.memory_bytes(), std::size_t{1} << 20U);
}

TEST(CountingMap, is_fused_anew_with_other_limits) {
    FusedMap map(map_config());
    ConeVoxels cone;
    for (int x = 0; x < 4; ++x) cone.cap.push_back({key_at(x), 1.0F});
    feed(map, cone, {});
    MapConfig config = map_config();
    config.counts.hits_min = 0.2F;
    map.limit(config);
    EXPECT_EQ(map.occupancy(key_at(3)), Occupancy::occupied);
    config.log_odds_max = 0.1F;
    map.limit(config);
    EXPECT_EQ(map.log_odds(key_at(3)), 0.1F);
}

TEST(CountingMap, takes_no_space_for_what_other_limits_leave_unknown) {
    FusedMap map(map_config());
    ConeVoxels cone;
    for (int x = 0; x < 100; ++x) cone.cap.push_back({key_at(8 * x), 1.0F});
    feed(map, cone, {});
    ASSERT_EQ(map.known_voxels(), 0U);
    MapConfig config = map_config();
    config.counts.hits_min *= 1.5F;
    map.limit(config);
    EXPECT_TRUE(map.bricks().empty());
    EXPECT_TRUE(map.layers().counts.has(brick_of(key_at(0)))) << "what was counted goes on";
}

/// A cap of three voxels, one of them its middle.
ConeVoxels cap_of_three() {
    ConeVoxels cone;
    cone.cap = {{key_at(0), 1.0F}, {key_at(1), 0.5F}, {key_at(2), 0.5F}};
    cone.middle = {key_at(0)};
    return cone;
}

TEST(CountingMap, marks_the_middle_of_what_is_believed_however_free_it_was) {
    for (const bool has_camera : {false, true}) {
        FusedMap map(map_config());
        if (has_camera) feed(map, std::vector<VoxelUpdate>{{key_at(0), -2.0F}});
        ConeVoxels through;
        through.passed = {key_at(0), key_at(1)};
        for (int i = 0; i < 100; ++i) feed(map, through, {});
        EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::free);
        std::vector<VoxelUpdate> changes;
        const float before = map.log_odds(key_at(0)).value();
        confirm(map, cap_of_three(), 0.0F, &changes);
        EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied) << "with no more hits than it takes";
        EXPECT_EQ(map.occupancy(key_at(1)), Occupancy::free);
        EXPECT_EQ(map.occupancy(key_at(2)), Occupancy::unknown);
        ASSERT_EQ(changes.size(), 1U);
        EXPECT_EQ(changes.front().key, key_at(0));
        EXPECT_NEAR(before + changes.front().log_odds, map.log_odds(key_at(0)).value(), 1e-5);
        feed(map, through, {});
        EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::free) << "and one reading takes it back";
    }
}

TEST(CountingMap, leaves_what_is_marked_as_many_hits_as_it_is_told) {
    FusedMap map(map_config());
    confirm(map, cap_of_three(), 2.0F);
    const CountLayer& counts = map.layers().counts;
    const MortonCode brick = brick_of(key_at(0));
    EXPECT_EQ(counts.hits.find(brick).at(cell_of(key_at(0))), 2.0F);
    EXPECT_EQ(counts.misses.find(brick).at(cell_of(key_at(0))), 0.0F);
    EXPECT_EQ(counts.hits.find(brick).at(cell_of(key_at(1))), 0.0F);
    EXPECT_EQ(map.known_voxels(), 1U);
    EXPECT_EQ(map.counters().applied, 1U);
}

TEST(CountingMap, marks_nothing_where_something_known_explains_the_range) {
    FusedMap map(map_config());
    feed(map, std::vector<VoxelUpdate>{{key_at(2), 1.0F}});
    const auto before = map.counters();
    confirm(map, cap_of_three(), 2.0F);
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::unknown);
    EXPECT_EQ(map.counters(), before);
}

TEST(CountingMap, confirms_what_it_marks) {
    FusedMap map(map_config());
    map.advance_time(HostTime{5'000'000'000});
    confirm(map, cap_of_three(), 2.0F);
    EXPECT_EQ(map.confirmation(key_at(0)), (Confirmation{0, SensorKind::range}));
}

const auto kNobodyRanges = [](VoxelKey) { return false; };

TEST(CountingMap, frees_at_once_what_is_surely_seen_through_however_sure_it_was) {
    for (const int images : {0, 1, 20}) {
        for (const int hits : {0, 1, 60}) {
            FusedMap map(map_config());
            ConeVoxels onto;
            onto.cap = {{key_at(0), 1.0F}};
            for (int i = 0; i < images; ++i) feed(map, std::vector<VoxelUpdate>{{key_at(0), 1.0F}});
            for (int i = 0; i < hits; ++i) feed(map, onto, {});
            feed(map, std::vector<VoxelUpdate>{{key_at(1), -1.0F}});
            const auto before = map.copy();
            ConeVoxels through;
            through.passed = {key_at(0), key_at(1), key_at(2)};
            std::vector<VoxelUpdate> changes;
            clear(map, through, kNobodyRanges, &changes);
            EXPECT_EQ(map.log_odds(key_at(1)), before.log_odds(key_at(1))) << "what is free stays as it is";
            EXPECT_EQ(map.occupancy(key_at(2)), Occupancy::unknown);
            if (before.occupancy(key_at(0)) != Occupancy::occupied) {
                EXPECT_TRUE(changes.empty());
                continue;
            }
            EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::free) << images << " images, " << hits << " hits";
            ASSERT_EQ(changes.size(), 1U);
            EXPECT_NEAR(*before.log_odds(key_at(0)) + changes[0].log_odds, *map.log_odds(key_at(0)), 1e-5);
            for (int i = 0; i < 2; ++i) feed(map, std::vector<VoxelUpdate>{{key_at(0), 0.8F}});
            EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied) << "and may come again";
        }
    }
}

// As the pipeline does it: what is passed is counted first.
TEST(CountingMap, takes_nothing_from_what_the_camera_sees_again_and_again) {
    FusedMap map(map_config());
    const std::vector<VoxelUpdate> surface{{key_at(0), 1.0F}};
    ConeVoxels through;
    through.passed = {key_at(0), key_at(1)};
    for (int tenth = 0; tenth < 60; ++tenth) {
        for (int reading = 0; reading < 3; ++reading) {
            map.advance_time(HostTime{(100 * tenth + 33 * reading) * 1'000'000LL});
            if (reading == 1) feed(map, surface, SensorKind::camera);
            feed(map, through, {});
            clear(map, through, kNobodyRanges);
            ASSERT_TRUE(tenth <= 2 || map.occupancy(key_at(0)) == Occupancy::occupied) << tenth;
        }
    }
    EXPECT_EQ(map.confirmation(key_at(1)), (Confirmation{0, SensorKind::range}));
    EXPECT_EQ(map.confirmation(key_at(0)), (Confirmation{0, SensorKind::camera}));
    map.advance_time(HostTime{8'000'000'000});
    clear(map, through, kNobodyRanges);
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::free) << "it no longer looks";
}

TEST(CountingMap, gives_hits_to_all_where_nothing_is_that_could_take_them) {
    FusedMap reported(map_config());
    FusedMap unreported(map_config());
    feed(reported, cap_of_three(), {}, true);
    feed(unreported, cap_of_three(), {}, false);
    for (const int i : {0, 1, 2}) EXPECT_EQ(reported.log_odds(key_at(i)), unreported.log_odds(key_at(i)));
    for (int reading = 0; reading < 20; ++reading) feed(reported, cap_of_three(), {}, true);
    EXPECT_EQ(reported.occupancy(key_at(0)), Occupancy::occupied);
}

TEST(CountingMap, sees_what_has_no_weight_and_gives_it_nothing) {
    FusedMap map(map_config());
    map.advance_time(HostTime{1'000'000'000});
    feed(map, std::vector<VoxelUpdate>{{key_at(1), 2.0F}});
    const auto before = map.copy();
    ConeVoxels cone = cap_of_three();
    cone.cap[1].weight = 0.0F;
    cone.cap[2].weight = 0.0F;
    map.advance_time(HostTime{9'000'000'000});
    feed(map, cone, {.hit_mass = 10.0F});
    EXPECT_EQ(map.log_odds(key_at(1)), before.log_odds(key_at(1)));
    EXPECT_EQ(map.confirmation(key_at(1)), (Confirmation{0, SensorKind::range})) << "it is there, as it says";
    EXPECT_FALSE(map.confirmation(key_at(2)));
    confirm(map, cone, 2.0F);
    EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied) << "what has no weight explains nothing";
}

TEST(CountingMap, takes_back_hits_that_mark_nothing) {
    FusedMap map(map_config());
    confirm(map, cap_of_three(), 2.0F);
    ConeVoxels cap = cap_of_three();
    cap.cap.push_back({key_at(3), 1.0F});
    feed(map, std::vector<VoxelUpdate>{{key_at(2), -1.0F}});
    const auto free_before = map.log_odds(key_at(2));
    for (int event = 0; event < 100; ++event) {
        feed(map, cap, {.hit_mass = 0.5F});
        const auto before = map.copy();
        std::vector<VoxelUpdate> changes;
        withdraw(map, cap, &changes);
        for (const VoxelUpdate& change : changes)
            EXPECT_NEAR(*before.log_odds(change.key) + change.log_odds, *map.log_odds(change.key), 1e-5);
        EXPECT_EQ(map.occupancy(key_at(0)), Occupancy::occupied);
        EXPECT_EQ(map.occupancy(key_at(1)), Occupancy::unknown) << event;
        EXPECT_NEAR(*map.log_odds(key_at(2)), *free_before, 1e-5) << event;
        EXPECT_EQ(map.occupancy(key_at(3)), Occupancy::unknown) << event;
    }
}

TEST(CountingMap, gives_hits_to_what_is_there_and_nothing_else_if_it_is_told_so) {
    FusedMap map(map_config());
    map.advance_time(HostTime{1'000'000'000});
    confirm(map, cap_of_three(), 2.0F);
    const auto before = map.copy();
    map.advance_time(HostTime{9'000'000'000});
    feed(map, cap_of_three(), {}, true);
    for (const int i : {1, 2, 3}) EXPECT_EQ(map.log_odds(key_at(i)), before.log_odds(key_at(i))) << i;
    EXPECT_GT(*map.log_odds(key_at(0)), *before.log_odds(key_at(0)));
    EXPECT_EQ(map.confirmation(key_at(0)), (Confirmation{0, SensorKind::range}));
}

TEST(CountingMap, frees_not_what_others_see_at_the_same_time) {
    FusedMap map(map_config());
    const std::vector<VoxelUpdate> surface{{key_at(0), 1.0F}, {key_at(1), 1.0F}};
    const auto occupied = [&] {
        return std::pair(map.occupancy(key_at(0)) == Occupancy::occupied,
                         map.occupancy(key_at(1)) == Occupancy::occupied);
    };
    ConeVoxels through;
    through.passed = {key_at(0), key_at(1)};
    map.advance_time(HostTime{10'900'000'000});
    for (int i = 0; i < 3; ++i) feed(map, surface, SensorKind::camera);
    map.advance_time(HostTime{11'900'000'000});
    clear(map, through, kNobodyRanges);
    EXPECT_EQ(occupied(), std::pair(true, true)) << "the camera, in the second before";
    map.advance_time(HostTime{12'000'000'000});
    clear(map, through, [](VoxelKey key) { return key == key_at(1); });
    EXPECT_EQ(occupied(), std::pair(false, true));
    for (int i = 0; i < 3; ++i) feed(map, surface, SensorKind::range);
    clear(map, through, kNobodyRanges);
    EXPECT_EQ(occupied(), std::pair(false, false)) << "an earlier range does not count";
}

}  // namespace
}  // namespace octoskin
