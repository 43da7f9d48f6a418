#include "host/core/traversal/projected_image.hpp"

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <limits>

#include "tests/support/cases.hpp"
#include "tests/unit/host/core/traversal/traversal_scene.hpp"

namespace octoskin {
namespace {

/// Where OctoMap's computeUpdate lets a ray end.
Eigen::Vector3f octomaps_end(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double range_max_m) {
    const octomap::point3d from(origin.x(), origin.y(), origin.z());
    const octomap::point3d to(end.x(), end.y(), end.z());
    if (range_max_m <= 0.0 || (to - from).norm() <= range_max_m) return end;
    const octomap::point3d clipped = from + (to - from).normalized() * static_cast<float>(range_max_m);
    return {clipped.x(), clipped.y(), clipped.z()};
}

TEST(ProjectedImage, is_bit_for_bit_what_eigen_and_octomap_make_of_each_pixel) {
    const PixelRays pixel_rays(kSmallCamera);
    const VoxelLattice lattice(0.04);
    on_each_instruction_set([&](const std::string& name) {
        for (unsigned seed = 0; seed < testing_support::cases(20); ++seed) {
            property::RandomGeometry random(seed, 0.04);
            const Eigen::Isometry3d T_map_camera = random.camera_pose();
            const Eigen::Isometry3d T_camera_map = T_map_camera.inverse();
            const DepthImage image = random.depth_image(kSmallCamera.width, kSmallCamera.height);
            const double range_max_m = seed % 2 == 0 ? 0.0 : 1.7;
            ProjectedImage placed;
            place_image(image, pixel_rays, lattice, T_map_camera, range_max_m, placed);
            for (std::uint32_t i = 0; i < image.depth_m.size(); ++i) {
                if (std::isnan(image.depth_m[i])) {
                    ASSERT_LT(placed.reach_m[i], 0.0F);
                    continue;
                }
                const RaySlope ray = pixel_rays.at(i % image.width, i / image.width);
                const Eigen::Vector3d p_camera =
                    static_cast<double>(image.depth_m[i]) * Eigen::Vector3d(ray.x, ray.y, 1.0);
                const Eigen::Vector3f measured = (T_map_camera * p_camera).cast<float>();
                const Eigen::Vector3f end = octomaps_end(placed.origin, measured, range_max_m);
                ASSERT_EQ(Eigen::Vector3f(placed.end_x[i], placed.end_y[i], placed.end_z[i]), end)
                    << name << " seed " << seed << " pixel " << i;
                const double depth_m = (T_camera_map * end.cast<double>()).z();
                ASSERT_NEAR(placed.reach_m[i], depth_m, 2e-6);
                ASSERT_EQ(placed.range_m[i], end == measured ? p_camera.norm() : -1.0);
            }
        }
    });
}

TEST(ProjectedImage, counts_every_pixel_once_and_bounds_the_ends) {
    constexpr CameraIntrinsics kRow{.width = 7, .height = 1, .fx = 100.0, .fy = 100.0, .cx = 3.5, .cy = 0.5};
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    constexpr float kFar = std::numeric_limits<float>::infinity();
    const DepthImage image{
        .width = 7, .height = 1, .depth_m = {1.0F, kNone, kFar, -kFar, 0.0F, -1.0F, 5000.0F}};
    on_each_instruction_set([&](const std::string& name) {
        ProjectedImage placed;
        place_image(image, PixelRays(kRow), VoxelLattice(0.04), Eigen::Isometry3d::Identity(), 0.0, placed);
        EXPECT_EQ(placed.counts.used, 1U) << name;
        EXPECT_EQ(placed.counts.no_value, 1U) << name;
        EXPECT_EQ(placed.counts.bad_value, 4U) << name;
        EXPECT_EQ(placed.counts.outside_map, 1U) << name;
        EXPECT_EQ(placed.lowest, Eigen::Vector3f(-0.03F, 0.0F, 0.0F)) << name;
        EXPECT_EQ(placed.highest, Eigen::Vector3f(0.0F, 0.0F, 1.0F)) << name;
    });
}

}  // namespace
}  // namespace octoskin
