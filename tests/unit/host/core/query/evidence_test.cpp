// The oracle looks at every voxel.
#include "tests/support/evidence.hpp"
#include "host/core/query/evidence.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/core/query/capsule_query.hpp"
#include "host/core/query/robot_query.hpp"
#include "host/core/query/segment_cube.hpp"
#include "tests/unit/host/core/query/two_joint_arm.hpp"

namespace octoskin {
namespace {

HostTime at_second(int second) {
    return {std::int64_t{second} * 1'000'000'000};
}

FusedMap aging_map(std::uint32_t stale_after_s) {
    MapConfig config;
    config.age.stale_after_s = stale_after_s;
    return FusedMap(config);
}

/// The least stamp of the known voxels within reach; 0xFFFF: there is none.
std::uint16_t least_stamp(const FusedMap& map, const PosedCapsule& capsule) {
    const SegmentToCubes segment(capsule.p_a, capsule.p_b);
    std::uint16_t least = 0xFFFF;
    map.for_each_known([&](VoxelKey key, float) {
        if (segment.distance(map.centre_of(key), 0.5 * map.resolution_m()) > capsule.radius_m + 1e-9) return;
        least = std::min(least, map.layers().ages.find(brick_of(key)).at(cell_of(key)));
    });
    return least;
}

TEST(Evidence, is_that_of_the_voxel_that_was_confirmed_the_longest_ago) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-0.6, 0.6);
    for (int round = 0; round < 20; ++round) {
        FusedMap map = aging_map(20);
        for (int second = 0; second < 40; ++second) {
            map.advance_time(at_second(second));
            std::vector<VoxelUpdate> updates;
            for (int i = 0; i < 300; ++i)
                updates.push_back({map.key_of({place(random), place(random), place(random)}).value(), -0.4F});
            feed(map, updates, random() % 2 == 0 ? SensorKind::camera : SensorKind::range);
        }
        const PosedCapsule capsule{{place(random), place(random), place(random)},
                                   {place(random), place(random), place(random)},
                                   0.15 * (place(random) + 0.6)};
        const std::uint16_t expected = least_stamp(map, capsule);
        const auto found = weakest_in(map, capsule);
        ASSERT_EQ(found.has_value(), expected != 0xFFFF);
        if (!found) continue;
        EXPECT_EQ(found->stamp, expected);
        EXPECT_EQ(found->confirmation, map.confirmation(found->voxel));
        EXPECT_EQ(found->is_stale, map.is_stale(found->voxel));
        EXPECT_EQ(weakest_in(map, capsule, found)->voxel, found->voxel);
    }
}

TEST(Evidence, of_space_without_any_is_none) {
    const PosedCapsule capsule{{0, 0, 0}, {0, 0, 0.2}, 0.1};
    FusedMap map = aging_map(20);
    feed(map, std::vector<VoxelUpdate>{{map.key_of({0, 0, 0}).value(), -0.4F}});
    EXPECT_FALSE(weakest_in(map, capsule).has_value()) << "no clock";
    map.advance_time(at_second(0));
    EXPECT_FALSE(weakest_in(map, capsule)->confirmation.has_value()) << "nobody knows how old";
    EXPECT_TRUE(weakest_in(map, capsule)->is_stale);
    EXPECT_FALSE(weakest_in(map, {{5, 0, 0}, {5, 0, 0.2}, 0.1}).has_value()) << "unknown";
    EXPECT_FALSE(weakest_in(map, {{1e5, 0, 0}, {1e5, 0, 0.2}, 0.1}).has_value()) << "outside";
}

TEST(Evidence, makes_a_free_posture_stale_but_an_occupied_one_is_occupied) {
    const TwoJointArm arm;
    const auto query = RobotQuery::build(arm.rig, arm.robot).value();
    FusedMap map = free_about_origin(10);
    confirm_about_origin(map, at_second(0));
    const auto state = [&] { return worst_of(query, map, *query.pose(std::vector{0.0, 0.0}))->state; };
    EXPECT_EQ(state(), PostureState::free);
    map.advance_time(at_second(10));
    EXPECT_EQ(state(), PostureState::stale);
    const auto stale = worst_of(query, map, *query.pose(std::vector{0.0, 0.0})).value();
    EXPECT_TRUE(stale.link && stale.voxel && map.is_stale(*stale.voxel));
    feed(map, std::vector<VoxelUpdate>{{map.key_of({0.4, 0, 0.3}).value(), 3.5F}});
    map.advance_time(at_second(100));
    EXPECT_EQ(state(), PostureState::occupied) << "however old";
}

}  // namespace
}  // namespace octoskin
