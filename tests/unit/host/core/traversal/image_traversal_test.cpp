#include "host/core/traversal/image_traversal.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/cases.hpp"
#include "tests/unit/host/core/traversal/traversal_scene.hpp"

namespace octoskin {
namespace {

struct Case {
    double resolution_m = 0.04;
    double range_max_m = 0.0;
    double holes = 0.0;                               ///< share of pixels without a value
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();  ///< from where the pose is drawn
};

void expect_exact(const CameraIntrinsics& camera, unsigned seed, const Case& a_case,
                  const std::string& what) {
    property::RandomGeometry random(seed, a_case.resolution_m);
    Eigen::Isometry3d T_map_camera = random.camera_pose();
    T_map_camera.pretranslate(a_case.moved);
    DepthImage image = random.depth_image(camera.width, camera.height);
    for (float& depth_m : image.depth_m) {
        if (random.uniform(0.0, 1.0) < a_case.holes) depth_m = std::numeric_limits<float>::quiet_NaN();
    }
    const VoxelLattice lattice(a_case.resolution_m);
    const PixelRays pixel_rays(camera);
    ProjectedImage placed;
    place_image(image, pixel_rays, lattice, T_map_camera, a_case.range_max_m, placed);
    VisitedGrid grid;
    span(grid, placed, lattice);
    const std::set<VoxelKey> hits = hit_by(placed, lattice);
    const auto ends = [&](MortonCode brick) {
        BrickMask mask{};
        for (std::size_t cell = 0; seed % 2 == 0 && cell < kBrickVoxels; ++cell) {
            if (hits.contains(key_of_morton(brick + cell)))
                mask[cell / 64] |= std::uint64_t{1} << (cell % 64);
        }
        return mask;
    };
    ImageTraversal traversal;
    traversal.mark_passed(placed, pixel_rays, lattice, T_map_camera, ends, grid);
    std::set<VoxelKey> truth = walked(placed, lattice);
    std::set<VoxelKey> marked = drained(grid);
    for (const VoxelKey hit : hits) {  // may be marked or not
        truth.erase(hit);
        marked.erase(hit);
    }
    ASSERT_EQ(marked, truth) << what << " seed " << seed;
}

TEST(ImageTraversal, marks_what_each_ray_by_itself_would_on_every_instruction_set) {
    on_each_instruction_set([](const std::string& name) {
        for (unsigned seed = 0; seed < testing_support::cases(5); ++seed)
            expect_exact(kSmallCamera, seed, {.resolution_m = 0.1}, name);
    });
}

TEST(ImageTraversal, is_exact_with_holes_and_a_maximum_range) {
    for (unsigned seed = 100; seed < 100 + testing_support::cases(4); ++seed) {
        expect_exact(kSmallCamera, seed, {.range_max_m = 1.3}, "range");
        expect_exact(kSmallCamera, seed, {.holes = 0.2}, "holes");
        expect_exact(kSmallCamera, seed, {.resolution_m = 0.2, .holes = 0.9}, "nearly all holes");
        expect_exact(kSmallCamera, seed, {.holes = 1.0}, "nothing");
    }
}

TEST(ImageTraversal, is_exact_where_single_precision_is_coarse) {
    for (unsigned seed = 200; seed < 200 + testing_support::cases(3); ++seed) {
        expect_exact(kSmallCamera, seed, {.resolution_m = 0.1, .moved = {20.0, -35.0, 8.0}}, "far");
        expect_exact(kSmallCamera, seed, {.resolution_m = 0.1, .moved = {3000.0, -3000.0, 1000.0}},
                     "very far");
    }
}

TEST(ImageTraversal, is_exact_for_every_shape_of_image_and_lens) {
    const CameraIntrinsics oblong{.width = 90, .height = 3, .fx = 60.0, .fy = 25.0, .cx = 20.0, .cy = 2.5};
    const CameraIntrinsics single{.width = 1, .height = 1, .fx = 60.0, .fy = 60.0, .cx = 0.5, .cy = 0.5};
    const CameraIntrinsics aside{.width = 33, .height = 41, .fx = 80.0, .fy = 90.0, .cx = -20.0, .cy = 60.0};
    CameraIntrinsics lens = kSmallCamera;
    lens.lens.k1 = -0.1;
    for (unsigned seed = 300; seed < 300 + testing_support::cases(6); ++seed) {
        expect_exact(oblong, seed, {}, "oblong");
        expect_exact(single, seed, {}, "one pixel");
        expect_exact(aside, seed, {}, "the optical axis beside the picture");
        expect_exact(lens, seed, {.resolution_m = 0.1}, "lens");
    }
}

}  // namespace
}  // namespace octoskin
