#include "host/core/traversal/placed_voxels.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "tests/support/cases.hpp"
#include "tests/unit/host/core/traversal/traversal_scene.hpp"

namespace octoskin {
namespace {

struct PlacedTwice {
    ProjectedImage exact;
    ProjectedImage voxels;
};

PlacedTwice placed_twice(const DepthImage& image, const VoxelLattice& lattice,
                         const Eigen::Isometry3d& T_map_camera, double range_max_m,
                         ThreadPool* pool = nullptr) {
    CameraIntrinsics camera = kSmallCamera;
    camera.width = image.width;
    camera.height = image.height;
    const PixelRays pixel_rays(camera);
    PlacedTwice placed;
    place_image(image, pixel_rays, lattice, T_map_camera, range_max_m, placed.exact, pool);
    place_voxels(image, pixel_rays, lattice, T_map_camera, range_max_m, placed.voxels, pool);
    return placed;
}

/// Of rays that end in something, and of which do, all is equal.
void expect_same(const PlacedTwice& placed) {
    const auto& [exact, voxels] = placed;
    ASSERT_EQ(voxels.counts.used, exact.counts.used);
    ASSERT_EQ(voxels.counts.no_value, exact.counts.no_value);
    ASSERT_EQ(voxels.counts.bad_value, exact.counts.bad_value);
    ASSERT_EQ(voxels.counts.outside_map, exact.counts.outside_map);
    // The exact one's own rounding, of coordinates in the map, and that of a few operations.
    const float rounding_m = 1.2e-7F * exact.origin.cwiseAbs().maxCoeff() + 4e-6F;
    for (std::size_t i = 0; i < exact.pixels(); ++i) {
        SCOPED_TRACE(i);
        ASSERT_EQ(voxels.key_z[i], exact.key_z[i]);
        ASSERT_EQ(voxels.reach_m[i] < 0.0F, exact.reach_m[i] < 0.0F);
        if (exact.key_z[i] == ProjectedImage::kNoKey) {
            ASSERT_NEAR(voxels.reach_m[i], exact.reach_m[i], rounding_m);
            ASSERT_NEAR(voxels.passed_m[i], exact.passed_m[i], rounding_m);
            continue;
        }
        ASSERT_EQ(voxels.key_xy[i], exact.key_xy[i]);
        ASSERT_EQ(voxels.reach_m[i], exact.reach_m[i]);
        ASSERT_EQ(voxels.passed_m[i], exact.passed_m[i]);
    }
}

TEST(PlacedVoxels, are_those_of_the_exact_ends_near_faces_and_maximum_near_and_far_from_the_origin) {
    for (unsigned seed = 0; seed < testing_support::cases(20); ++seed) {
        const double resolution_m = seed % 3 == 0 ? 0.01 : 0.04;
        const VoxelLattice lattice(resolution_m);
        property::RandomGeometry random(seed, resolution_m);
        Eigen::Isometry3d T_map_camera = random.camera_pose();
        if (seed % 4 == 3) T_map_camera.translation() += Eigen::Vector3d(-300.0, 20.0, 100.0);
        DepthImage image = random.depth_image(kSmallCamera.width, kSmallCamera.height);
        const double range_max_m = seed % 2 == 0 ? 0.0 : 1.7;
        if (seed % 5 == 0) {  // as far as the maximum, by one rounding more or less
            for (std::uint32_t i = 0; i < image.depth_m.size(); ++i) {
                const RaySlope ray = PixelRays(kSmallCamera).at(i % image.width, i / image.width);
                image.depth_m[i] = static_cast<float>(1.7 / std::hypot(ray.x, ray.y, 1.0));
                if (i % 3 != 0) image.depth_m[i] = std::nextafter(image.depth_m[i], i % 3 == 1 ? 0.0F : 9.0F);
            }
        }
        std::optional<ProjectedImage> first;
        on_each_instruction_set([&](const std::string& name) {
            SCOPED_TRACE(name + ", seed " + std::to_string(seed));
            const PlacedTwice placed = placed_twice(image, lattice, T_map_camera, range_max_m);
            expect_same(placed);
            if (!first) first = placed.voxels;
            const auto is_equal = [&](const auto& values, const auto& others) {
                return std::equal(values.begin(), values.begin() + std::ptrdiff_t(image.depth_m.size()),
                                  others.begin());
            };
            EXPECT_TRUE(is_equal(placed.voxels.reach_m, first->reach_m));
            EXPECT_TRUE(is_equal(placed.voxels.passed_m, first->passed_m));
            EXPECT_EQ(placed.voxels.lowest, first->lowest);
            EXPECT_EQ(placed.voxels.highest, first->highest);
        });
    }
}

TEST(PlacedVoxels, of_rays_that_leave_the_octree_are_left_out_as_the_exact_ones_are) {
    const VoxelLattice lattice(0.01);
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    DepthImage image{kSmallCamera.width, kSmallCamera.height, {}};
    for (std::uint32_t i = 0; i < image.width * image.height; ++i)
        image.depth_m.push_back(i % 7 == 0 ? std::numeric_limits<float>::infinity()
                                           : 0.5F + 0.001F * static_cast<float>(i));
    for (const double edge_m : {326.68, -327.68, 325.0, -326.0}) {
        T_map_camera.translation() = Eigen::Vector3d(0.0, 0.0, edge_m);
        for (const double range_max_m : {0.0, 1.0, 2.0}) {
            SCOPED_TRACE(std::to_string(edge_m) + ", at most " + std::to_string(range_max_m));
            on_each_instruction_set([&](const std::string& name) {
                SCOPED_TRACE(name);
                expect_same(placed_twice(image, lattice, T_map_camera, range_max_m));
            });
        }
    }
}

TEST(PlacedVoxels, are_those_of_images_of_any_size_whoever_places_them) {
    const VoxelLattice lattice(0.04);
    ThreadPool pool(3);
    for (const std::uint32_t width : {1U, 5U, 17U, 63U, 64U, 100U, 128U}) {
        for (const std::uint32_t height : {1U, 33U, 70U}) {
            property::RandomGeometry random(width + height, 0.04);
            const DepthImage image = random.depth_image(width, height);
            const Eigen::Isometry3d T_map_camera = random.camera_pose();
            on_each_instruction_set([&](const std::string& name) {
                SCOPED_TRACE(name + ", " + std::to_string(width) + " x " + std::to_string(height));
                expect_same(placed_twice(image, lattice, T_map_camera, 1.7));
                expect_same(placed_twice(image, lattice, T_map_camera, 1.7, &pool));
            });
        }
    }
}

TEST(PlacedVoxels, are_bounded) {
    property::RandomGeometry random(1, 0.04);
    const VoxelLattice lattice(0.04);
    for (unsigned seed = 0; seed < 20; ++seed) {
        const auto placed = placed_twice(random.depth_image(kSmallCamera.width, kSmallCamera.height), lattice,
                                         random.camera_pose(), seed % 2 == 0 ? 0.0 : 1.7)
                                .voxels;
        const VoxelKey lowest = *lattice.key_of(placed.lowest.cast<double>());
        const VoxelKey highest = *lattice.key_of(placed.highest.cast<double>());
        for (std::size_t i = 0; i < placed.pixels(); ++i) {
            if (placed.key_z[i] == ProjectedImage::kNoKey) continue;
            const auto x = static_cast<std::uint16_t>(placed.key_xy[i]);
            const auto y = static_cast<std::uint16_t>(placed.key_xy[i] >> 16U);
            ASSERT_TRUE(lowest.x <= x && x <= highest.x && lowest.y <= y && y <= highest.y);
            ASSERT_TRUE(lowest.z <= placed.key_z[i] && placed.key_z[i] <= highest.z);
        }
    }
}

}  // namespace
}  // namespace octoskin
