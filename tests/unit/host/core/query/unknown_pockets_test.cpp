#include "host/core/query/unknown_pockets.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "host/core/query/pocket_views.hpp"
#include "tests/unit/host/core/query/two_joint_arm.hpp"

namespace octoskin {
namespace {

const PocketRegion kRegion{.centre = Eigen::Vector3d::Zero(), .radius_m = 1.2, .z_min_m = 0.0};

/// 4 x 4 x 4 voxels at the arm's height ahead, and 2 x 2 x 2 behind it.
FusedMap two_pockets() {
    const FusedMap all = free_about_origin();
    const FusedMap one = without(all, {0.8, -0.08, 0.24}, {0.96, 0.08, 0.4});
    return without(one, {-0.88, -0.04, 0.24}, {-0.8, 0.04, 0.32});
}

TEST(UnknownPockets, are_not_sought_to_the_end_once_nobody_waits) {
    int asked = 0;
    const auto ends_at = [&asked](int count) {
        asked = 0;
        return [&asked, count] { return ++asked >= count; };
    };
    EXPECT_FALSE(UnknownPockets::find(free_about_origin(), kRegion, 1, ends_at(1)));
    EXPECT_EQ(asked, 1);
    // Of the box's voxels, and of the unknown ones once more.
    const FusedMap nothing_known{MapConfig{}};
    EXPECT_TRUE(UnknownPockets::find(nothing_known, kRegion, 1, ends_at(1'000'000)));
    const int in_all = asked;
    EXPECT_GT(in_all, 10);
    for (const int count : {2, in_all / 2, in_all}) {
        EXPECT_FALSE(UnknownPockets::find(nothing_known, kRegion, 1, ends_at(count)));
        EXPECT_EQ(asked, count);
    }
}

TEST(UnknownPockets, are_listed_by_size_with_volume_and_centre) {
    const auto found = UnknownPockets::find(two_pockets(), kRegion, 1);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->pockets().size(), 2U);
    const UnknownPocket& larger = found->pockets()[0];
    EXPECT_EQ(larger.voxels, 64U);
    EXPECT_EQ(larger.border_voxels, 56U);  // all but the 2 x 2 x 2 within
    EXPECT_NEAR(larger.volume_m3, 64 * 6.4e-5, 1e-12);
    EXPECT_TRUE(larger.centre.isApprox(Eigen::Vector3d(0.88, 0.0, 0.32), 1e-9));
    EXPECT_EQ(found->pockets()[1].voxels, 8U);
    EXPECT_EQ(found->unknown_voxels(), 72U);
    const FusedMap map = two_pockets();
    EXPECT_EQ(found->border_of(*map.key_of({0.82, 0.0, 0.32})), 0U);
    EXPECT_EQ(found->border_of(*map.key_of({-0.82, 0.0, 0.3})), 1U);
    EXPECT_EQ(found->border_of(*map.key_of({0.5, 0.0, 0.32})), std::nullopt);
    EXPECT_EQ(found->border_of(*map.key_of({0.86, 0.02, 0.3})), std::nullopt) << "within";
}

TEST(UnknownPockets, end_with_the_region_and_need_free_space_beside_them) {
    EXPECT_EQ(UnknownPockets::find(two_pockets(), {{0, 0, 0}, 0.7, 0.0}, 1)->pockets().size(), 0U);
    EXPECT_EQ(UnknownPockets::find(two_pockets(), {{0, 0, 0}, 1.2, 0.5}, 1)->pockets().size(), 0U);
    EXPECT_EQ(UnknownPockets::find(two_pockets(), kRegion, 9)->pockets().size(), 1U);
    const auto nothing_known = UnknownPockets::find(FusedMap{MapConfig{}}, kRegion, 1);
    EXPECT_EQ(nothing_known->pockets().size(), 0U);
    EXPECT_EQ(nothing_known->unknown_voxels(), nothing_known->region_voxels());
}

TEST(UnknownPockets, know_how_many_voxels_a_ball_has) {
    const auto found = UnknownPockets::find(free_about_origin(), {{0, 0, 0}, 1.0, -1.0}, 1);
    EXPECT_NEAR(static_cast<double>(found->region_voxels()) * 6.4e-5, 4.0 / 3.0 * M_PI, 0.02);
    EXPECT_EQ(found->unknown_voxels(), 0U);
}

TEST(UnknownPockets, refuse_a_region_that_is_none_or_too_large) {
    const FusedMap map{MapConfig{}};
    EXPECT_FALSE(UnknownPockets::find(map, {{0, 0, 0}, 50.0, -50.0}, 1));
    EXPECT_FALSE(UnknownPockets::find(map, {{0, 0, 0}, std::nan(""), 0.0}, 1));
    EXPECT_FALSE(UnknownPockets::find(map, {{std::nan(""), 0, 0}, 1.0, 0.0}, 1));
    EXPECT_FALSE(UnknownPockets::find(map, {{0, 0, 0}, 1.0, 2.0}, 1));
}

TEST(PocketViews, are_searched_for_until_somebody_ends_it) {
    const TwoJointArm arm;
    const FusedMap map = two_pockets();
    const auto pockets = UnknownPockets::find(map, kRegion, 1);
    const auto query = RobotQuery::build(arm.rig, arm.robot);
    int asked = 0;
    const auto views = find_views(arm.rig, *query, map, *pockets, std::array{2.0, 0.0},
                                  {.postures = 1'000'000}, [&] { return ++asked > 3; });
    EXPECT_EQ(asked, 4);
    EXPECT_EQ(views.size(), 2U);
}

TEST(PocketViews, turn_the_sensor_towards_each_pocket_with_free_space_before_it) {
    const TwoJointArm arm;
    const FusedMap map = two_pockets();
    const auto pockets = UnknownPockets::find(map, kRegion, 1);
    const auto query = RobotQuery::build(arm.rig, arm.robot);
    const std::array from{0.5, 0.0};
    const auto views = find_views(arm.rig, *query, map, *pockets, from, {.postures = 2000});
    ASSERT_EQ(views.size(), 2U);
    ASSERT_TRUE(views[0]);
    EXPECT_EQ(views[0]->sensor, "palm");
    EXPECT_LT(std::abs(views[0]->position[0]), 0.12) << "0.08 m to the side at 0.8 m";
    EXPECT_NEAR(views[0]->range_m, 0.82 - 0.43 - views[0]->position[1], 0.03);
    EXPECT_LT(views[0]->joint_change_max, 0.5);
    EXPECT_EQ(views[0]->state, PostureState::free);
    // Behind it, the limits leave out what is within 0.14 rad of straight back: the small pocket is not seen.
    EXPECT_FALSE(views[1]);
}

TEST(PocketViews, are_from_unknown_space_if_there_are_none_from_free_space) {
    const TwoJointArm arm;
    const FusedMap map = without(two_pockets(), {0.1, -0.12, 0.2}, {0.3, 0.12, 0.4});  // in it the upper arm
    const auto pockets = UnknownPockets::find(map, kRegion, 1);
    const auto query = RobotQuery::build(arm.rig, arm.robot);
    const auto views = find_views(arm.rig, *query, map, *pockets, std::array{0.0, 0.0}, {.postures = 500});
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (pockets->pockets()[i].centre.x() < 0.8) continue;
        ASSERT_TRUE(views[i]);
        EXPECT_EQ(views[i]->state, PostureState::unknown);
    }
}

TEST(PocketViews, are_none_through_what_is_occupied_and_from_where_the_arm_may_not_stand) {
    const TwoJointArm arm;
    FusedMap map = two_pockets();
    const auto pockets = UnknownPockets::find(map, kRegion, 1);
    const auto query = RobotQuery::build(arm.rig, arm.robot);
    FusedMap walled = map.copy();
    for (double y = -0.3; y < 0.31; y += 0.04)
        for (double z = 0.1; z < 0.6; z += 0.04) mark(walled, {0.72, y, z});
    EXPECT_FALSE(find_views(arm.rig, *query, walled, *pockets, std::array{0.0, 0.0}, {.postures = 500})[0]);
    FusedMap blocked = map.copy();
    mark(blocked, {0.2, 0.0, 0.3});  // the upper arm touches it wherever the sensor would see the pocket
    EXPECT_FALSE(find_views(arm.rig, *query, blocked, *pockets, std::array{0.0, 0.0}, {.postures = 500})[0]);
}

TEST(PocketViews, are_looked_for_all_along_a_rail) {
    TwoJointArm arm;
    arm.rig.joint_sources = {{.joints = {"rail"}}};
    arm.rig.body = {{"hand", {0, 0, 0}, {0, 0, 0}, 0.04}};
    arm.rig.range_limits.max_m = 0.8;
    HostSensor& eye = arm.rig.nodes[0].sensors[0];
    eye.T_link_sensor = Eigen::Isometry3d::Identity();  // looks up
    eye.T_link_sensor.translation() = Eigen::Vector3d(0, 0, 0.1);
    JointDescription rail;
    rail.name = "rail";
    rail.parent_link = "post";
    rail.child_link = "hand";
    rail.kind = JointKind::prismatic;
    rail.axis = Eigen::Vector3d::UnitX();
    rail.limits = {0.0, 6.0};
    const std::array<std::string, 1> moved{"rail"};
    const RobotModel robot = RobotModel::build("post", std::array{rail}, moved).value();
    FusedMap free{MapConfig{.resolution_m = 0.04}};
    for (unsigned cube = 0; cube < 28; ++cube) {
        const auto key = [](unsigned place) { return static_cast<std::uint16_t>(32736 + 32 * place); };
        ASSERT_TRUE(free.set_cube({{key(cube / 4), key(cube / 2 % 2), key(cube % 2)}, 5}, -1.0F));
    }
    const auto query = RobotQuery::build(arm.rig, robot);
    for (const double x : {0.7, 2.5, 4.5, 5.7}) {
        const FusedMap map = without(free, {x - 0.2, -0.2, 0.6}, {x + 0.2, 0.2, 0.9});
        const auto pockets = UnknownPockets::find(map, {{x, 0, 0.7}, 0.5, -0.5}, 1);
        const auto views = find_views(arm.rig, *query, map, *pockets, std::array{0.0}, {.postures = 200});
        ASSERT_EQ(views.size(), 1U) << x;
        ASSERT_TRUE(views[0]) << x;
        EXPECT_NEAR(views[0]->position[0], x, 0.21);
    }
}

}  // namespace
}  // namespace octoskin
