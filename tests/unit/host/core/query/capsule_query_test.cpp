#include "host/core/query/capsule_query.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

namespace octoskin {
namespace {

constexpr float kFree = -1.0F;
constexpr float kOccupied = 1.0F;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// At 4 cm; the 16 x 16 x 16 voxels about the origin are free, up to 0.32 m along each axis.
FusedMap free_block() {
    FusedMap map(MapConfig{});
    for (std::uint16_t i = 0; i < 8; ++i) {
        const VoxelKey lowest{static_cast<std::uint16_t>(i & 1U ? kOriginKey : kOriginKey - 8),
                              static_cast<std::uint16_t>(i & 2U ? kOriginKey : kOriginKey - 8),
                              static_cast<std::uint16_t>(i & 4U ? kOriginKey : kOriginKey - 8)};
        EXPECT_TRUE(map.set_cube({lowest, kBrickHeight}, kFree));
    }
    return map;
}

/// Of the origin's voxel, the key plus these.
VoxelKey key(int x, int y, int z) {
    return {static_cast<std::uint16_t>(kOriginKey + x), static_cast<std::uint16_t>(kOriginKey + y),
            static_cast<std::uint16_t>(kOriginKey + z)};
}

void set(FusedMap& map, const VoxelKey& key, float log_odds) {
    EXPECT_TRUE(map.set_cube({key, 0}, log_odds));
}

CapsuleAnswer worst(const FusedMap& map, const PosedCapsule& capsule) {
    const auto answer = worst_in(map, capsule);
    EXPECT_TRUE(answer);
    const std::array capsules{capsule};
    EXPECT_EQ(is_free(map, capsules).value(), answer->state == Occupancy::free);
    return *answer;
}

TEST(CapsuleQuery, is_free_where_all_is) {
    const CapsuleAnswer answer = worst(free_block(), {{-0.1, 0.0, 0.0}, {0.1, 0.05, 0.1}, 0.1});
    EXPECT_EQ(answer.state, Occupancy::free);
    EXPECT_FALSE(answer.voxel);
}

TEST(CapsuleQuery, is_unknown_in_a_map_of_nothing) {
    const CapsuleAnswer answer = worst(FusedMap(MapConfig{}), {{0.01, 0.01, 0.01}, {0.02, 0.01, 0.01}, 0.0});
    EXPECT_EQ(answer.state, Occupancy::unknown);
    EXPECT_EQ(answer.voxel, key(0, 0, 0));
    EXPECT_EQ(answer.distance_m, 0.0);
}

TEST(CapsuleQuery, calls_occupied_worse_than_unknown_though_that_is_nearer) {
    FusedMap map = free_block();
    set(map, key(-6, 0, 0), kOccupied);
    // Unknown begins 0.04 m from one end, the occupied voxel's face is 0.1 m from the other.
    const PosedCapsule capsule{{0.28, 0.02, 0.02}, {-0.1, 0.02, 0.02}, 0.11};
    EXPECT_EQ(worst(map, capsule).voxel, key(-6, 0, 0));
    EXPECT_EQ(worst(map, capsule).state, Occupancy::occupied);
    EXPECT_NEAR(worst(map, capsule).distance_m, 0.1, 1e-9);

    const PosedCapsule thinner{capsule.p_a, capsule.p_b, 0.09};
    EXPECT_EQ(worst(map, thinner).state, Occupancy::unknown);
    EXPECT_EQ(worst(map, thinner).voxel, key(8, 0, 0));
    EXPECT_NEAR(worst(map, thinner).distance_m, 0.04, 1e-9);
}

TEST(CapsuleQuery, asks_the_map_what_is_occupied) {
    MapConfig config;
    config.log_odds_occupied = 1.0F;
    FusedMap map(config);
    for (const auto& [log_odds, state] :
         {std::pair(0.99F, Occupancy::free), std::pair(1.0F, Occupancy::occupied)}) {
        ASSERT_TRUE(map.set_cube({key(0, 0, 0), kBrickHeight}, log_odds));
        EXPECT_EQ(worst(map, {{0.1, 0.1, 0.1}, {0.2, 0.1, 0.1}, 0.05}).state, state);
        set(map, key(0, 0, 0), 0.5F);  // from here on a brick of different voxels
        EXPECT_EQ(worst(map, {{0.1, 0.1, 0.1}, {0.2, 0.1, 0.1}, 0.05}).state, state);
    }
}

TEST(CapsuleQuery, touches_a_voxel_at_its_radius_and_not_beyond) {
    FusedMap map = free_block();
    set(map, key(2, 0, 0), kOccupied);  // from 0.08 m on
    for (const double radius_m : {0.0, 1e-12, 0.01, 0.08}) {
        const double x = 0.08 - radius_m;
        EXPECT_EQ(worst(map, {{x, 0.02, 0.02}, {x, 0.03, 0.02}, radius_m}).state, Occupancy::occupied);
        const double short_of = x - 3e-9;
        EXPECT_EQ(worst(map, {{short_of, 0.02, 0.02}, {short_of, 0.03, 0.02}, radius_m}).state,
                  Occupancy::free);
    }
    // Its corner, from a point.
    const Eigen::Vector3d corner(0.08, 0.04, 0.04);
    const Eigen::Vector3d away = 0.05 * Eigen::Vector3d(-2.0, 2.0, 1.0) / 3.0;
    EXPECT_EQ(worst(map, {corner + away, corner + away, 0.05}).voxel, key(2, 0, 0));
    EXPECT_EQ(worst(map, {corner + away, corner + away, 0.05 - 3e-9}).state, Occupancy::free);
}

TEST(CapsuleQuery, names_the_first_in_morton_order_of_those_equally_near) {
    FusedMap map = free_block();
    // Through the middle of a row of voxels: of those beside it each is half a voxel away.
    const PosedCapsule along_x{{-0.08, 0.02, 0.02}, {0.08, 0.02, 0.02}, 0.03};
    // z is the highest of each three bits of a code, then y, then x; and a key's high bits come first.
    for (const auto& [voxel, is_first] :
         {std::pair(key(1, 0, 1), true), std::pair(key(0, 0, 1), true), std::pair(key(0, 1, 0), true),
          std::pair(key(1, 1, 0), false), std::pair(key(1, -1, 0), true), std::pair(key(0, 0, -1), true),
          std::pair(key(0, -1, 0), false), std::pair(key(-1, 1, 0), false),
          std::pair(key(-1, 0, -1), true)}) {
        set(map, voxel, kOccupied);
        EXPECT_EQ(worst(map, along_x).voxel == voxel, is_first)
            << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
        EXPECT_NEAR(worst(map, along_x).distance_m, 0.02, 1e-12);
    }
}

TEST(CapsuleQuery, knows_nothing_outside_the_octree) {
    MapConfig config;
    config.resolution_m = 0.25;
    FusedMap map(config);
    const VoxelKey last{65528, 65528, 65528};
    ASSERT_TRUE(map.set_cube({last, kBrickHeight}, kFree));
    const double bound = 8192.0;
    const Eigen::Vector3d inside = Eigen::Vector3d::Constant(bound - 1.0);
    EXPECT_EQ(worst(map, {inside, inside, 0.9}).state, Occupancy::free);

    // One end is outside, and all that it touches inside is free.
    const CapsuleAnswer leaves = worst(map, {inside, inside + Eigen::Vector3d(3.0, 0.0, 0.0), 0.5});
    EXPECT_EQ(leaves.state, Occupancy::unknown);
    EXPECT_FALSE(leaves.voxel);
    // All of it.
    const Eigen::Vector3d outside = Eigen::Vector3d::Constant(bound + 1.0);
    EXPECT_FALSE(worst(map, {outside, outside, 0.5}).voxel);
    // Its box is in the octree, and the capsule not: nor in a map of nothing.
    EXPECT_FALSE(worst(map, {outside, outside, 1.1}).voxel);
    EXPECT_FALSE(worst(FusedMap(config), {outside, outside, 1.1}).voxel);
    // What is occupied is still found.
    set(map, {65535, 65535, 65535}, kOccupied);
    EXPECT_EQ(worst(map, {outside, outside, 2.0}).state, Occupancy::occupied);
    EXPECT_NEAR(worst(map, {outside, outside, 2.0}).distance_m, std::sqrt(3.0), 1e-9);
}

TEST(CapsuleQuery, of_all_space_has_an_answer) {
    FusedMap map = free_block();
    EXPECT_EQ(worst(map, {{-1e6, 0.0, 0.0}, {1e6, 0.0, 0.0}, 1e6}).state, Occupancy::unknown);
    set(map, key(3, 3, 3), kOccupied);
    const CapsuleAnswer answer = worst(map, {{-1e6, 0.02, 0.02}, {1e6, 0.02, 0.02}, 1e6});
    EXPECT_EQ(answer.voxel, key(3, 3, 3));
    EXPECT_NEAR(answer.distance_m, 0.1 * std::sqrt(2.0), 1e-8);
}

TEST(CapsuleQuery, refuses_what_is_no_capsule) {
    const FusedMap map = free_block();
    const auto fault = [&](const PosedCapsule& capsule) {
        const auto answer = worst_in(map, capsule);
        return answer ? std::nullopt : std::optional(answer.error());
    };
    const double infinite = std::numeric_limits<double>::infinity();
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    EXPECT_EQ(fault({{0.0, kNan, 0.0}, zero, 0.1}), CapsuleFault::not_finite);
    EXPECT_EQ(fault({zero, {0.0, 0.0, -infinite}, 0.1}), CapsuleFault::not_finite);
    EXPECT_EQ(fault({zero, zero, kNan}), CapsuleFault::not_finite);
    EXPECT_EQ(fault({zero, zero, infinite}), CapsuleFault::not_finite);
    EXPECT_EQ(fault({zero, zero, -1e-300}), CapsuleFault::negative_radius);
    EXPECT_EQ(fault({zero, {0.0, -1.01e6, 0.0}, 0.1}), CapsuleFault::too_large);
    EXPECT_EQ(fault({{1e308, 0.0, 0.0}, zero, 0.1}), CapsuleFault::too_large);
    EXPECT_EQ(fault({zero, zero, 1.01e6}), CapsuleFault::too_large);
    EXPECT_EQ(fault({zero, zero, 0.0}), std::nullopt);
}

TEST(CapsuleQuery, answers_several_as_one_by_one) {
    FusedMap map = free_block();
    set(map, key(2, 0, 0), kOccupied);
    const std::vector<PosedCapsule> capsules{{{-0.1, 0.0, 0.0}, {-0.1, 0.1, 0.0}, 0.05},
                                             {{0.3, 0.0, 0.0}, {0.3, 0.1, 0.0}, 0.05},
                                             {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, 0.05}};
    std::vector<CapsuleAnswer> answers(3);
    ASSERT_TRUE(worst_in(map, capsules, answers));
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(answers[i].state, worst(map, capsules[i]).state);
        EXPECT_EQ(answers[i].voxel, worst(map, capsules[i]).voxel);
    }
    EXPECT_EQ(answers[0].state, Occupancy::free);
    EXPECT_EQ(answers[1].state, Occupancy::unknown);
    EXPECT_EQ(answers[2].state, Occupancy::occupied);
    EXPECT_EQ(is_free(map, capsules).value(), false);
    EXPECT_EQ(is_free(map, std::span(capsules).first(1)).value(), true);
    EXPECT_EQ(is_free(map, {}).value(), true);
}

TEST(CapsuleQuery, answers_none_if_one_is_refused) {
    const FusedMap map = free_block();
    const std::vector<PosedCapsule> capsules{{{0.9, 0.0, 0.0}, {0.9, 0.1, 0.0}, 0.05},
                                             {{0.0, 0.0, 0.0}, {0.0, 0.1, 0.0}, -0.05}};
    std::vector<CapsuleAnswer> answers(2);
    const auto refused = worst_in(map, capsules, answers);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().index, 1U);
    EXPECT_EQ(refused.error().fault, CapsuleFault::negative_radius);
    EXPECT_EQ(answers[0].state, Occupancy::free) << "as it was";
    EXPECT_EQ(is_free(map, capsules).error().index, 1U) << "though the first is not free";
}

}  // namespace
}  // namespace octoskin
