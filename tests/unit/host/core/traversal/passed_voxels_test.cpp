#include "host/core/traversal/passed_voxels.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/bricks/brick_walk.hpp"
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

/// The voxels that PassedVoxels finds in the bricks around all rays.
std::set<VoxelKey> passed_by(const ProjectedImage& image, const CertainView& view,
                             const VoxelLattice& lattice, const std::set<VoxelKey>& hits) {
    RangePyramid reach;
    reach.take(image);
    const BrickVisibility picture(view, reach);
    KeyBox box{*lattice.key_of(image.lowest.cast<double>()), *lattice.key_of(image.highest.cast<double>())};
    PassedVoxels passed;
    passed.begin(view, image, picture, reach, lattice, box);
    const auto moved = [](VoxelKey key, int by) {
        const auto along = [by](int value) { return static_cast<std::uint16_t>(value + by); };
        return VoxelKey{along(key.x), along(key.y), along(key.z)};
    };
    std::set<VoxelKey> voxels;
    walk_bricks(
        {moved(box.lowest, -kBrickEdge), moved(box.highest, kBrickEdge)},
        [](const VoxelCube&) { return CubeCoverage::some; },
        [&](MortonCode brick, bool) {
            BrickMask ends{};
            for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
                if (hits.contains(key_of_morton(brick + cell))) put_in(ends, cell);
            for_each_cell(passed.of(brick, ends),
                          [&](std::size_t cell) { voxels.insert(key_of_morton(brick + cell)); });
        });
    return voxels;
}

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
    ProjectedImage placed;
    place_image(image, PixelRays(camera), lattice, T_map_camera, a_case.range_max_m, placed);
    const CertainView view(camera, lattice, T_map_camera, placed);
    ASSERT_GT(view.depth_max_m, 0.0) << what;
    const std::set<VoxelKey> hits = hit_by(placed, lattice);
    std::set<VoxelKey> truth = walked(placed, lattice);
    for (const VoxelKey hit : hits) truth.erase(hit);
    ASSERT_EQ(passed_by(placed, view, lattice, hits), truth) << what << " seed " << seed;
}

TEST(PassedVoxels, are_what_each_ray_by_itself_would_on_every_instruction_set) {
    on_each_instruction_set([](const std::string& name) {
        for (unsigned seed = 0; seed < testing_support::cases(5); ++seed)
            expect_exact(kSmallCamera, seed, {.resolution_m = 0.1}, name);
    });
}

TEST(PassedVoxels, are_exact_with_holes_and_a_maximum_range) {
    for (unsigned seed = 100; seed < 100 + testing_support::cases(4); ++seed) {
        expect_exact(kSmallCamera, seed, {.range_max_m = 1.3}, "range");
        expect_exact(kSmallCamera, seed, {.holes = 0.2}, "holes");
        expect_exact(kSmallCamera, seed, {.resolution_m = 0.2, .holes = 0.9}, "nearly all holes");
        expect_exact(kSmallCamera, seed, {.holes = 1.0}, "nothing");
    }
}

TEST(PassedVoxels, are_exact_where_single_precision_is_coarse) {
    for (unsigned seed = 200; seed < 200 + testing_support::cases(3); ++seed) {
        expect_exact(kSmallCamera, seed, {.resolution_m = 0.1, .moved = {20.0, -35.0, 8.0}}, "far");
        expect_exact(kSmallCamera, seed, {.resolution_m = 0.1, .moved = {300.0, -900.0, 100.0}}, "very far");
    }
}

TEST(PassedVoxels, are_exact_for_every_shape_of_image) {
    const CameraIntrinsics oblong{.width = 90, .height = 3, .fx = 60.0, .fy = 25.0, .cx = 20.0, .cy = 2.5};
    const CameraIntrinsics single{.width = 1, .height = 1, .fx = 60.0, .fy = 60.0, .cx = 0.5, .cy = 0.5};
    const CameraIntrinsics aside{.width = 33, .height = 41, .fx = 80.0, .fy = 90.0, .cx = -20.0, .cy = 60.0};
    for (unsigned seed = 300; seed < 300 + testing_support::cases(6); ++seed) {
        expect_exact(oblong, seed, {}, "oblong");
        expect_exact(single, seed, {}, "one pixel");
        expect_exact(aside, seed, {}, "the optical axis beside the picture");
    }
}

TEST(PassedVoxels, are_exact_where_voxels_are_smaller_than_pixels) {
    const CameraIntrinsics sparse{.width = 20, .height = 15, .fx = 12.0, .fy = 14.0, .cx = 9.0, .cy = 8.0};
    const CameraIntrinsics dense{
        .width = 120, .height = 100, .fx = 200.0, .fy = 180.0, .cx = 61.0, .cy = 47.0};
    on_each_instruction_set([&](const std::string& name) {
        for (unsigned seed = 400; seed < 400 + testing_support::cases(3); ++seed) {
            expect_exact(sparse, seed, {.range_max_m = seed % 2 == 0 ? 0.0 : 1.5, .holes = 0.1}, name);
            expect_exact(dense, seed, {.range_max_m = 1.5, .holes = 0.02}, name);
        }
    });
}

/// All rays begin on faces, where the order of the first voxels is a matter of rounding.
TEST(PassedVoxels, are_exact_from_a_corner_of_voxels) {
    for (unsigned seed = 500; seed < 500 + testing_support::cases(4); ++seed) {
        for (const double resolution_m : {0.0625, 0.1}) {
            property::RandomGeometry random(seed, resolution_m);
            const Eigen::Vector3d from = random.camera_pose().translation();
            const Eigen::Vector3d corner = resolution_m * (from / resolution_m).array().round().matrix();
            expect_exact(kSmallCamera, seed, {.resolution_m = resolution_m, .moved = corner - from},
                         "corner");
        }
    }
}

}  // namespace
}  // namespace octoskin
