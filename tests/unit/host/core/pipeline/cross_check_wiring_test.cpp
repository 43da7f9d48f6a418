// The cross-check gets what goes into the map, and the image as it went in.
#include <gtest/gtest.h>

#include <cmath>

#include "host/core/pipeline/map_builder.hpp"
#include "tests/unit/host/core/pipeline/corner_scene.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

/// The arm turns by 2.3 degrees from image to image; its sensor reports 0.52 m each time, and the camera sees
/// this far. What is compared is so with the next reading.
SensorEvidence after_seven_images(const MappingConfig& mapping, std::uint16_t depth_mm, bool goes_back) {
    HostRig rig = one_joint_rig();
    rig.cameras.front().intrinsics.fx = 10.0;
    rig.cameras.front().intrinsics.fy = 10.0;
    auto builder = MapBuilder::build(rig, one_joint_robot(), mapping, {}, every_feed()).value();
    for (int i = 0; i < 7; ++i) {
        const HostTime now = host_at(1.0 + 0.1 * i);
        EXPECT_TRUE(builder.add({now, {M_PI / 2.0 - 0.04 * i}}));
        EXPECT_TRUE(builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, now, 0.52, 0.02}));
        if (goes_back) {
            builder.clear_motion({});
            EXPECT_TRUE(builder.add({now, {M_PI / 2.0 - 0.04 * i}}));
        }
        EXPECT_TRUE(builder.integrate(flat_frame(1.0 + 0.1 * i, depth_mm)));
    }
    return builder.cross_checks()->of(0).evidence(kLeft, kGood);
}

TEST(VoxelTraceEntry, counts_ranges_that_end_where_the_camera_sees_through_and_names_nobody_for_one_place) {
    const SensorEvidence evidence = after_seven_images(plain_mapping(), 3'000, false);
    EXPECT_EQ(evidence.in_free_space, 6U);
    // They end within 12 cm: a thing may be there that the camera does not show.
    EXPECT_FALSE(evidence.contradicts());
}

TEST(VoxelTraceEntry, has_nothing_to_say_of_readings_of_a_time_that_is_over) {
    EXPECT_EQ(after_seven_images(plain_mapping(), 3'000, true).in_free_space, 0U);
}

TEST(VoxelTraceEntry,
     is_not_there_without_a_camera_where_the_robot_stays_in_the_image_or_nothing_is_reported) {
    HostRig rig = one_joint_rig();
    MappingConfig mapping = plain_mapping();
    mapping.removes_robot_from_depth = false;
    EXPECT_EQ(MapBuilder::build(rig, one_joint_robot(), mapping, {}, every_feed()).value().cross_checks(),
              nullptr);
    MappingConfig silent = plain_mapping();
    silent.reports_contradicting_sensors = false;
    EXPECT_EQ(MapBuilder::build(rig, one_joint_robot(), silent, {}, every_feed()).value().cross_checks(),
              nullptr);
    rig.cameras.clear();
    EXPECT_EQ(
        MapBuilder::build(rig, one_joint_robot(), plain_mapping(), {}, every_feed()).value().cross_checks(),
        nullptr);
}

// The camera looks at the arm, which points at the camera, and its sensor with it: half a metre before the
// arm there is nothing, for the camera sees the arm behind that. In the map the arm's pixels are none.
TEST(VoxelTraceEntry, sees_through_in_front_of_the_robot) {
    HostRig rig = one_joint_rig();
    rig.cameras.front().intrinsics = {
        .width = 20, .height = 20, .fx = 40.0, .fy = 40.0, .cx = 10.0, .cy = 10.0};
    rig.cameras.front().T_link_camera.translation().z() = 0.0;
    auto builder = MapBuilder::build(rig, one_joint_robot(), plain_mapping(), {}, every_feed()).value();
    const HostTime now = host_at(1.0);
    ASSERT_TRUE(builder.add({now, {0.0}}));
    ASSERT_TRUE(builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, now, 0.5, 0.02}));
    ASSERT_TRUE(builder.integrate(DepthFrame{now, 20, 20, std::vector<std::uint16_t>(400, 1'840)}));
    EXPECT_GT(builder.depth_stage(0).robot_pixels(), 10U);
    ASSERT_TRUE(builder.add({host_at(1.01), {0.0}}));
    ASSERT_TRUE(builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, host_at(1.01), 0.5, 0.02}));
    EXPECT_EQ(builder.cross_checks()->of(0).evidence(kLeft, kGood).in_free_space, 1U);
}

/// A builder, and what it is given in the corner.
struct Corner {
    explicit Corner(bool refuses)
        : builder(
              MapBuilder::build(rig, one_joint_robot(), mapping_that(refuses), {}, every_feed()).value()) {}
    static MappingConfig mapping_that(bool refuses) {
        MappingConfig mapping = plain_mapping();
        mapping.refuses_contradicting_sensors = refuses;
        mapping.map.resolution_m = 0.2;  // the cross-check does not use the map
        return mapping;
    }
    [[nodiscard]] const SensorEvidence& evidence() const {
        return builder.cross_checks()->of(0).evidence(kLeft, kGood);
    }

    HostRig rig = in_corner(one_joint_rig());
    MapBuilder builder;
    CornerLooks looks{builder, rig};
};

TEST(VoxelTraceEntry, keeps_a_sensor_that_contradicts_out_of_the_map_until_it_agrees_again) {
    Corner corner(true);
    EXPECT_GT(corner.looks.look_until(0.3, true), 10);
    EXPECT_TRUE(corner.evidence().contradicts());
    EXPECT_TRUE(corner.builder.is_refused(kLeft, kGood));
    EXPECT_FALSE(corner.builder.is_refused(kLeft, kSpare));
    const auto refused = corner.looks.look(0.3);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error(), ReadingReason::contradicts_camera);
    // A reading that is refused changes nothing: with it and without it the map is the same.
    const auto known = [&] { return corner.builder.map().counters(); };
    const auto before = known();
    EXPECT_FALSE(
        corner.builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, corner.looks.now(), 0.3, 0.02}));
    EXPECT_EQ(known(), before);
    EXPECT_TRUE(
        corner.builder.integrate(RangeMeasurement{{kLeft, kSpare, 0}, corner.looks.now(), 0.3, 0.02}));
    EXPECT_NE(known(), before);
    EXPECT_GT(corner.looks.look_until(0.0, false), 10);
    EXPECT_FALSE(corner.evidence().contradicts());
}

TEST(VoxelTraceEntry, only_names_it_where_the_mapping_says_so_or_the_order_is_given) {
    Corner named(false);
    Corner ordered(true);
    ordered.builder.accept_contradicting();
    for (Corner* corner : {&named, &ordered}) {
        EXPECT_EQ(corner->looks.look_until(0.3, true, 100), 0);
        EXPECT_TRUE(corner->evidence().contradicts());
        EXPECT_FALSE(corner->builder.is_refused(kLeft, kGood));
    }
}

}  // namespace
}  // namespace octoskin::test
