// The depth stage with `denoised`: what it averages, what it forgets, and what reaches the map.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "host/core/depth/depth_filter.hpp"
#include "host/core/depth/depth_image.hpp"
#include "host/core/pipeline/depth_stage.hpp"
#include "host/core/pipeline/map_builder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

constexpr std::uint32_t kWidth = 16;
/// A pixel in the middle, which shows the robot if it is in the image.
constexpr std::size_t kMiddle = 6 * kWidth + 8;
constexpr std::size_t kCorner = kWidth + 1;

MappingConfig denoised_at(double resolution_m) {
    MappingConfig mapping = denoised_mapping();
    mapping.map.resolution_m = resolution_m;
    return mapping;
}

/// No robot in sight, or a ball of it 1 m before the camera.
RobotPose no_robot() {
    return {};
}
RobotPose ball() {
    return {.T_base_link = {}, .body_base = {{{1.0, 0.0, 0.5}, {1.0, 0.0, 0.5}, 0.1, 0}}};
}

/// A wall, and the ball before it: 2 x 2 pixels at 0.95 m.
DepthFrame with_ball(DepthFrame frame) {
    for (const std::size_t pixel : {kMiddle, kMiddle - 1, kMiddle - kWidth, kMiddle - kWidth - 1})
        frame.depth_mm[pixel] = 950;
    return frame;
}

Eigen::Isometry3d T_map_camera(double x_m) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = x_m;
    return T;
}

/// The stage, and the images that it gives to the cross-check.
class Denoised : public testing::Test {
  protected:
    /// A frame that goes into the map. Returns the denoised depth of the pixel in the middle, which is that
    /// of its end.
    float take(const DepthFrame& frame, const RobotPose& robot = no_robot()) {
        const auto updates = stage_.updates(frame, &robot);
        EXPECT_TRUE(updates.has_value());
        retracted_ = updates ? updates->retracted.size() : 0;
        stage_.keep(frame);
        stage_.swap_images(seen_);
        return stage_.memory()->pixels[kMiddle].end.depth_m;
    }
    float take(std::uint16_t depth_mm, std::optional<Eigen::Isometry3d> T = {}) {
        DepthFrame frame = flat_frame(1.0, depth_mm);
        frame.T_map_camera = T;
        return take(frame);
    }

    DepthStage stage_{one_joint_rig(), denoised_at(0.005), 1, true};
    SeenImages seen_;
    std::size_t retracted_ = 0;  ///< voxels, by the last frame
};

TEST_F(Denoised, averages_what_a_camera_sees_that_stands) {
    EXPECT_NEAR(take(1'497), 1.497F, 1e-6F);
    EXPECT_NEAR(take(1'509), 1.503F, 1e-6F);
    EXPECT_NEAR(take(1'497), 1.501F, 1e-6F);
}

// As with `fast`: the cross-check's limits hold for the noise of a filtered image.
TEST_F(Denoised, gives_the_cross_check_the_filtered_single_image) {
    for (const std::uint16_t depth_mm : std::vector<std::uint16_t>{1'497, 1'509, 1'497}) {
        (void)take(depth_mm);
        DepthImage filtered = to_depth_image(flat_frame(1.0, depth_mm), {0.1, 5.0}).value();
        DepthFilter({.is_enabled = true, .sigma_m = 0.03}).filter(filtered);
        EXPECT_EQ(seen_.everything.depth_m, filtered.depth_m);
        EXPECT_EQ(seen_.world.depth_m, filtered.depth_m);
    }
}

TEST_F(Denoised, does_not_average_from_different_places) {
    (void)take(1'497, T_map_camera(0.0));
    EXPECT_NEAR(take(1'509, T_map_camera(0.001)), 1.509F, 1e-6F);
    EXPECT_EQ(retracted_, 0U) << "what was seen from elsewhere is not taken back";
    EXPECT_NEAR(take(1'497, T_map_camera(0.0)), 1.497F, 1e-6F) << "nor with the one before";
    // And where it stands again, it does.
    EXPECT_NEAR(take(1'509, T_map_camera(0.0)), 1.503F, 1e-6F);
    EXPECT_GT(retracted_, 0U);
}

TEST_F(Denoised, frees_less_from_a_camera_that_moves) {
    const RobotPose robot = no_robot();
    DepthFrame frame = flat_frame(1.0, 1'497);
    EXPECT_EQ(stage_.updates(frame, &robot)->terms.miss, -0.4F);
    frame.T_map_camera = T_map_camera(0.0);
    EXPECT_EQ(stage_.updates(frame, &robot)->terms.miss, -0.2F);
}

TEST_F(Denoised, knows_what_is_behind_the_robot_when_it_has_passed) {
    for (int i = 0; i < 5; ++i) (void)take(1'497);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(take(with_ball(flat_frame(1.0, 1'497)), ball()), 1.497F, 1e-6F);
        EXPECT_TRUE(std::isnan(seen_.world.depth_m[kMiddle]));
        EXPECT_NEAR(seen_.world.depth_m[kCorner], 1.497F, 1e-6F);
        EXPECT_EQ(retracted_, 0U);
    }
    EXPECT_EQ(stage_.robot_pixels(), 12U);
    // The sixth value of these pixels, 1.499 m, and the ninth of those around, 1.4983 m.
    EXPECT_NEAR(take(1'509), 1.4987F, 0.0005F);
}

TEST_F(Denoised, leaves_no_trace_of_a_frame_that_does_not_go_into_the_map) {
    const RobotPose robot = no_robot();
    (void)take(1'497);
    DepthFrame moved = flat_frame(1.0, 1'700);
    moved.T_map_camera = T_map_camera(0.5);
    for (const DepthFrame& frame : {flat_frame(1.0, 1'700), moved})
        ASSERT_TRUE(stage_.updates(frame, &robot).has_value());
    moved.T_map_camera = T_map_camera(1e9);
    EXPECT_EQ(stage_.updates(moved, &robot).error(), DepthReason::outside_map);
    DepthFrame small = flat_frame(1.0, 1'700);
    small.height = 1;
    EXPECT_EQ(stage_.updates(small, &robot).error(), DepthReason::wrong_size);
    EXPECT_NEAR(take(1'509), 1.503F, 1e-6F);
    EXPECT_EQ(stage_.wrong_size().frames, 0U) << "the caller counts it";
}

TEST_F(Denoised, retracts_the_ends_of_the_estimate_before) {
    (void)take(1'497);
    EXPECT_EQ(retracted_, 0U) << "there is none before the first";
    (void)take(1'509);
    EXPECT_EQ(retracted_, 192U) << "each pixel has a voxel of its own";
    (void)take(1'503);
    EXPECT_EQ(retracted_, 0U) << "the mean is the same";
}

TEST(DenoisedMap, has_a_surface_where_the_mean_is_and_not_where_it_was) {
    const HostRig rig = one_joint_rig();
    MappingConfig mapping = denoised_at(0.005);
    mapping.removes_robot_from_depth = false;
    auto builder = MapBuilder::build(rig, one_joint_robot(), mapping, {}, every_feed()).value();
    for (const std::uint16_t depth_mm : std::vector<std::uint16_t>{1'497, 1'509, 1'497, 1'509})
        ASSERT_TRUE(builder.integrate(flat_frame(1.0, depth_mm)));
    // The camera is at x = 2.02 in the map, and looks along -x: 1.503 m is x = 0.517.
    for (const MapFeed feed : {MapFeed::camera, MapFeed::both}) {
        std::size_t occupied = 0;
        const FusedMap& map = builder.map(feed);
        map.for_each_known([&](VoxelKey key, float log_odds) {
            if (map.occupancy_of(log_odds) != Occupancy::occupied) return;
            EXPECT_NEAR(map.centre_of(key).x(), 0.517, 0.003);
            ++occupied;
        });
        EXPECT_EQ(occupied, 192U);
    }
    EXPECT_EQ(builder.map(MapFeed::ranges).known_voxels(), 0U);
}

}  // namespace
}  // namespace octoskin::test
