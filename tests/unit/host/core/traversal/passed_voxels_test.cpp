#include "host/core/traversal/passed_voxels.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <string>

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

/// Voxels by brick, without bricks that have none.
using VoxelSet = std::map<MortonCode, BrickMask>;

void add(VoxelSet& voxels, VoxelKey key) {
    put_in(voxels[brick_of(key)], cell_of(key));
}

BrickMask of_brick(const VoxelSet& voxels, MortonCode brick) {
    const auto found = voxels.find(brick);
    return found == voxels.end() ? BrickMask{} : found->second;
}

DepthImage image_of(const CameraIntrinsics& camera, const Case& a_case, property::RandomGeometry& random) {
    DepthImage image = random.depth_image(camera.width, camera.height);
    for (float& depth_m : image.depth_m) {
        if (random.uniform(0.0, 1.0) < a_case.holes) depth_m = std::numeric_limits<float>::quiet_NaN();
    }
    return image;
}

/// An image, and what each of its rays by itself passes: walked once for all instruction sets, for that takes
/// most of the time.
class Scene {
  public:
    Scene(const CameraIntrinsics& camera, unsigned seed, const Case& a_case)
        : camera_(camera), seed_(seed), lattice_(a_case.resolution_m) {
        property::RandomGeometry random(seed, a_case.resolution_m);
        T_map_camera_ = random.camera_pose();
        T_map_camera_.pretranslate(a_case.moved);
        place_image(image_of(camera, a_case, random), PixelRays(camera), lattice_, T_map_camera_,
                    a_case.range_max_m, placed_);
        for (std::size_t i = 0; i < placed_.pixels(); ++i) {
            if (placed_.reach_m[i] < 0.0F || placed_.range_m[i] < 0.0) continue;
            const Eigen::Vector3f end(placed_.end_x[i], placed_.end_y[i], placed_.end_z[i]);
            add(ends_, *lattice_.key_of(end.cast<double>()));
        }
        walk_all(placed_, lattice_, [&](VoxelKey key) { add(passed_, key); });
        for (auto& [brick, mask] : passed_) {
            const BrickMask ends = of_brick(ends_, brick);
            for (std::size_t word = 0; word < mask.size(); ++word) mask[word] &= ~ends[word];
        }
        std::erase_if(passed_, [](const auto& voxels) { return voxels.second == BrickMask{}; });
    }

    void expect_exact(const std::string& what) const {
        const CertainView view(camera_, lattice_, T_map_camera_, placed_);
        ASSERT_GT(view.depth_max_m, 0.0) << what;
        ASSERT_EQ(found(view), passed_) << what << " seed " << seed_;
    }

  private:
    /// By PassedVoxels, in the bricks around all rays.
    [[nodiscard]] VoxelSet found(const CertainView& view) const {
        RangePyramid reach;
        reach.take(placed_);
        const BrickVisibility picture(view, reach);
        const KeyBox box{*lattice_.key_of(placed_.lowest.cast<double>()),
                         *lattice_.key_of(placed_.highest.cast<double>())};
        PassedVoxels passed;
        passed.begin(view, placed_, picture, reach, lattice_, box);
        const auto moved = [](VoxelKey key, int by) {
            const auto along = [by](int value) { return static_cast<std::uint16_t>(value + by); };
            return VoxelKey{along(key.x), along(key.y), along(key.z)};
        };
        VoxelSet voxels;
        walk_bricks(
            {moved(box.lowest, -kBrickEdge), moved(box.highest, kBrickEdge)},
            [](const VoxelCube&) { return CubeCoverage::some; },
            [&](MortonCode brick, bool) {
                const BrickMask mask = passed.of(brick, of_brick(ends_, brick));
                if (mask != BrickMask{}) voxels[brick] = mask;
            });
        return voxels;
    }

    CameraIntrinsics camera_;
    unsigned seed_;
    VoxelLattice lattice_;
    Eigen::Isometry3d T_map_camera_ = Eigen::Isometry3d::Identity();
    ProjectedImage placed_;
    VoxelSet ends_;    ///< in which rays end at a surface
    VoxelSet passed_;  ///< by a ray, without `ends_`
};

void expect_exact(const CameraIntrinsics& camera, unsigned seed, const Case& a_case,
                  const std::string& what) {
    Scene(camera, seed, a_case).expect_exact(what);
}

TEST(PassedVoxels, are_what_each_ray_by_itself_would_on_every_instruction_set) {
    for (unsigned seed = 0; seed < testing_support::cases(5); ++seed) {
        const Scene scene(kSmallCamera, seed, {.resolution_m = 0.1});
        on_each_instruction_set([&](const std::string& name) { scene.expect_exact(name); });
    }
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
    for (unsigned seed = 400; seed < 400 + testing_support::cases(3); ++seed) {
        const Scene far_apart(sparse, seed, {.range_max_m = seed % 2 == 0 ? 0.0 : 1.5, .holes = 0.1});
        const Scene close_together(dense, seed, {.range_max_m = 1.5, .holes = 0.02});
        on_each_instruction_set([&](const std::string& name) {
            far_apart.expect_exact(name);
            close_together.expect_exact(name);
        });
    }
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
