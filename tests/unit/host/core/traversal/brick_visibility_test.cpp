#include "host/core/traversal/brick_visibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/host/core/traversal/traversal_scene.hpp"

namespace octoskin {
namespace {

// The depth update 'fast' looks for a ray's end only in bricks of which it says "some": were one passed over,
// a surface would be missing.
TEST(BrickVisibility, says_of_every_cube_in_which_a_ray_ends_that_some_of_it_is_passed) {
    for (const double resolution_m : {0.04, 0.1, 0.3}) {
        const VoxelLattice lattice(resolution_m);
        const PixelRays pixel_rays(kSmallCamera);
        for (unsigned seed = 0; seed < 40; ++seed) {
            property::RandomGeometry random(seed, resolution_m);
            const Eigen::Isometry3d T_map_camera = random.camera_pose();
            ProjectedImage image;
            place_image(random.depth_image(kSmallCamera.width, kSmallCamera.height), pixel_rays, lattice,
                        T_map_camera, seed % 2 == 0 ? 0.0 : 1.5, image);
            const CertainView view(kSmallCamera, lattice, T_map_camera, image);
            RangePyramid reach;
            reach.take(image);
            const BrickVisibility picture(view, reach);
            for (std::size_t i = 0; i < std::size_t{image.width} * image.height; i += 7) {
                if (image.reach_m[i] < 0.0F || image.range_m[i] < 0.0) continue;
                const Eigen::Vector3f end(image.end_x[i], image.end_y[i], image.end_z[i]);
                const MortonCode code = morton_of(*lattice.key_of(end.cast<double>()));
                for (unsigned height = kBrickHeight; height <= 9; ++height) {
                    const VoxelKey lowest = key_of_morton(code >> (3 * height) << (3 * height));
                    const int edge = 1 << height;
                    const Eigen::Vector3d middle = lattice.centre_of(lowest) +
                                                   Eigen::Vector3d::Constant(0.5 * (edge - 1) * resolution_m);
                    ASSERT_EQ(picture.of_cube(view.T_camera_map * middle, edge), CubeCoverage::some)
                        << resolution_m << " m, seed " << seed << ", pixel " << i << ", height " << height;
                }
            }
        }
    }
}

TEST(BrickVisibility, has_each_pixel_whose_ray_passes_a_voxel_in_the_square_of_its_brick) {
    std::size_t decided = 0;
    for (const double resolution_m : {0.04, 0.1, 0.3}) {
        const VoxelLattice lattice(resolution_m);
        const PixelRays pixel_rays(kSmallCamera);
        for (unsigned seed = 0; seed < 12; ++seed) {
            property::RandomGeometry random(seed, resolution_m);
            const Eigen::Isometry3d T_map_camera = random.camera_pose();
            ProjectedImage image;
            place_image(random.depth_image(kSmallCamera.width, kSmallCamera.height), pixel_rays, lattice,
                        T_map_camera, 2.0, image);
            const CertainView view(kSmallCamera, lattice, T_map_camera, image);
            RangePyramid reach;
            reach.take(image);
            const BrickVisibility picture(view, reach);
            for (std::uint32_t i = seed; i < image.pixels(); i += 13) {
                if (image.reach_m[i] < 0.0F) continue;
                const auto ray =
                    plan_ray(lattice, image.origin, {image.end_x[i], image.end_y[i], image.end_z[i]});
                walk_ray_keys(*ray, [&](VoxelKey key) {
                    const Eigen::Vector3d centre = view.T_camera_map * lattice.centre_of(key);
                    const Eigen::Vector3d middle =
                        lattice.centre_of(key_of_morton(brick_of(key))) +
                        Eigen::Vector3d::Constant(0.5 * (kBrickEdge - 1) * resolution_m);
                    const SquareOfPixels square =
                        picture.square_of_voxels(view.T_camera_map * middle, kBrickEdge);
                    if (square.longest_m == nullptr) return;
                    ++decided;
                    const double u = kSmallCamera.fx * centre.x() / centre.z() + kSmallCamera.cx - 0.5;
                    const double v = kSmallCamera.fy * centre.y() / centre.z() + kSmallCamera.cy - 0.5;
                    const auto half_px = static_cast<double>(square.half_px);
                    ASSERT_LE(std::abs(u - i % image.width), half_px) << resolution_m << " m, seed " << seed;
                    ASSERT_LE(std::abs(v - i / image.width), half_px) << resolution_m << " m, seed " << seed;
                    const auto block = [&](double pixel, std::uint32_t size) {
                        return static_cast<std::uint32_t>(std::clamp(pixel - half_px, 0.0, size - 1.0)) /
                               RangePyramid::kBlock;
                    };
                    const std::uint32_t column = block(u, image.width);
                    const std::uint32_t row = block(v, image.height);
                    ASSERT_GE(square.longest_m[std::size_t{row} * reach.columns() + column], image.reach_m[i])
                        << resolution_m << " m, seed " << seed << ", pixel " << i;
                });
            }
        }
    }
    EXPECT_GT(decided, 10'000U);
}

}  // namespace
}  // namespace octoskin
