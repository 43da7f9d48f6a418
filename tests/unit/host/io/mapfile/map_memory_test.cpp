// What a map takes of the heap, and what it does where there is none. A program of its own: every allocation
// in it is counted, and can be made to fail.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#include <span>
#include <vector>

#include "host/core/mapping/depth_integrator.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapfile/octomap_mirror.hpp"
#include "host/io/mapfile/octomap_tree.hpp"
#include "tests/support/allocation_hooks.hpp"
#include "tests/support/evidence.hpp"
#include "tests/support/scratch_folder.hpp"

namespace {

std::atomic<std::size_t> bytes_now = 0;
std::atomic<std::size_t> bytes_most = 0;
std::atomic<bool> is_memory_gone = false;
std::atomic<int> allocations_left = -1;  ///< before one fails; negative: none does

}  // namespace

static void* allocate(std::size_t bytes) {
    const bool is_refused = is_memory_gone || (allocations_left >= 0 && allocations_left-- == 0);
    void* const place = is_refused ? nullptr : std::malloc(bytes);
    if (place == nullptr) throw std::bad_alloc();
    const std::size_t now = bytes_now += ::malloc_usable_size(place);
    bytes_most = std::max(bytes_most.load(), now);
    return place;
}

static void release(void* place) noexcept {
    if (place != nullptr) bytes_now -= ::malloc_usable_size(place);
    std::free(place);
}

namespace octoskin {
namespace {

constexpr std::size_t kMib = std::size_t{1} << 20U;

/// Every voxel known and none like its neighbours: nothing can be pruned. `spacing`: of bricks, in bricks.
FusedMap full_map(std::uint32_t mib, unsigned spacing) {
    FusedMap map{MapConfig{.memory_max_mib = mib}};
    constexpr unsigned kEdge = 24;
    for (unsigned brick = 0; map.counters().no_room == 0; ++brick) {
        const auto axis = [&](unsigned place, unsigned voxel) {
            return static_cast<std::uint16_t>(16384 + 8 * spacing * place + voxel);
        };
        std::vector<VoxelUpdate> updates;
        for (unsigned voxel = 0; voxel < 512; ++voxel) {
            const VoxelKey key{axis(brick % kEdge, voxel % 8), axis(brick / kEdge % kEdge, voxel / 8 % 8),
                               axis(brick / kEdge / kEdge, voxel / 64)};
            updates.push_back({key, 0.001F * static_cast<float>(1 + voxel)});
        }
        feed(map, updates);
    }
    return map;
}

TEST(MapMemory, a_save_takes_a_quarter_of_the_maps_own_at_most) {
    constexpr std::uint32_t kMapMib = 16;
    constexpr std::size_t kConstant = kMib;
    for (const unsigned spacing : {1U, 64U}) {
        const testing_support::ScratchFolder folder;
        const FusedMap map = full_map(kMapMib, spacing);
        for (const char* const file : {"map.ot", "map.bt"}) {
            const std::size_t before = bytes_now;
            bytes_most = before;
            ASSERT_TRUE(save_map(map, folder / file));
            EXPECT_LT(bytes_most - before, kMapMib * kMib / 4 + kConstant) << file << ", spacing " << spacing;
            EXPECT_EQ(bytes_now, before);
        }
    }
}

TEST(MapMemory, what_is_counted_is_what_the_voxels_take) {
    const std::size_t before = bytes_now;
    const FusedMap map = full_map(16, 1);
    const auto taken = static_cast<double>(bytes_now - before);
    EXPECT_NEAR(taken, static_cast<double>(map.memory_bytes()), 0.03 * taken);
    EXPECT_EQ(map.heap_bytes(), map.memory_bytes()) << "no two voxels are alike";
}

TEST(MapMemory, a_map_that_gets_none_counts_that_and_goes_on_when_there_is_some) {
    FusedMap map{MapConfig{}};
    const VoxelUpdate old{{100, 100, 100}, 0.5F};
    feed(map, std::span(&old, 1));
    const Evidence evidence = evidence_of(std::vector<VoxelUpdate>{
        {{200, 0, 0}, 0.5F}, {{201, 0, 0}, 0.5F}, {{100, 100, 101}, 0.5F}, {{300, 0, 0}, 0.5F}});
    is_memory_gone = true;
    map.apply(evidence);
    is_memory_gone = false;
    EXPECT_EQ(map.counters(), (MapCounters{.applied = 2, .no_memory = 3}));
    EXPECT_EQ(map.known_voxels(), 2U);
    EXPECT_EQ(map.bricks().size(), 1U);
    map.apply(evidence);
    EXPECT_EQ(map.counters(), (MapCounters{.applied = 6, .no_memory = 3}));
    EXPECT_EQ(map.known_voxels(), 5U);
    EXPECT_EQ(map.log_odds({100, 100, 101}), 1.0F);
}

TEST(MapMemory, new_space_that_gets_none_at_any_moment_takes_no_room) {
    int failures = 0;
    for (bool has_failed = true; has_failed; ++failures) {
        FusedMap map{MapConfig{}};
        const VoxelUpdate update{{200, 0, 0}, 0.5F};
        const Evidence evidence = evidence_of(std::span(&update, 1));
        allocations_left = failures;
        map.apply(evidence);
        allocations_left = -1;
        has_failed = map.counters().no_memory > 0;
        EXPECT_EQ(map.memory_bytes() == 0, has_failed) << "after failure " << failures;
        EXPECT_EQ(map.bricks().empty(), has_failed);
    }
    EXPECT_GT(failures, 2) << "places to fail";
}

TEST(MapMemory, an_image_that_gets_none_at_any_moment_leaves_nothing_to_the_next) {
    const CameraIntrinsics camera{.width = 16, .height = 1, .fx = 30.0, .fy = 30.0, .cx = 8.0, .cy = 0.5};
    const auto image = [](float depth_m) {
        DepthImage made{.width = 16, .height = 1, .depth_m = std::vector<float>(16, depth_m)};
        made.depth_m[3] = 0.5F * depth_m;
        return made;
    };
    const Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    const MappingConfig config = paper_mapping();
    const auto expected = DepthIntegrator(config, camera).integrate(image(2.0F), T_map_camera).value().terms;
    int failures = 0;
    for (bool has_failed = true; has_failed; ++failures) {
        DepthIntegrator integrator(config, camera);
        const DepthImage first = image(3.0F);
        has_failed = false;
        allocations_left = failures;
        try {
            (void)integrator.integrate(first, T_map_camera);
        } catch (const std::bad_alloc&) {
            has_failed = true;
        }
        allocations_left = -1;
        const auto next = integrator.integrate(image(2.0F), T_map_camera);
        ASSERT_TRUE(next);
        EXPECT_EQ(next->terms, expected) << "after failure " << failures;
    }
    EXPECT_GT(failures, 5) << "places to fail";
}

TEST(MapMemory, a_tree_that_gets_none_at_any_moment_is_empty_until_the_next_update) {
    const auto cube = [](FusedMap& map, std::uint16_t x, unsigned height, float log_odds) {
        return map.set_cube({.lowest = {x, 32768, 32768}, .height = height}, log_odds);
    };
    // Of what is there: one to be opened, one to go, one to change. And one that is new.
    FusedMap first{MapConfig{}};
    ASSERT_TRUE(cube(first, 32768, 4, 1.0F) && cube(first, 16384, 1, 1.0F));
    FusedMap second = first.copy();
    ASSERT_TRUE(cube(second, 32768, 0, -1.0F) && cube(second, 16386, 0, 1.0F) && cube(second, 8, 0, 1.0F));
    FusedMap third{MapConfig{}};
    ASSERT_TRUE(cube(third, 32776, 0, 1.0F));
    const std::size_t bytes_before = bytes_now;
    int failures = 0;
    for (bool has_failed = true; has_failed; ++failures) {
        OctomapMirror mirror(first.config());
        (void)mirror.update(first);
        has_failed = false;
        allocations_left = failures;
        try {
            (void)mirror.update(second);
            (void)mirror.update(third);
        } catch (const std::bad_alloc&) {
            has_failed = true;
        }
        allocations_left = -1;
        EXPECT_EQ(mirror.tree().size(), has_failed ? 0U : to_octomap(third)->size());
        EXPECT_EQ(mirror.tree().calcNumNodes(), mirror.tree().size());
        (void)mirror.update(second);
        EXPECT_TRUE(mirror.tree() == *to_octomap(second)) << "after failure " << failures;
    }
    EXPECT_GT(failures, 50) << "places to fail";
    EXPECT_EQ(bytes_now, bytes_before) << "all that was taken was given back";
}

TEST(MapMemory, a_copy_takes_none_until_a_brick_is_written) {
    FusedMap map = full_map(4, 1);
    const std::size_t before = bytes_now;
    is_memory_gone = true;
    const FusedMap copy = map.copy();
    is_memory_gone = false;
    EXPECT_EQ(bytes_now, before);
    const VoxelUpdate update{{16384, 16384, 16384}, 0.5F};
    const Evidence evidence = evidence_of(std::span(&update, 1));
    is_memory_gone = true;
    map.apply(evidence);
    is_memory_gone = false;
    EXPECT_EQ(map.counters().no_memory, 1U);
    EXPECT_EQ(map.log_odds(update.key), copy.log_odds(update.key));
    map.apply(evidence);
    EXPECT_EQ(map.log_odds(update.key), copy.log_odds(update.key).value() + 0.5F);
    EXPECT_LT(bytes_now - before, 8 * BrickTree::kNodeBytes + BrickTree::kBrickBytes);
}

TEST(MapMemory, space_of_one_value_takes_next_to_none_and_counts_as_if_it_took_more) {
    FusedMap map{MapConfig{}};
    const std::size_t before = bytes_now;
    ASSERT_TRUE(map.set_cube({.lowest = {32768, 32768, 32768}, .height = 7}, -2.0F));
    EXPECT_LT(bytes_now - before, 128U * 1024);
    EXPECT_EQ(map.heap_bytes(), map.memory_bytes() - 4096 * BrickTree::kBrickBytes);
    EXPECT_EQ(map.known_voxels(), 1U << 21U);
    const VoxelUpdate update{{32768, 32768, 32768}, 0.5F};
    feed(map, std::span(&update, 1));
    EXPECT_EQ(map.log_odds(update.key), -1.5F);
    EXPECT_EQ(map.log_odds({32769, 32768, 32768}), -2.0F);
}

TEST(MapMemory, a_map_that_gets_none_for_other_limits_is_as_it_was) {
    FusedMap map = full_map(4, 1);
    const FusedMap before = map.copy();
    MapConfig config = map.config();
    config.log_odds_max = 0.1F;
    int failures = 0;
    for (bool has_failed = true; has_failed; failures += has_failed ? 1 : 0) {
        has_failed = false;
        allocations_left = 10 * failures;
        try {
            map.limit(config);
        } catch (const std::bad_alloc&) {
            has_failed = true;
        }
        allocations_left = -1;
        std::size_t differences = 0;
        map.for_each_difference(before, [&](const MapBrick&) { ++differences; });
        EXPECT_EQ(differences == 0, has_failed);
        EXPECT_EQ(map.config().log_odds_max == 0.1F, !has_failed);
        EXPECT_EQ(map.known_voxels(), before.known_voxels());
    }
    EXPECT_GT(failures, 20) << "places to fail";
}

TEST(MapMemory, a_map_that_gets_none_to_date_what_it_holds_tries_again) {
    FusedMap map{MapConfig{.age = {.stale_after_s = 1, .unknown_after_s = 2}}};
    ASSERT_TRUE(map.set_cube({.lowest = {32768, 32768, 32768}, .height = 6}, -1.0F));
    constexpr std::int64_t kSecond = 1'000'000'000;
    is_memory_gone = true;
    for (int second = 0; second < 5; ++second) map.advance_time({second * kSecond});
    is_memory_gone = false;
    EXPECT_EQ(map.counters().undated, 5U);
    EXPECT_EQ(map.known_voxels(), 1U << 18U);
    for (int second = 5; second < 9; ++second) map.advance_time({second * kSecond});
    EXPECT_EQ(map.known_voxels(), 0U) << "since the clock began nobody has confirmed it";
}

}  // namespace
}  // namespace octoskin
