#include "host/core/traversal/image_traversal.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/cases.hpp"
#include "tests/unit/host/core/traversal/traversal_scene.hpp"

namespace octoskin {
namespace {

void expect_exact(const CameraIntrinsics& camera, unsigned seed, const Eigen::Vector3d& moved) {
    constexpr double kResolution_m = 0.1;
    property::RandomGeometry random(seed, kResolution_m);
    Eigen::Isometry3d T_map_camera = random.camera_pose();
    T_map_camera.pretranslate(moved);
    DepthImage image = random.depth_image(camera.width, camera.height);
    for (float& depth_m : image.depth_m) {
        if (random.uniform(0.0, 1.0) < 0.1) depth_m = std::numeric_limits<float>::quiet_NaN();
    }
    const VoxelLattice lattice(kResolution_m);
    ProjectedImage placed;
    place_image(image, PixelRays(camera), lattice, T_map_camera, seed % 2 == 0 ? 0.0 : 1.3, placed);
    VisitedGrid grid;
    span(grid, placed, lattice);
    ImageTraversal().mark_passed(placed, lattice, grid);
    ASSERT_EQ(drained(grid), walked(placed, lattice)) << "seed " << seed;
}

TEST(ImageTraversal, marks_what_each_ray_by_itself_would) {
    CameraIntrinsics lens = kSmallCamera;
    lens.lens.k1 = -0.1;
    for (unsigned seed = 0; seed < testing_support::cases(6); ++seed) {
        expect_exact(lens, seed, {0.0, 0.0, 0.0});
        expect_exact(kSmallCamera, seed, {3000.0, -3000.0, 1000.0});
    }
}

}  // namespace
}  // namespace octoskin
