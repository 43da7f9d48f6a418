#include "host/core/query/robot_query.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "host/core/query/own_space.hpp"
#include "host/core/query/path_query.hpp"
#include "tests/support/cases.hpp"
#include "tests/unit/host/core/query/two_joint_arm.hpp"

namespace octoskin {
namespace {

RobotQuery query_of(const TwoJointArm& arm, const RobotQueryConfig& config = {}) {
    auto built = RobotQuery::build(arm.rig, arm.robot, config);
    EXPECT_TRUE(built);
    return std::move(built).value();
}

std::string link_name(const TwoJointArm& arm, const std::optional<LinkId>& link) {
    return link ? arm.robot.link_names()[*link] : "none";
}

PostureAnswer worst_at(const RobotQuery& query, const FusedMap& map, const std::array<double, 2>& position) {
    const auto capsules = query.pose(position);
    EXPECT_TRUE(capsules);
    return worst_of(query, map, *capsules).value();
}

TEST(RobotQuery, asks_about_what_a_joint_moves_and_about_nothing_else) {
    const TwoJointArm arm;
    EXPECT_EQ(query_of(arm).capsule_count(), 2U);
    EXPECT_EQ(query_of(arm, {.ignores_unmoved = false}).capsule_count(), 3U);
    EXPECT_EQ(query_of(arm, {.links_ignored = {"upper"}}).capsule_count(), 1U);
}

TEST(RobotQuery, leaves_out_a_column_that_turns_about_itself) {
    TwoJointArm arm;
    arm.rig.body.push_back({"upper", {0, 0, -0.1}, {0, 0, 0}, 0.05});
    EXPECT_EQ(query_of(arm).capsule_count(), 2U);
    EXPECT_EQ(query_of(arm, {.ignores_unmoved = false}).capsule_count(), 4U);
}

TEST(RobotQuery, is_not_built_to_say_free_whatever_there_is) {
    const TwoJointArm arm;
    const auto fault = [&](const RobotQueryConfig& config) {
        return RobotQuery::build(arm.rig, arm.robot, config).error();
    };
    EXPECT_EQ(fault({.links_ignored = {"upper", "hand"}}).error, RobotQueryError::no_body);
    EXPECT_EQ(fault({.links_ignored = {"uper"}}).element, "uper");
    for (const double padding_m : {-0.01, 1.5, std::nan("")})
        EXPECT_EQ(fault({.padding_m = padding_m}).error, RobotQueryError::bad_padding);
}

TEST(RobotQuery, of_a_link_without_a_body_is_never_free) {
    TwoJointArm arm;
    arm.rig.body.erase(arm.rig.body.begin() + 1);  // the upper arm's
    arm.rig.links_without_body = {{"upper", false}};
    const RobotQuery query = query_of(arm);
    EXPECT_EQ(query.links(), std::vector<LinkId>{*arm.robot.find_link("hand")});
    ASSERT_EQ(query.unknown_links().size(), 1U);
    FusedMap map = free_about_origin();
    const PostureAnswer unknown = worst_at(query, map, {0.0, 0.0});
    EXPECT_EQ(unknown.state, PostureState::unknown);
    EXPECT_EQ(link_name(arm, unknown.link), "upper");
    EXPECT_FALSE(unknown.voxel);
    const auto leg =
        octoskin::ask(query, map, Leg(query, map, std::array{0.0, 0.0}, std::array{0.5, 0.0}), {});
    EXPECT_EQ(leg->worst.state, PostureState::unknown);
    mark(map, {0.42, 0.02, 0.30});
    EXPECT_EQ(worst_at(query, map, {0.0, 0.0}).state, PostureState::occupied);
    EXPECT_EQ(link_name(arm, worst_at(query, map, {0.0, 0.0}).link), "hand");
    EXPECT_EQ(worst_at(query, map, {1.0, 0.0}).state, PostureState::unknown) << "past the obstacle";
    const FusedMap nothing{MapConfig{}};
    EXPECT_EQ(link_name(arm, worst_at(query, nothing, {0.0, 0.0}).link), "hand") << "a voxel says more";
    const auto clearance = clearance_of(map, *query.pose(std::array{1.0, 0.0}), 1.0);
    EXPECT_TRUE(clearance->occupied_m) << "an upper bound: of the links that have a body";
}

TEST(RobotQuery, of_a_link_that_the_rig_lists_as_without_a_body_may_be_free) {
    TwoJointArm arm;
    arm.rig.body.erase(arm.rig.body.begin() + 1);
    arm.rig.links_without_body = {{"upper", true}};
    const RobotQuery query = query_of(arm);
    EXPECT_TRUE(query.unknown_links().empty());
    EXPECT_EQ(worst_at(query, free_about_origin(), {0.0, 0.0}).state, PostureState::free);
}

TEST(RobotQuery, of_an_arm_without_any_body_is_unknown_and_not_refused) {
    TwoJointArm arm;
    arm.rig.body.clear();
    arm.rig.links_without_body = {{"hand", false}, {"upper", true}};
    const RobotQuery query = query_of(arm);
    EXPECT_EQ(query.capsule_count(), 0U);
    const FusedMap map = free_about_origin();
    EXPECT_EQ(link_name(arm, worst_at(query, map, {0.0, 0.0}).link), "hand");
    const auto leg =
        octoskin::ask(query, map, Leg(query, map, std::array{0.0, 0.0}, std::array{0.5, 0.0}), {});
    EXPECT_EQ(leg->worst.state, PostureState::unknown);
    EXPECT_FALSE(leg->clearance.occupied_m);
    arm.rig.links_without_body = {{"hand", true}, {"upper", true}};
    EXPECT_EQ(RobotQuery::build(arm.rig, arm.robot).error().error, RobotQueryError::no_body);
    arm.rig.links_without_body = {{"elbow", false}};
    EXPECT_EQ(RobotQuery::build(arm.rig, arm.robot).error().error, RobotQueryError::unknown_link);
}

TEST(RobotQuery, poses_the_body_in_the_map_with_its_padding) {
    TwoJointArm arm;
    arm.rig.T_map_base.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
    const auto capsules = query_of(arm, {.padding_m = 0.01}).pose(std::array{0.5 * M_PI, 0.1});
    ASSERT_TRUE(capsules);
    ASSERT_EQ(capsules->size(), 2U);
    EXPECT_TRUE((*capsules)[0].p_b.isApprox(Eigen::Vector3d(1.0, 2.3, 3.3)));
    EXPECT_TRUE((*capsules)[1].p_a.isApprox(Eigen::Vector3d(1.0, 2.5, 3.3)));
    EXPECT_DOUBLE_EQ((*capsules)[1].radius_m, 0.05);
}

TEST(RobotQuery, refuses_positions_that_the_arm_cannot_take) {
    const TwoJointArm arm;
    const RobotQuery query = query_of(arm);
    EXPECT_EQ(query.pose(std::array{0.0}).error().error, PostureError::wrong_count);
    EXPECT_EQ(query.pose(std::array{std::nan(""), 0.0}).error().error, PostureError::not_finite);
    const auto beyond = query.pose(std::array{0.0, 0.25});
    EXPECT_EQ(beyond.error().error, PostureError::outside_limits);
    EXPECT_EQ(beyond.error().joint, 1U);
}

TEST(RobotQuery, names_the_worst_state_the_link_and_the_voxel) {
    const TwoJointArm arm;
    const RobotQuery query = query_of(arm);
    FusedMap map = free_about_origin();
    EXPECT_EQ(worst_at(query, map, {0.0, 0.0}).state, PostureState::free);
    EXPECT_FALSE(worst_at(query, map, {0.0, 0.0}).link);

    FusedMap holed = without(map, {0.1, -0.01, 0.28}, {0.2, 0.05, 0.33});
    const auto unknown = worst_at(query, holed, {0.0, 0.0});
    EXPECT_EQ(unknown.state, PostureState::unknown);
    EXPECT_EQ(link_name(arm, unknown.link), "upper");

    mark(holed, {0.42, 0.02, 0.30});
    const auto occupied = worst_at(query, holed, {0.0, 0.0});
    EXPECT_EQ(occupied.state, PostureState::occupied);
    EXPECT_EQ(link_name(arm, occupied.link), "hand");
    EXPECT_TRUE(map.centre_of(*occupied.voxel).isApprox(Eigen::Vector3d(0.42, 0.02, 0.30), 1e-6));
    EXPECT_EQ(worst_at(query, holed, {1.5, 0.0}).state, PostureState::free);
}

TEST(RobotQuery, tells_how_far_the_nearest_is_and_from_which_link) {
    const TwoJointArm arm;
    FusedMap map = free_about_origin();
    mark(map, {0.62, 0.02, 0.30});  // its cube begins at x = 0.6, the hand ends at 0.44
    const auto capsules = query_of(arm).pose(std::array{0.0, 0.0});
    const auto near = clearance_of(map, *capsules, 0.5);
    ASSERT_TRUE(near && near->occupied_m && near->not_free_m);
    EXPECT_NEAR(*near->occupied_m, 0.16, 1e-8);
    EXPECT_NEAR(*near->not_free_m, 0.16, 1e-8);
    EXPECT_EQ(link_name(arm, near->occupied_link), "hand");
    EXPECT_FALSE(clearance_of(map, *capsules, 0.15)->occupied_m);

    const Eigen::Vector3d corner = Eigen::Vector3d::Constant(1.0);
    DistanceField field(map.config(), {{-corner, corner}, 0.5});
    (void)field.update(map);
    EXPECT_NEAR(clearance_of(field, *capsules)->occupied_m.value(), 0.16, 1e-8);
}

TEST(PathQuery, meets_what_lies_between_two_free_configurations) {
    const TwoJointArm arm;
    const RobotQuery query = query_of(arm);
    FusedMap map = free_about_origin();
    mark(map, {0.3, 0.3, 0.30});  // at 45 degrees
    const std::array from{0.0, 0.0};
    const std::array to{0.5 * M_PI, 0.0};
    EXPECT_EQ(worst_at(query, map, from).state, PostureState::free);
    EXPECT_EQ(worst_at(query, map, to).state, PostureState::free);
    const Leg leg(query, map, from, to);
    const auto answer = ask(query, map, leg, {.reach_m = 0.3});
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->worst.state, PostureState::occupied);
    EXPECT_EQ(link_name(arm, answer->worst.link), "hand");
    EXPECT_GT(answer->share, 0.3);
    EXPECT_LT(answer->share, 0.5);
    EXPECT_EQ(answer->clearance.occupied_m, 0.0);
    EXPECT_LT(answer->postures, leg.postures()) << "it went on";
}

TEST(PathQuery, tells_the_least_distance_on_a_free_way) {
    const TwoJointArm arm;
    FusedMap map = free_about_origin();
    mark(map, {0.5, 0.5, 0.30});  // from x, y = 0.48; the hand passes at 0.44
    const RobotQuery query = query_of(arm);
    const Leg leg(query, map, std::array{0.0, 0.0}, std::array{0.5 * M_PI, 0.0}, 0.01);
    const auto answer = ask(query, map, leg, {.reach_m = 0.5});
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->worst.state, PostureState::free);
    EXPECT_NEAR(answer->clearance.occupied_m.value(), std::sqrt(2.0) * 0.48 - 0.44 - 0.0021, 2e-4)
        << "less by what the hand moves in half a step";
    EXPECT_EQ(answer->postures, 159U);
}

/// What is further than the nearest so far is not looked for, in a map or in a field.
TEST(PathQuery, tells_the_least_of_what_each_posture_is_from_with_and_without_a_field) {
    const TwoJointArm arm;
    const RobotQuery query = query_of(arm);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> along(-0.9, 0.9);
    std::uniform_real_distribution<double> turn(-3.0, 3.0);
    FusedMap map = free_about_origin();
    const Eigen::Vector3d corner = Eigen::Vector3d::Constant(0.8);
    DistanceField field(map.config(), {{-corner, corner}, 0.5});
    for (unsigned i = 0; i < testing_support::cases(30); ++i) {
        mark(map, {along(random), along(random), along(random)}, i % 3 == 0 ? 1.0F : -1.0F);
        (void)field.update(map);
        const Leg leg(query, map, std::array{turn(random), 0.0}, std::array{turn(random), 0.2});
        const double reach_m = i % 2 == 0 ? 0.3 : 0.5;  // the field tells as far as 0.38
        const auto searched = ask(query, map, leg, {.reach_m = reach_m});
        const auto reported = ask(query, map, leg, {.reach_m = reach_m, .field = &field});
        ASSERT_TRUE(searched && reported);
        PostureClearance least;
        for (std::size_t posture = 0; posture < searched->postures; ++posture) {
            const auto capsules = leg.pose(query, posture);
            for (const PosedCapsule& capsule : *capsules) {
                const auto found = clearance(map, capsule, reach_m);
                const auto take = [](std::optional<double>& nearest_m, const std::optional<double>& found_m) {
                    if (found_m && !(nearest_m && *nearest_m <= *found_m)) nearest_m = found_m;
                };
                take(least.occupied_m, found->occupied_m);
                take(least.not_free_m, found->not_free_m);
            }
        }
        for (const LegAnswer& answer : {*searched, *reported}) {
            ASSERT_EQ(answer.clearance.occupied_m, least.occupied_m) << i;
            ASSERT_EQ(answer.clearance.not_free_m, least.not_free_m) << i;
            EXPECT_EQ(answer.clearance.not_free_link, searched->clearance.not_free_link);
            EXPECT_EQ(answer.clearance.occupied_link, searched->clearance.occupied_link);
        }
    }
}

TEST(PathQuery, goes_in_equal_parts_and_ends_exactly_where_it_was_asked_to) {
    const TwoJointArm arm;
    const RobotQuery query = query_of(arm);
    MapConfig coarse{.resolution_m = 1.0};
    const FusedMap map{coarse};  // half a metre a part: the steps are shorter
    const Leg leg(query, map, std::array{0.1, 0.0}, std::array{0.7, 0.15}, 0.25);
    ASSERT_EQ(leg.postures(), 4U) << "three parts of 0.2, and the end";
    std::array<double, 2> position{};
    leg.position(0, position);
    EXPECT_NEAR(position[0], 0.2, 1e-12);
    EXPECT_NEAR(position[1], 0.025, 1e-12);
    leg.position(2, position);
    EXPECT_NEAR(position[0], 0.6, 1e-12);
    leg.position(3, position);
    EXPECT_EQ(position[0], 0.7);
    EXPECT_EQ(position[1], 0.15);
    EXPECT_EQ(leg.share(3), 1.0);
    EXPECT_EQ(Leg(query, map, std::array{0.0, 0.0}, std::array{0.5, 0.0}, 0.1).postures(), 6U)
        << "rounding made one more";
}

TEST(PathQuery, makes_capsules_larger_between_the_configurations_and_nowhere_else) {
    const TwoJointArm arm;
    const RobotQuery query = query_of(arm, {.padding_m = 0.01});
    const FusedMap map{MapConfig{.resolution_m = 0.04}};
    const Leg leg(query, map, std::array{0.0, 0.0}, std::array{1.0, 0.0});
    // The hand goes 0.4 m, in parts of 0.02 at most: more for what it turns between two looks.
    EXPECT_GE(leg.postures(), 21U);
    EXPECT_LE(leg.postures(), 24U);
    const auto between = leg.pose(query, 0);
    ASSERT_TRUE(between);
    EXPECT_GE((*between)[1].radius_m, 0.05 + 0.2 / static_cast<double>(leg.postures()));
    EXPECT_LE((*between)[1].radius_m, 0.06);
    EXPECT_LT((*between)[0].radius_m, (*between)[1].radius_m) << "the upper arm's end is nearer to the post";
    EXPECT_EQ((*leg.pose(query, leg.postures() - 1))[1].radius_m, 0.05);
    const Leg staying(query, map, std::array{1.0, 0.0}, std::array{1.0, 0.0});
    ASSERT_EQ(staying.postures(), 1U);
    EXPECT_EQ((*staying.pose(query, 0))[1].radius_m, 0.05);
}

/// A hand that slides out of an arm that turns is thrown sideways: its speed changes on the way.
TEST(PathQuery, makes_them_as_much_larger_as_a_hand_that_slides_out_of_a_turning_arm_goes) {
    const TwoJointArm arm;
    const RobotQuery query = query_of(arm);
    const FusedMap map{MapConfig{.resolution_m = 0.3}};
    const std::array from{-2.0, 0.0};
    const std::array to{2.0, 0.2};
    const Leg leg(query, map, from, to, 10.0);
    const auto parts = static_cast<double>(leg.postures() - 1);
    for (int i = 0; i < 1000; ++i) {
        const double share = 0.001 * i;
        const auto on_way = query.pose(std::array{-2.0 + 4.0 * share, 0.2 * share});
        const auto asked = leg.pose(query, static_cast<std::size_t>(share * parts));
        ASSERT_TRUE(on_way && asked);
        const double apart_m = ((*on_way)[1].p_a - (*asked)[1].p_a).norm();
        EXPECT_LE(apart_m, (*asked)[1].radius_m - 0.04 + 1e-12) << share;
        EXPECT_LE((*asked)[1].radius_m, 0.04 + 0.25 * 0.3 + 1e-12);
    }
}

/// The same capsules with that radius.
std::vector<PosedCapsule> with_radius(std::vector<PosedCapsule> capsules, double radius_m) {
    for (PosedCapsule& capsule : capsules) capsule.radius_m = radius_m;
    return capsules;
}

TEST(OwnSpace, is_free_where_the_arm_is_and_where_it_was_unknown_about_it) {
    const TwoJointArm arm;
    const RobotQuery query = query_of(arm);
    FusedMap map = without(free_about_origin(), {-0.1, -0.2, 0.2}, {0.6, 0.2, 0.4});
    mark(map, {0.2, 0.02, 0.3});
    const auto capsules = with_radius(*query.pose(std::array{0.0, 0.0}), 0.05);
    EXPECT_EQ(worst_of(query, map, capsules)->state, PostureState::occupied);
    FusedMap copy = map.copy();
    EXPECT_GT(free_own_space(copy, {capsules, capsules}, 0.04).value(), 0U);
    EXPECT_EQ(worst_of(query, copy, capsules)->state, PostureState::free);
    EXPECT_EQ(copy.occupancy(*copy.key_of({0.2, 0.16, 0.3})), Occupancy::unknown) << "beyond the margin";
    EXPECT_EQ(worst_of(query, map, capsules)->state, PostureState::occupied) << "the map itself was changed";
}

TEST(OwnSpace, of_more_voxels_than_there_may_be_is_not_freed_and_can_be_ended) {
    const RobotQuery query = query_of(TwoJointArm());
    const auto capsules = query.pose(std::array{0.0, 0.0});
    MapConfig fine;
    fine.resolution_m = 0.004;
    FusedMap map{fine};
    EXPECT_FALSE(free_own_space(map, {*capsules, *capsules}, 1.0)) << "two capsules of 2.5 x 2 x 2 m each";
    EXPECT_EQ(map.known_voxels(), 0U);
    int asked = 0;
    EXPECT_FALSE(free_own_space(map, {*capsules, *capsules}, 0.1, [&] { return ++asked > 3; }));
    EXPECT_EQ(asked, 4);
    EXPECT_TRUE(free_own_space(map, {*capsules, *capsules}, 0.1));
}

// A capsule with padding, or about a box, is wider than the link, and an obstacle may be in between.
TEST(OwnSpace, leaves_occupied_what_is_not_certainly_the_arm) {
    FusedMap map = free_about_origin();
    mark(map, {0.2, 0.02, 0.3});
    const RobotQuery query = query_of(TwoJointArm());
    const auto around = query.pose(std::array{0.0, 0.0});
    EXPECT_EQ(free_own_space(map, {*around, with_radius(*around, 0.01)}, 0.1), 0U);
    EXPECT_EQ(worst_of(query, map, *around)->state, PostureState::occupied);
    EXPECT_EQ(free_own_space(map, {*around, {}}, 0.1), 0U);
    EXPECT_EQ(free_own_space(map, {*around, with_radius(*around, 0.05)}, 0.1), 1U);
}

// Of the voxel from the axis to 0.04 m beside it and from 0.02 m below to 0.02 m above, the corners are
// 0.0447 m from the axis: an obstacle may be in one of them.
TEST(OwnSpace, leaves_occupied_a_voxel_that_the_surface_of_the_arm_passes_through) {
    FusedMap map = free_about_origin();
    mark(map, {0.2, 0.02, 0.3});
    const auto capsules = query_of(TwoJointArm()).pose(std::array{0.0, 0.0});
    EXPECT_EQ(free_own_space(map, {*capsules, with_radius(*capsules, 0.044)}, 0.1), 0U);
    EXPECT_EQ(free_own_space(map, {*capsules, with_radius(*capsules, 0.045)}, 0.1), 1U);
}

TEST(OwnSpace, leaves_occupied_what_is_outside_the_arm) {
    FusedMap map = free_about_origin();
    mark(map, {0.2, 0.06, 0.3});  // its centre is 0.06 m from the axis, the arm 0.04 m thick
    const RobotQuery query = query_of(TwoJointArm());
    const auto capsules = query.pose(std::array{0.0, 0.0});
    EXPECT_EQ(free_own_space(map, {*capsules, *capsules}, 0.1), 0U);
    EXPECT_EQ(worst_of(query, map, *capsules)->state, PostureState::occupied);
}

/// A rack, `slide`, that turns an arm of 0.6 m about z: `multiplier` radians a metre.
struct RackArm {
    explicit RackArm(double multiplier) : robot(model(multiplier)) {
        rig.joint_sources = {{.joints = {"slide"}}};
        rig.body = {{"bar", {0, 0, -0.3}, {0, 0, -0.3}, 0.02}, {"arm", {0.2, 0, 0}, {0.6, 0, 0}, 0.02}};
    }
    static RobotModel model(double multiplier) {
        std::array<JointDescription, 2> joints;
        joints[0] = {"slide",   "base",    "bar", JointKind::prismatic, Eigen::Isometry3d::Identity(),
                     {0, 0, 1}, {0.0, 0.1}};
        joints[1] = {"turn",    "base",         "arm", JointKind::revolute, Eigen::Isometry3d::Identity(),
                     {0, 0, 1}, {-100.0, 100.0}};
        joints[1].mimic = JointMimic{"slide", multiplier, 0.0};
        return RobotModel::build("base", joints, std::array<std::string, 1>{"slide"}).value();
    }
    HostRig rig;
    RobotModel robot;
};

// What a joint moves is asked about, however far its follower turns meanwhile.
TEST(RobotQuery, asks_about_a_follower_that_turns_fast) {
    for (const double turns_per_m : {0.1, 10.0, 20.0, 33.3, 100.0, 1000.0}) {
        const RackArm arm(2.0 * M_PI * turns_per_m);
        const auto query = RobotQuery::build(arm.rig, arm.robot, {});
        ASSERT_TRUE(query);
        EXPECT_EQ(query->capsule_count(), 2U) << turns_per_m;
    }
}

TEST(PathQuery, meets_what_a_follower_sweeps_on_a_short_way_of_its_joint) {
    FusedMap map = free_about_origin();
    mark(map, {-0.5, 0.0, 0.0});
    for (const double multiplier : {10.0, 40.0, 209.4395102393195, 418.879020478639}) {
        const RackArm arm(multiplier);
        const RobotQuery query = RobotQuery::build(arm.rig, arm.robot, {}).value();
        // A turn or several; at both ends the arm is away from it.
        const double to = std::min(0.1, 4.0 * M_PI / multiplier);
        const Leg leg(query, map, std::array{0.0}, std::array{to});
        const auto answer = ask(query, map, leg, {});
        ASSERT_TRUE(answer);
        const bool sweeps_it = to * multiplier > M_PI;
        EXPECT_EQ(answer->worst.state, sweeps_it ? PostureState::occupied : PostureState::free) << multiplier;
    }
}

TEST(PathQuery, refuses_a_leg_of_over_half_a_turn_of_a_continuous_joint) {
    std::array<JointDescription, 1> joint;
    joint[0] = {"spin", "base", "arm", JointKind::continuous, Eigen::Isometry3d::Identity(), {0, 0, 1}, {}};
    const auto robot = RobotModel::build("base", joint, std::array<std::string, 1>{"spin"}).value();
    HostRig rig;
    rig.joint_sources = {{.joints = {"spin"}}};
    rig.body = {{"arm", {0.2, 0, 0}, {0.6, 0, 0}, 0.02}};
    const RobotQuery query = RobotQuery::build(rig, robot, {}).value();
    const FusedMap map = free_about_origin();
    const auto ask_from = [&](double from, double to) {
        return ask(query, map, Leg(query, map, std::array{from}, std::array{to}), {});
    };
    EXPECT_TRUE(ask_from(0.0, 3.14));
    EXPECT_TRUE(ask_from(10.0, 13.1));
    for (const auto& [from, to] : {std::pair{2.6, -2.6}, std::pair{0.0, 3.15}, std::pair{-4.0, 0.0}}) {
        const auto refused = ask_from(from, to);
        ASSERT_FALSE(refused) << from << ' ' << to;
        EXPECT_EQ(refused.error().error, PostureError::ambiguous_turn);
    }
}

}  // namespace
}  // namespace octoskin
