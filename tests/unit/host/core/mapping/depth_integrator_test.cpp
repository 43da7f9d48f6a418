#include "host/core/mapping/depth_integrator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr std::uint16_t kZero = 32768;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// `width` pixels in a row that all look along z through nearly the same line.
CameraIntrinsics narrow_camera(std::uint32_t width) {
    return {.width = width, .height = 1, .fx = 1e9, .fy = 1e9, .cx = 0.5 * width, .cy = 0.5};
}

DepthImage image_of(std::vector<float> depth_m) {
    return {.width = static_cast<std::uint32_t>(depth_m.size()), .height = 1, .depth_m = std::move(depth_m)};
}

/// Voxels of 1 m, the camera in the middle of one, looking along the map's z.
MappingConfig coarse(MappingConfig config) {
    config.map.resolution_m = 1.0;
    return config;
}
Eigen::Isometry3d at_half_metres() {
    return Eigen::Isometry3d(Eigen::Translation3d(0.5, 0.5, 0.5));
}

VoxelUpdate update_at(int z, float log_odds) {
    return {{kZero, kZero, static_cast<std::uint16_t>(kZero + z)}, log_odds};
}

std::vector<VoxelUpdate> integrate(const MappingConfig& config, const DepthImage& image) {
    auto result = DepthIntegrator(config, narrow_camera(image.width)).integrate(image, at_half_metres());
    EXPECT_TRUE(result.has_value());
    return result ? updates_of(result->terms) : std::vector<VoxelUpdate>{};
}

TEST(DepthIntegrator, paper_gives_one_miss_per_passed_voxel_however_many_beams_pass) {
    EXPECT_THAT(integrate(coarse(paper_mapping()), image_of({2.0F, 2.0F, 2.0F})),
                ElementsAre(update_at(0, -0.4F), update_at(1, -0.4F), update_at(2, 0.8F)));
}

TEST(DepthIntegrator, paper_lets_a_hit_win_over_beams_that_pass) {
    EXPECT_THAT(
        integrate(coarse(paper_mapping()), image_of({1.0F, 3.0F, 3.0F})),
        ElementsAre(update_at(0, -0.4F), update_at(1, 0.9F), update_at(2, -0.4F), update_at(3, 0.7F)));
}

TEST(DepthIntegrator, paper_takes_the_largest_of_several_hits) {
    EXPECT_THAT(integrate(coarse(paper_mapping()), image_of({2.3F, 1.75F, 2.0F})),
                ElementsAre(update_at(0, -0.4F), update_at(1, -0.4F), update_at(2, 0.825F)));
}

TEST(DepthIntegrator, paper_never_turns_a_hit_of_zero_into_a_miss) {
    MappingConfig config = coarse(paper_mapping());
    config.model.depth.range_min_m = 1.2;
    EXPECT_THAT(integrate(config, image_of({1.1F, 3.0F})),
                ElementsAre(update_at(0, -0.4F), update_at(2, -0.4F), update_at(3, 0.7F)));
}

TEST(DepthIntegrator, robust_gives_the_mean_of_the_beams_terms) {
    // Voxel 1: one hit of 0.9 and two beams that pass. Voxel 3: hits of 0.7 and 0.68.
    EXPECT_THAT(integrate(coarse(robust_mapping()), image_of({1.0F, 3.0F, 3.2F})),
                ElementsAre(update_at(0, -0.4F), update_at(1, (0.9F - 0.8F) / 3.0F), update_at(2, -0.4F),
                            update_at(3, 0.69F)));
}

TEST(DepthIntegrator, robust_counts_a_hit_of_zero_as_a_beam) {
    MappingConfig config = coarse(robust_mapping());
    config.model.depth.range_min_m = 1.2;
    EXPECT_THAT(
        integrate(config, image_of({1.1F, 3.0F})),
        ElementsAre(update_at(0, -0.4F), update_at(1, -0.2F), update_at(2, -0.4F), update_at(3, 0.7F)));
    EXPECT_THAT(integrate(config, image_of({1.1F})), ElementsAre(update_at(0, -0.4F)));
}

TEST(DepthIntegrator, fast_lets_rays_vote_and_takes_the_hit_of_the_voxels_centre) {
    // Voxel 1: one ray ends, two go on. Voxel 3: both end, one of them behind the centre. Voxel 0 is not
    // wholly before the camera.
    EXPECT_THAT(integrate(coarse(fast_mapping()), image_of({1.0F, 3.0F, 3.1F})),
                ElementsAre(update_at(1, (0.9F - 0.8F) / 3.0F), update_at(2, -0.4F), update_at(3, 0.7F)));
    // All go on, and noise has put an end into voxel 2: it is neither marked nor freed.
    EXPECT_THAT(integrate(coarse(fast_mapping()), image_of({2.4F, 3.0F, 3.0F})),
                ElementsAre(update_at(1, -0.4F), update_at(3, 0.7F)));
    // Nearer than any hit is trusted.
    MappingConfig config = coarse(fast_mapping());
    config.model.depth.range_min_m = 1.2;
    EXPECT_THAT(integrate(config, image_of({1.1F, 2.0F})), ElementsAre(update_at(2, 0.8F)));
}

TEST(DepthIntegrator, takes_the_range_along_the_ray_and_not_the_depth_for_the_hit) {
    // One pixel that looks 3 to the side for 4 ahead: depth 2 m is a range of 2.5 m.
    const CameraIntrinsics camera{.width = 1, .height = 1, .fx = 4.0, .fy = 4.0, .cx = -2.5, .cy = 0.5};
    DepthIntegrator integrator(coarse(paper_mapping()), camera);
    const auto result = integrator.integrate(image_of({2.0F}), at_half_metres());
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(updates_of(result->terms).back(), (VoxelUpdate{{kZero + 2, kZero, kZero + 2}, 0.75F}));
}

TEST(DepthIntegrator, places_a_point_on_its_ray_and_not_where_the_lens_shows_it) {
    // A lens with k1 = -0.25 shows the ray (1, 0, 1) at 1 - 0.25 = 0.75, where this pixel is: depth 4 m is 4
    // m to the side, from 0.5 m to 4.5 m; without the lens it would be 3 m.
    CameraIntrinsics camera{.width = 1, .height = 1, .fx = 4.0, .fy = 4.0, .cx = -2.5, .cy = 0.5};
    const auto end_of = [&camera] {
        DepthIntegrator integrator(coarse(paper_mapping()), camera);
        return updates_of(integrator.integrate(image_of({4.0F}), at_half_metres())->terms).back().key;
    };
    EXPECT_EQ(end_of(), (VoxelKey{kZero + 3, kZero, kZero + 4}));
    camera.lens.k1 = -0.25;
    EXPECT_EQ(end_of(), (VoxelKey{kZero + 4, kZero, kZero + 4}));
}

TEST(DepthIntegrator, counts_every_pixel_under_one_name_and_uses_only_the_good_ones) {
    DepthIntegrator integrator(coarse(paper_mapping()), narrow_camera(8));
    const auto result = integrator.integrate(
        image_of({2.0F, kNan, kInfinity, -kInfinity, 0.0F, -1.0F, 1e30F, 40000.0F}), at_half_metres());
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->pixels.used, 1U);
    EXPECT_EQ(result->pixels.no_value, 1U);
    EXPECT_EQ(result->pixels.bad_value, 4U);
    EXPECT_EQ(result->pixels.outside_map, 2U);
    EXPECT_THAT(updates_of(result->terms),
                ElementsAre(update_at(0, -0.4F), update_at(1, -0.4F), update_at(2, 0.8F)));
}

TEST(DepthIntegrator, gives_nothing_for_an_image_without_values) {
    EXPECT_THAT(integrate(coarse(robust_mapping()), image_of({kNan, kNan})), IsEmpty());
}

TEST(DepthIntegrator, names_why_an_image_is_refused) {
    DepthIntegrator integrator(coarse(paper_mapping()), narrow_camera(2));
    EXPECT_EQ(integrator.integrate(image_of({1.0F}), at_half_metres()).error(), DepthRejection::size_differs);
    DepthImage lying = image_of({1.0F, 1.0F});
    lying.depth_m.pop_back();
    EXPECT_EQ(integrator.integrate(lying, at_half_metres()).error(), DepthRejection::size_differs);

    Eigen::Isometry3d broken = at_half_metres();
    broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(integrator.integrate(image_of({1.0F, 1.0F}), broken).error(), DepthRejection::pose_not_finite);
    const Eigen::Isometry3d far(Eigen::Translation3d(0.0, 1e5, 0.0));
    EXPECT_EQ(integrator.integrate(image_of({1.0F, 1.0F}), far).error(), DepthRejection::camera_outside_map);
}

TEST(DepthIntegrator, refuses_a_box_beyond_its_memory_and_works_again_afterwards) {
    MappingConfig config = coarse(paper_mapping());
    config.depth_box_voxels_max = 1024;  // two bricks: 16 deep
    DepthIntegrator integrator(config, narrow_camera(1));
    EXPECT_EQ(integrator.integrate(image_of({20.0F}), at_half_metres()).error(),
              DepthRejection::box_too_large);
    const auto result = integrator.integrate(image_of({1.0F}), at_half_metres());
    ASSERT_TRUE(result.has_value());
    EXPECT_THAT(updates_of(result->terms), ElementsAre(update_at(0, -0.4F), update_at(1, 0.9F)));
}

TEST(DepthIntegrator, forgets_a_frame_before_the_next) {
    DepthIntegrator integrator(coarse(robust_mapping()), narrow_camera(2));
    const auto first = integrator.integrate(image_of({1.0F, 3.0F}), at_half_metres());
    ASSERT_TRUE(first.has_value());
    const auto second = integrator.integrate(image_of({kNan, 2.0F}), at_half_metres());
    ASSERT_TRUE(second.has_value());
    EXPECT_THAT(updates_of(second->terms),
                ElementsAre(update_at(0, -0.4F), update_at(1, -0.4F), update_at(2, 0.8F)));
}

/// Walls, noise and holes, from a camera that has turned. Of 64 columns the rows are shared, too.
TEST(DepthIntegrator, gives_the_same_terms_however_many_threads_work_on_an_image) {
    for (const DepthUpdate update : {DepthUpdate::paper, DepthUpdate::robust, DepthUpdate::fast}) {
        for (const std::uint32_t width : {64U, 50U}) {
            const CameraIntrinsics camera{
                .width = width, .height = 80, .fx = 60.0, .fy = 60.0, .cx = 0.5 * width, .cy = 40.0};
            MappingConfig config = fast_mapping();
            config.depth_update = update;
            DepthIntegrator alone(config, camera);
            std::mt19937 random(width);
            for (int frame = 0; frame < 2; ++frame) {
                const auto up_to = [&](unsigned most) { return static_cast<float>(random() % (most + 1)); };
                DepthImage image{.width = width, .height = 80, .depth_m = {}};
                for (std::uint32_t i = 0; i < width * 80; ++i)
                    image.depth_m.push_back(up_to(9) == 0.0F ? kNan : 1.0F + up_to(2) + 0.001F * up_to(30));
                const Eigen::Isometry3d T_map_camera(
                    Eigen::Translation3d(0.3 * frame, -0.2, 1.0) *
                    Eigen::AngleAxisd(0.4 * frame, Eigen::Vector3d(1, 2, 3).normalized()));
                const auto expected = alone.integrate(image, T_map_camera);
                ASSERT_TRUE(expected.has_value());
                ASSERT_GT(expected->terms.size(), 1000U);
                for (const unsigned threads : {2U, 3U}) {
                    DepthIntegrator together(config, camera, threads);
                    const auto result = together.integrate(image, T_map_camera);
                    ASSERT_TRUE(result.has_value());
                    EXPECT_TRUE(result->terms == expected->terms) << threads << " threads, frame " << frame;
                    EXPECT_EQ(result->pixels.used, expected->pixels.used);
                    EXPECT_EQ(result->pixels.no_value, expected->pixels.no_value);
                }
            }
        }
    }
}

}  // namespace
}  // namespace octoskin
