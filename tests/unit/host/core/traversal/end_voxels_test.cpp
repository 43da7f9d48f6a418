#include "host/core/traversal/end_voxels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/traversal/placed_voxels.hpp"
#include "tests/unit/host/core/traversal/traversal_scene.hpp"

namespace octoskin {
namespace {

constexpr std::size_t kVoxelsMax = std::size_t{1} << 26U;

/// Each brick's voxels in which rays end, ray by ray.
std::map<MortonCode, BrickMask> masks_of(const ProjectedImage& rays) {
    std::map<MortonCode, BrickMask> masks;
    for (std::size_t i = 0; i < rays.pixels(); ++i) {
        if (rays.key_z[i] == ProjectedImage::kNoKey) continue;
        const VoxelKey key{static_cast<std::uint16_t>(rays.key_xy[i]),
                           static_cast<std::uint16_t>(rays.key_xy[i] >> 16U),
                           static_cast<std::uint16_t>(rays.key_z[i])};
        put_in(masks[brick_of(key)], cell_of(key));
    }
    return masks;
}

KeyBox box_of(const ProjectedImage& rays, const VoxelLattice& lattice) {
    return {*lattice.key_of(rays.lowest.cast<double>()), *lattice.key_of(rays.highest.cast<double>())};
}

ProjectedImage placed(std::uint32_t width, std::uint32_t height, const VoxelLattice& lattice,
                      double range_max_m) {
    property::RandomGeometry random(width + height, lattice.resolution_m());
    CameraIntrinsics camera = kSmallCamera;
    camera.width = width;
    camera.height = height;
    ProjectedImage rays;
    const Eigen::Isometry3d T_map_camera = random.camera_pose();
    place_voxels(random.depth_image(width, height), PixelRays(camera), lattice, T_map_camera, range_max_m,
                 rays);
    return rays;
}

TEST(EndVoxels, are_those_of_each_ray_in_images_of_any_size_however_many_parts_they_are_marked_in) {
    const VoxelLattice lattice(0.04);
    std::size_t found = 0;
    for (const std::uint32_t width : {1U, 3U, 17U, 64U, 100U}) {
        for (const std::uint32_t height : {1U, 2U, 40U}) {
            const ProjectedImage rays = placed(width, height, lattice, height == 2 ? 0.0 : 1.7);
            const auto expected = masks_of(rays);
            on_each_instruction_set([&](const std::string& name) {
                SCOPED_TRACE(name + ", " + std::to_string(width) + " x " + std::to_string(height));
                EndVoxels ends;
                for (const std::size_t parts : {1U, 2U, 5U}) {
                    ASSERT_TRUE(ends.begin(box_of(rays, lattice), kVoxelsMax, parts));
                    for (std::size_t part = 0; part < parts; ++part) ends.mark(rays, part);
                    const BrickBox box = BrickBox::of(box_of(rays, lattice));
                    for (int z = box.lowest.at[2]; z <= box.highest.at[2]; ++z) {
                        for (int y = box.lowest.at[1]; y <= box.highest.at[1]; ++y) {
                            for (int x = box.lowest.at[0]; x <= box.highest.at[0]; ++x) {
                                const MortonCode brick = morton_of(BrickPlace{{x, y, z}}.cube().lowest);
                                const auto has = expected.find(brick);
                                ASSERT_EQ(ends.of(brick), has == expected.end() ? BrickMask{} : has->second);
                                found += has == expected.end() ? 0U : 1U;
                            }
                        }
                    }
                }
            });
        }
    }
    EXPECT_GT(found, 1000U);
}

TEST(EndVoxels, are_none_outside_of_the_box_and_forgotten_with_the_next_image) {
    const VoxelLattice lattice(0.04);
    const ProjectedImage rays = placed(64, 40, lattice, 0.0);
    EndVoxels ends;
    ASSERT_TRUE(ends.begin(box_of(rays, lattice), kVoxelsMax, 1));
    ends.mark(rays, 0);
    const BrickBox box = BrickBox::of(box_of(rays, lattice));
    for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
        EXPECT_EQ(ends.of(morton_of(box.lowest.moved(axis, -1).cube().lowest)), BrickMask{});
        EXPECT_EQ(ends.of(morton_of(box.highest.moved(axis, 1).cube().lowest)), BrickMask{});
    }
    ProjectedImage nothing = rays;
    nothing.key_z.assign(nothing.key_z.size(), ProjectedImage::kNoKey);
    ASSERT_TRUE(ends.begin(box_of(rays, lattice), kVoxelsMax, 1));
    ends.mark(nothing, 0);
    for (const auto& [brick, mask] : masks_of(rays)) EXPECT_EQ(ends.of(brick), BrickMask{});
}

TEST(EndVoxels, are_refused_where_the_box_is_too_large) {
    const VoxelLattice lattice(0.04);
    const ProjectedImage rays = placed(17, 2, lattice, 0.0);
    const KeyBox box = box_of(rays, lattice);
    const std::size_t voxels = BrickBox::of(box).bricks() * kBrickVoxels;
    EndVoxels ends;
    EXPECT_FALSE(ends.begin(box, voxels - 1, 1));
    EXPECT_TRUE(ends.begin(box, voxels, 1));
}

}  // namespace
}  // namespace octoskin
