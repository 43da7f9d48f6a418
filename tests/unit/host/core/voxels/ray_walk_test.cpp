#include "host/core/voxels/ray_walk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/octomap_oracle.hpp"

namespace octoskin {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint16_t kZero = 32768;

std::vector<VoxelKey> walk(const Eigen::Vector3f& origin, const Eigen::Vector3f& end,
                           double resolution = 0.1) {
    std::vector<VoxelKey> keys;
    const auto ray = plan_ray(VoxelLattice(resolution), origin, end);
    EXPECT_TRUE(ray.has_value());
    if (ray) walk_ray_keys(*ray, [&](VoxelKey key) { keys.push_back(key); });
    return keys;
}

TEST(RayWalk, visits_the_origins_voxel_but_not_the_ends) {
    EXPECT_THAT(walk({0.05F, 0.05F, 0.05F}, {0.35F, 0.05F, 0.05F}),
                ElementsAre(VoxelKey{kZero, kZero, kZero}, VoxelKey{kZero + 1, kZero, kZero},
                            VoxelKey{kZero + 2, kZero, kZero}));
}

TEST(RayWalk, walks_backwards_through_the_origin_of_the_map) {
    EXPECT_THAT(walk({0.05F, 0.05F, 0.05F}, {0.05F, -0.25F, 0.05F}),
                ElementsAre(VoxelKey{kZero, kZero, kZero}, VoxelKey{kZero, kZero - 1, kZero},
                            VoxelKey{kZero, kZero - 2, kZero}));
}

TEST(RayWalk, steps_face_by_face_on_a_slanted_ray) {
    // y = 0.02 + 0.3 (x - 0.05): crosses y = 0.1 at x = 0.317.
    EXPECT_THAT(walk({0.05F, 0.02F, 0.05F}, {0.45F, 0.14F, 0.05F}),
                ElementsAre(VoxelKey{kZero, kZero, kZero}, VoxelKey{kZero + 1, kZero, kZero},
                            VoxelKey{kZero + 2, kZero, kZero}, VoxelKey{kZero + 3, kZero, kZero},
                            VoxelKey{kZero + 3, kZero + 1, kZero}));
}

TEST(RayWalk, visits_nothing_if_both_ends_lie_in_one_voxel) {
    EXPECT_THAT(walk({0.01F, 0.01F, 0.01F}, {0.09F, 0.09F, 0.09F}), IsEmpty());
    EXPECT_THAT(walk({0.01F, 0.01F, 0.01F}, {0.01F, 0.01F, 0.01F}), IsEmpty());
}

TEST(RayWalk, ends_at_the_first_voxel_if_the_length_underflows) {
    // The square of 2e-30 is no float: OctoMap would divide by a length of zero and never arrive.
    EXPECT_THAT(walk({-1e-30F, -1e-30F, 0.05F}, {1e-30F, 1e-30F, 0.05F}),
                ElementsAre(VoxelKey{kZero - 1, kZero - 1, kZero}));
}

TEST(RayWalk, refuses_what_is_not_finite_and_what_is_outside) {
    const VoxelLattice lattice(0.1);
    const Eigen::Vector3f inside(0.0F, 0.0F, 0.0F);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
        for (int axis = 0; axis < 3; ++axis) {
            Eigen::Vector3f point = inside;
            point[axis] = bad;
            EXPECT_EQ(plan_ray(lattice, point, inside).error(), RayFault::not_finite);
            EXPECT_EQ(plan_ray(lattice, inside, point).error(), RayFault::not_finite);
        }
    }
    const Eigen::Vector3f outside(0.0F, 3276.9F, 0.0F);
    EXPECT_EQ(plan_ray(lattice, outside, inside).error(), RayFault::outside_map);
    EXPECT_EQ(plan_ray(lattice, inside, outside).error(), RayFault::outside_map);
}

TEST(RayWalk, reaches_the_corners_of_the_octree) {
    const Eigen::Vector3f low(-3276.75F, -3276.75F, -3276.75F);
    const Eigen::Vector3f along_an_edge(3276.75F, -3276.75F, -3276.75F);
    const auto keys = walk(low, along_an_edge);
    EXPECT_EQ(keys.size(), 65'535U);
    EXPECT_EQ(keys.front(), (VoxelKey{0, 0, 0}));
    EXPECT_EQ(keys.back(), (VoxelKey{65534, 0, 0}));
    // OctoMap's own rays end at 100,000 keys: no oracle for the diagonal.
    EXPECT_LE(walk(low, {3276.75F, 3276.75F, 3276.75F}).size(), 3U * 65'535U + 1U);
}

// Oracle: OctoMap's computeRayKeys, on every pair of a lattice of corners, edges, faces and centres.
TEST(RayWalk, equals_octomap_between_all_special_points_of_a_few_voxels) {
    const double resolution = 0.04;
    const octomap::OcTree tree(resolution);
    std::vector<Eigen::Vector3f> points;
    for (const int x : {-3, -2, 0, 1}) {
        for (const int y : {-2, 0, 1, 5}) {
            for (const int z : {-1, 0, 2, 3}) {
                // Half edges: even numbers are faces, odd ones centres.
                points.emplace_back(Eigen::Vector3d(x, y, z).cast<float>() *
                                    static_cast<float>(resolution / 2));
            }
        }
    }
    for (const auto& origin : points) {
        for (const auto& end : points) {
            ASSERT_EQ(walk(origin, end, resolution), oracle::ray_keys(tree, origin, end))
                << origin.transpose() << " -> " << end.transpose();
        }
    }
}

}  // namespace
}  // namespace octoskin
