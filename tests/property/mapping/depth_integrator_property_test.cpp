// Oracles: OctoMap's computeUpdate for which voxels are hit and passed, its updateNode for the arithmetic,
// and a plain std::map for the mean over beams.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "host/core/mapping/depth_integrator.hpp"
#include "tests/property/mapping/random_geometry.hpp"
#include "tests/support/evidence.hpp"
#include "tests/support/octomap_oracle.hpp"

namespace octoskin::property {
namespace {

constexpr CameraIntrinsics kCamera{.width = 64, .height = 53, .fx = 45.6, .fy = 45.6, .cx = 32.0, .cy = 26.5};

struct Point {
    Eigen::Vector3f p_map;
    double range_m;
};

/// Every pixel's point in the map frame, and its distance from the camera.
std::vector<Point> points_of(const DepthImage& image, const Eigen::Isometry3d& T_map_camera) {
    std::vector<Point> points;
    for (std::uint32_t i = 0; i < image.width * image.height; ++i) {
        const auto z = static_cast<double>(image.depth_m[i]);
        if (std::isnan(z)) continue;
        const Eigen::Vector3d p_camera =
            z * Eigen::Vector3d((i % image.width + 0.5 - kCamera.cx) / kCamera.fx,
                                (i / image.width + 0.5 - kCamera.cy) / kCamera.fy, 1.0);
        points.push_back({(T_map_camera * p_camera).cast<float>(), p_camera.norm()});
    }
    return points;
}

Eigen::Vector3f origin_of(const Eigen::Isometry3d& T_map_camera) {
    return T_map_camera.translation().cast<float>();
}

struct Sets {
    std::set<VoxelKey> hit;
    std::set<VoxelKey> passed;  ///< and not hit
    friend bool operator==(const Sets&, const Sets&) = default;
};

Sets octomaps_sets(octomap::OcTree& tree, const std::vector<Point>& points, const Eigen::Vector3f& origin) {
    octomap::Pointcloud cloud;
    for (const Point& point : points) cloud.push_back(oracle::point_of(point.p_map));
    octomap::KeySet free;
    octomap::KeySet occupied;
    tree.computeUpdate(cloud, oracle::point_of(origin), free, occupied, -1.0);
    Sets sets;
    for (const auto& key : occupied) sets.hit.insert(oracle::key_of(key));
    for (const auto& key : free) {
        if (occupied.count(key) == 0) sets.passed.insert(oracle::key_of(key));
    }
    return sets;
}

class DepthIntegratorProperty : public testing::TestWithParam<double> {};

TEST_P(DepthIntegratorProperty, hits_and_passes_exactly_octomaps_sets) {
    MappingConfig config = paper_mapping();
    config.map.resolution_m = GetParam();
    config.model.depth = {.offset = 1.0, .slope_per_m = 0.0, .range_min_m = 0.0};
    DepthIntegrator integrator(config, kCamera);
    octomap::OcTree tree(config.map.resolution_m);
    for (unsigned seed = 0; seed < 60; ++seed) {
        RandomGeometry random(seed, config.map.resolution_m);
        const Eigen::Isometry3d T_map_camera = random.camera_pose();
        const DepthImage image = random.depth_image(kCamera.width, kCamera.height);
        const auto result = integrator.integrate(image, T_map_camera);
        ASSERT_TRUE(result.has_value());
        Sets sets;
        for (const VoxelUpdate& update : updates_of(result->terms)) {
            ASSERT_TRUE(update.log_odds == 1.0F || update.log_odds == -0.4F);
            (update.log_odds == 1.0F ? sets.hit : sets.passed).insert(update.key);
        }
        ASSERT_EQ(sets.hit.size() + sets.passed.size(), result->terms.size()) << "a voxel came twice";
        ASSERT_EQ(sets, octomaps_sets(tree, points_of(image, T_map_camera), origin_of(T_map_camera)))
            << "seed " << seed;
    }
}

INSTANTIATE_TEST_SUITE_P(Resolutions, DepthIntegratorProperty, testing::Values(0.04, 0.1, 0.25),
                         [](const auto& which) {
                             return std::to_string(std::lround(which.param * 1000.0)) + "_mm";
                         });

TEST(DepthIntegratorProperty, paper_builds_octomaps_map_bit_for_bit_over_many_frames) {
    const MappingConfig config = paper_mapping();
    DepthIntegrator integrator(config, kCamera);
    FusedMap map(config.map);
    oracle::ClampedTree tree(config.map);
    RandomGeometry random(101, config.map.resolution_m);
    const Eigen::Isometry3d T_map_camera = random.camera_pose();
    for (int frame = 0; frame < 40; ++frame) {
        const DepthImage image = random.depth_image(kCamera.width, kCamera.height);
        const auto result = integrator.integrate(image, T_map_camera);
        ASSERT_TRUE(result.has_value());
        feed(map, result->terms);

        const auto points = points_of(image, T_map_camera);
        std::map<VoxelKey, float> term_of_hit;
        for (const Point& point : points) {
            const float term = point.range_m <= 0.5 ? 0.0F : static_cast<float>(1.0 - 0.1 * point.range_m);
            const VoxelKey key = oracle::key_of(tree.coordToKey(oracle::point_of(point.p_map)));
            const auto [entry, is_new] = term_of_hit.emplace(key, term);
            if (!is_new) entry->second = std::max(entry->second, term);
        }
        for (const VoxelKey key : octomaps_sets(tree, points, origin_of(T_map_camera)).passed) {
            tree.updateNode(oracle::key_of(key), -0.4F);
        }
        for (const auto& [key, term] : term_of_hit) {
            if (term != 0.0F) tree.updateNode(oracle::key_of(key), term);
        }
    }
    EXPECT_GT(map.known_voxels(), 20'000U);
    EXPECT_EQ(oracle::voxels_of(map), oracle::voxels_of(tree)) << "seed 101";
}

TEST(DepthIntegratorProperty, robust_equals_a_plain_mean_over_all_beams_of_the_frame) {
    const MappingConfig config = robust_mapping();
    DepthIntegrator integrator(config, kCamera);
    const octomap::OcTree tree(config.map.resolution_m);
    for (unsigned seed = 200; seed < 230; ++seed) {
        RandomGeometry random(seed, config.map.resolution_m);
        const Eigen::Isometry3d T_map_camera = random.camera_pose();
        const DepthImage image = random.depth_image(kCamera.width, kCamera.height);
        const auto result = integrator.integrate(image, T_map_camera);
        ASSERT_TRUE(result.has_value());

        struct Votes {
            double sum = 0.0;
            int beams = 0;
        };
        std::map<VoxelKey, Votes> votes;
        for (const Point& point : points_of(image, T_map_camera)) {
            for (const VoxelKey key : oracle::ray_keys(tree, origin_of(T_map_camera), point.p_map)) {
                votes[key].sum -= 0.4;
                ++votes[key].beams;
            }
            Votes& hit = votes[oracle::key_of(tree.coordToKey(oracle::point_of(point.p_map)))];
            hit.sum += point.range_m <= 0.5 ? 0.0 : 1.0 - 0.1 * point.range_m;
            ++hit.beams;
        }
        ASSERT_LE(result->terms.size(), votes.size());
        for (const VoxelUpdate& update : updates_of(result->terms)) {
            const Votes expected = votes.at(update.key);
            ASSERT_NEAR(update.log_odds, expected.sum / expected.beams, 1e-6) << "seed " << seed;
            votes.erase(update.key);
        }
        for (const auto& [key, left_out] : votes) ASSERT_NEAR(left_out.sum, 0.0, 1e-6) << "seed " << seed;
    }
}

TEST(DepthIntegratorProperty, fast_frees_only_what_rays_pass_and_marks_only_what_they_hit) {
    for (const double resolution_m : {0.04, 0.1, 0.25}) {
        MappingConfig config = fast_mapping();
        config.map.resolution_m = resolution_m;
        DepthIntegrator integrator(config, kCamera);
        octomap::OcTree tree(resolution_m);
        std::size_t passed = 0;
        std::size_t freed = 0;
        for (unsigned seed = 400; seed < 460; ++seed) {
            RandomGeometry random(seed, resolution_m);
            const Eigen::Isometry3d T_map_camera = random.camera_pose();
            const DepthImage image = random.depth_image(kCamera.width, kCamera.height);
            const auto result = integrator.integrate(image, T_map_camera);
            ASSERT_TRUE(result.has_value());
            const Sets sets = octomaps_sets(tree, points_of(image, T_map_camera), origin_of(T_map_camera));
            for (const VoxelUpdate& update : updates_of(result->terms)) {
                ASSERT_TRUE((update.log_odds < 0.0F ? sets.passed : sets.hit).contains(update.key))
                    << "seed " << seed;
                freed += update.log_odds < 0.0F ? 1U : 0U;
            }
            passed += sets.passed.size();
        }
        // A pixel is larger than a voxel beyond 2 m at 4 cm, and many of these images are noise.
        EXPECT_GT(static_cast<double>(freed), 0.3 * static_cast<double>(passed)) << resolution_m;
        std::printf("%.2f m: %.1f %% of what rays pass\n", resolution_m,
                    100.0 * static_cast<double>(freed) / static_cast<double>(passed));
    }
}

TEST(DepthIntegratorProperty, same_image_and_pose_give_the_same_terms_in_the_same_order) {
    for (const MappingConfig& config : {paper_mapping(), robust_mapping(), fast_mapping()}) {
        DepthIntegrator used(config, kCamera);
        RandomGeometry random(300, config.map.resolution_m);
        for (int frame = 0; frame < 5; ++frame) {
            const Eigen::Isometry3d T_map_camera = random.camera_pose();
            const DepthImage image = random.depth_image(kCamera.width, kCamera.height);
            DepthIntegrator fresh(config, kCamera);
            const auto first = used.integrate(image, T_map_camera);
            const auto second = fresh.integrate(image, T_map_camera);
            ASSERT_TRUE(first.has_value() && second.has_value());
            ASSERT_EQ(first->terms, second->terms);
        }
    }
}

}  // namespace
}  // namespace octoskin::property
