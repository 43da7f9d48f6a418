#include "host/core/traversal/voxel_rays.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/bricks/brick_walk.hpp"
#include "tests/unit/host/core/traversal/traversal_scene.hpp"

namespace octoskin {
namespace {

constexpr double kResolution_m = 0.1;

/// What is found of a voxel in double precision, pixel by pixel. What lies within `kUnsure_m` of a decision
/// counts both ways.
struct Truth {
    bool is_passed = false;
    bool is_perhaps_passed = false;
    RayVote least;
    RayVote most;
};

Truth truth_of(VoxelKey key, const CameraIntrinsics& camera, const VoxelLattice& lattice,
               const Eigen::Isometry3d& T_map_camera, const ProjectedImage& image) {
    constexpr double kUnsure_m = 1e-3;
    const Eigen::Vector3d centre_map = lattice.centre_of(key);
    const Eigen::Vector3d centre = T_map_camera.inverse() * centre_map;
    const double half_depth_m = 0.5 * kResolution_m * T_map_camera.linear().col(2).lpNorm<1>();
    Truth truth;
    if (centre.z() < half_depth_m) return truth;
    for (std::uint32_t pixel = 0; pixel < camera.width * camera.height; ++pixel) {
        const double x = (pixel % camera.width + 0.5 - camera.cx) / camera.fx;
        const double y = (pixel / camera.width + 0.5 - camera.cy) / camera.fy;
        // Most rays are further aside than any corner of the voxel: they do not count.
        if (std::abs(centre.z() * x - centre.x()) > kResolution_m) continue;
        if (std::abs(centre.z() * y - centre.y()) > kResolution_m) continue;
        const Eigen::Vector3d at_depth = centre.z() * Eigen::Vector3d(x, y, 1.0);
        const double in_voxel_m =
            0.5 * kResolution_m - (T_map_camera * at_depth - centre_map).lpNorm<Eigen::Infinity>();
        const double aside_m = (at_depth - centre).head<2>().lpNorm<Eigen::Infinity>();
        const double near_m = 0.45 * kResolution_m - aside_m;
        const double passed_m = static_cast<double>(image.passed_m[pixel]) - centre.z();
        truth.is_passed |= near_m > kUnsure_m && in_voxel_m > kUnsure_m && passed_m > kUnsure_m;
        truth.is_perhaps_passed |= in_voxel_m > -kUnsure_m && passed_m > -kUnsure_m;
        const double side_m = 0.5 * kResolution_m - aside_m;
        const double reach_m = static_cast<double>(image.reach_m[pixel]) - centre.z();
        const double end_m = 0.2 * kResolution_m;
        const auto count = [](bool is_so) { return is_so ? 1U : 0U; };
        truth.most.go_on += count(side_m > -kUnsure_m && reach_m > end_m - kUnsure_m);
        truth.least.go_on += count(side_m > kUnsure_m && reach_m > end_m + kUnsure_m);
        truth.most.end +=
            count(side_m > -kUnsure_m && reach_m < end_m + kUnsure_m && reach_m > -half_depth_m - kUnsure_m);
        truth.least.end +=
            count(side_m > kUnsure_m && reach_m < end_m - kUnsure_m && reach_m > -half_depth_m + kUnsure_m);
    }
    return truth;
}

struct Scene {
    Eigen::Isometry3d T_map_camera;
    ProjectedImage image;
};

Scene scene_of(unsigned seed, const VoxelLattice& lattice) {
    property::RandomGeometry random(seed, kResolution_m);
    Scene scene{random.camera_pose(), {}};
    DepthImage image = random.depth_image(kSmallCamera.width, kSmallCamera.height);
    for (float& depth_m : image.depth_m) {
        if (seed % 3 == 0 && random.uniform(0.0, 1.0) < 0.3) depth_m = std::nanf("");
    }
    place_image(image, PixelRays(kSmallCamera), lattice, scene.T_map_camera, seed % 2 == 0 ? 0.0 : 1.5,
                scene.image);
    return scene;
}

/// Calls visit(brick) for some of the bricks about the image's rays.
template <class Visit>
void for_some_bricks(const ProjectedImage& image, const VoxelLattice& lattice, Visit&& visit) {
    const KeyBox box{*lattice.key_of(image.lowest.cast<double>()),
                     *lattice.key_of(image.highest.cast<double>())};
    std::size_t brick_number = 0;
    walk_bricks(
        box, [](const VoxelCube&) { return CubeCoverage::some; },
        [&](MortonCode brick, bool) {
            if (++brick_number % 5 == 0) visit(brick);
        });
}

/// Calls visit(key) for an eight-hundredth of the voxels about the image's rays.
template <class Visit>
void for_some_voxels(const ProjectedImage& image, const VoxelLattice& lattice, Visit&& visit) {
    for_some_bricks(image, lattice, [&](MortonCode brick) {
        for (std::size_t cell = brick / kBrickVoxels % 160; cell < kBrickVoxels; cell += 160)
            visit(key_of_morton(brick + cell));
    });
}

TEST(VoxelRays, say_of_each_voxel_what_all_pixels_that_see_it_say_on_every_instruction_set) {
    const VoxelLattice lattice(kResolution_m);
    std::vector<Scene> scenes;
    std::map<std::pair<unsigned, VoxelKey>, Truth> truths;
    for (unsigned seed = 0; seed < 4; ++seed) {
        scenes.push_back(scene_of(seed, lattice));
        for_some_voxels(scenes[seed].image, lattice, [&](VoxelKey key) {
            truths[{seed, key}] =
                truth_of(key, kSmallCamera, lattice, scenes[seed].T_map_camera, scenes[seed].image);
        });
    }
    on_each_instruction_set([&](const std::string& name) {
        VoxelRays rays;
        std::size_t passed = 0;
        std::size_t unsure = 0;
        std::size_t asked = 0;
        for (unsigned seed = 0; seed < scenes.size(); ++seed) {
            const Scene& scene = scenes[seed];
            const CertainView view(kSmallCamera, lattice, scene.T_map_camera, scene.image);
            RangePyramid reach;
            reach.take(scene.image);
            rays.begin(view, scene.image, reach, lattice);
            for_some_voxels(scene.image, lattice, [&](VoxelKey key) {
                const VoxelRays::Brick brick = rays.brick_at(key_of_morton(brick_of(key)));
                const BrickMask mask = rays.passed(brick, {});
                const std::size_t cell = cell_of(key);
                const bool is_passed = (mask[cell / 64] >> (cell % 64) & 1U) != 0;
                const Truth& truth = truths.at({seed, key});
                ++asked;
                passed += is_passed ? 1U : 0U;
                unsure += truth.is_passed == truth.is_perhaps_passed ? 0U : 1U;
                ASSERT_TRUE(is_passed ? truth.is_perhaps_passed : !truth.is_passed) << name;
                BrickMask asked_for{};
                put_in(asked_for, cell);
                std::array<RayVote, kBrickVoxels> votes;
                votes.fill({77, 77});
                rays.vote_on(brick, asked_for, votes);
                const RayVote vote = votes[cell];
                ASSERT_EQ(votes[(cell + 1) % kBrickVoxels].end, 77U) << "not asked for";
                const double range_m = (lattice.centre_of(key) - scene.T_map_camera.translation()).norm();
                ASSERT_NEAR(rays.range_m(brick, cell), range_m, 1e-5 * range_m);
                ASSERT_GE(vote.go_on, truth.least.go_on) << name;
                ASSERT_LE(vote.go_on, truth.most.go_on) << name;
                ASSERT_GE(vote.end, truth.least.end) << name;
                ASSERT_LE(vote.end, truth.most.end) << name;
            });
        }
        EXPECT_GT(passed, asked / 100) << name;
        EXPECT_LT(unsure, asked / 10) << name;
    });
}

TEST(VoxelRays, give_the_same_bits_on_every_instruction_set) {
    const VoxelLattice lattice(kResolution_m);
    const Scene scene = scene_of(7, lattice);
    const CertainView view(kSmallCamera, lattice, scene.T_map_camera, scene.image);
    RangePyramid reach;
    reach.take(scene.image);
    constexpr BrickMask kAll = [] {
        BrickMask all;
        all.fill(~std::uint64_t{0});
        return all;
    }();
    std::vector<BrickMask> first;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> first_votes;
    on_each_instruction_set([&](const std::string& name) {
        VoxelRays rays;
        rays.begin(view, scene.image, reach, lattice);
        std::vector<BrickMask> masks;
        std::vector<std::pair<std::uint32_t, std::uint32_t>> all_votes;
        for_some_bricks(scene.image, lattice, [&](MortonCode brick) {
            const VoxelRays::Brick place = rays.brick_at(key_of_morton(brick));
            masks.push_back(rays.passed(place, {}));
            std::array<RayVote, kBrickVoxels> votes;
            rays.vote_on(place, kAll, votes);
            for (const RayVote& vote : votes) all_votes.emplace_back(vote.end, vote.go_on);
        });
        if (first.empty()) {
            first = masks;
            first_votes = all_votes;
        }
        EXPECT_EQ(masks, first) << name;
        EXPECT_EQ(all_votes, first_votes) << name;
    });
}

}  // namespace
}  // namespace octoskin
