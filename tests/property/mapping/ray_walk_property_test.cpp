// Oracle: OctoMap's computeRayKeys.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "host/core/mapping/ray_model.hpp"
#include "host/core/voxels/ray_updates.hpp"
#include "tests/property/mapping/random_geometry.hpp"
#include "tests/support/instruction_sets.hpp"
#include "tests/support/octomap_oracle.hpp"

namespace octoskin::property {
namespace {

std::vector<VoxelKey> walk(const VoxelLattice& lattice, const Eigen::Vector3f& origin,
                           const Eigen::Vector3f& end) {
    std::vector<VoxelKey> keys;
    const auto ray = plan_ray(lattice, origin, end);
    if (ray) walk_ray_keys(*ray, [&](VoxelKey key) { keys.push_back(key); });
    return keys;
}

/// The same without walking.
std::vector<VoxelKey> list(const VoxelLattice& lattice, const Eigen::Vector3f& origin,
                           const Eigen::Vector3f& end) {
    constexpr float kTerm = -0.4F;
    std::vector<VoxelUpdate> buffer(3, {{1, 2, 3}, 4.0F});
    std::vector<VoxelKey> keys;
    if (const auto ray = plan_ray(lattice, origin, end)) {
        for (const VoxelUpdate& update : list_ray_updates(*ray, kTerm, buffer)) {
            EXPECT_EQ(update.log_odds, kTerm);
            keys.push_back(update.key);
        }
        EXPECT_GT(buffer.size(), keys.size());
    }
    return keys;
}

/// The square of the offset is no float: OctoMap divides by zero and does not come back.
bool underflows(const Eigen::Vector3f& origin, const Eigen::Vector3f& end) {
    return !((end - origin).squaredNorm() > 0.0F);
}

struct RayFamily {
    unsigned seed;
    double resolution_m;
    double reach_m;
    int rays;
};

class RayWalkProperty : public testing::TestWithParam<RayFamily> {};

TEST_P(RayWalkProperty, visits_exactly_octomaps_keys_in_octomaps_order) {
    const RayFamily family = GetParam();
    RandomGeometry random(family.seed, family.resolution_m);
    const VoxelLattice lattice(family.resolution_m);
    const octomap::OcTree tree(family.resolution_m);
    std::size_t visited = 0;
    for (int i = 0; i < family.rays; ++i) {
        const Eigen::Vector3f origin = random.point(family.reach_m);
        const Eigen::Vector3f end = random.end_from(origin, family.reach_m);
        if (underflows(origin, end)) continue;
        const auto expected = oracle::ray_keys(tree, origin, end);
        ASSERT_EQ(walk(lattice, origin, end), expected) << "seed " << family.seed << ", ray " << i << ": "
                                                        << origin.transpose() << " -> " << end.transpose();
        visited += expected.size();
    }
    EXPECT_GT(visited, static_cast<std::size_t>(family.rays));
}

// Oracle: the walk, which is held against OctoMap above.
TEST_P(RayWalkProperty, lists_the_keys_of_the_walk_on_each_instruction_set) {
    const RayFamily family = GetParam();
    const VoxelLattice lattice(family.resolution_m);
    on_each_instruction_set([&](const std::string& name) {
        RandomGeometry random(family.seed + 100, family.resolution_m);
        for (int i = 0; i < family.rays; ++i) {
            const Eigen::Vector3f origin = random.point(family.reach_m);
            const Eigen::Vector3f end = random.end_from(origin, family.reach_m);
            ASSERT_EQ(list(lattice, origin, end), walk(lattice, origin, end))
                << name << ", seed " << family.seed + 100 << ", ray " << i << ": " << origin.transpose()
                << " -> " << end.transpose();
        }
    });
}

INSTANTIATE_TEST_SUITE_P(Families, RayWalkProperty,
                         testing::Values(RayFamily{1, 0.04, 4.0, 50'000}, RayFamily{2, 0.02, 2.0, 20'000},
                                         RayFamily{3, 0.05, 4.0, 20'000}, RayFamily{4, 0.1, 20.0, 20'000},
                                         RayFamily{5, 0.25, 4.0,
                                                   20'000},  // exact in binary: every face a tie
                                         RayFamily{6, 0.04, 600.0, 100}, RayFamily{7, 0.3, 4400.0, 100}),
                         [](const auto& which) { return "seed_" + std::to_string(which.param.seed); });

TEST(RayWalkProperty, takes_no_more_steps_and_strays_no_farther_than_it_promises) {
    RandomGeometry random(21, 0.04);
    const VoxelLattice lattice(0.04);
    for (int i = 0; i < 50'000; ++i) {
        const Eigen::Vector3f origin = random.point(4.0);
        const auto ray = plan_ray(lattice, origin, random.end_from(origin, 4.0));
        ASSERT_TRUE(ray.has_value());
        int visited = 0;
        walk_ray_keys(*ray, [&](VoxelKey key) {
            ++visited;
            const auto is_between = [](int value, int a, int b) {
                return value >= std::min(a, b) - 1 && value <= std::max(a, b) + 1;
            };
            ASSERT_TRUE(is_between(key.x, ray->first.x, ray->last.x) &&
                        is_between(key.y, ray->first.y, ray->last.y) &&
                        is_between(key.z, ray->first.z, ray->last.z))
                << "seed 21, ray " << i;
        });
        // Ended by arriving or by the length, never by the bound.
        ASSERT_LE(visited, ray->steps_max) << "seed 21, ray " << i;
    }
}

// Oracle: OctoMap's ray keys and updateNode, beam by beam, compared bit for bit after clamping.
TEST(RayModelProperty, a_map_of_random_beams_equals_octomaps) {
    constexpr unsigned kSeed = 31;
    const MappingConfig config = paper_mapping();
    RayModel model(config);
    FusedMap map(config.map);
    oracle::ClampedTree tree(config.map);
    RandomGeometry random(kSeed, config.map.resolution_m);
    for (int i = 0; i < 5'000; ++i) {
        Beam beam;
        beam.p_map_sensor = random.point(1.0).cast<double>();
        beam.direction_map =
            Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
        beam.range_m = random.uniform(0.0, 2.0);
        const auto evidence = model.find(beam);
        ASSERT_TRUE(evidence.has_value());
        EXPECT_TRUE((*evidence)->weakened.empty());
        map.apply((*evidence)->terms);

        const Eigen::Vector3f origin = beam.p_map_sensor.cast<float>();
        const Eigen::Vector3f end = (beam.p_map_sensor + *beam.range_m * beam.direction_map).cast<float>();
        for (const VoxelKey key : oracle::ray_keys(tree, origin, end)) {
            tree.updateNode(oracle::key_of(key), -0.4F);
        }
        const float hit = *beam.range_m < 0.04 ? 0.0F : static_cast<float>(1.0 - 0.07 * *beam.range_m);
        if (hit > 0.0F) tree.updateNode(oracle::point_of(end), hit);
    }
    EXPECT_GT(map.known_voxels(), 20'000U);
    EXPECT_EQ(oracle::voxels_of(map), oracle::voxels_of(tree)) << "seed " << kSeed;
}

}  // namespace
}  // namespace octoskin::property
