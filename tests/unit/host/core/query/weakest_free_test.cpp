// The oracle looks at every voxel.
#include "host/core/query/weakest_free.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "host/core/mapping/voxel_brick.hpp"
#include "host/core/query/own_space.hpp"
#include "host/core/query/path_query.hpp"
#include "host/core/query/segment_cube.hpp"
#include "tests/support/evidence.hpp"
#include "tests/unit/host/core/query/two_joint_arm.hpp"

namespace octoskin {
namespace {

constexpr MissUnits kUnits{};

/// Random images and ranges about the origin.
FusedMap random_map(std::mt19937& random) {
    const MappingConfig mapping = denoised_mapping();
    FusedMap map(mapping.map);
    std::uniform_real_distribution<double> place(-0.5, 0.5);
    const auto somewhere = [&] { return *map.key_of({place(random), place(random), place(random)}); };
    for (int round = 0; round < 20; ++round) {
        std::vector<VoxelUpdate> image;
        for (int i = 0; i < 2000; ++i) image.push_back({somewhere(), random() % 8 == 0 ? 0.8F : -0.4F});
        feed(map, image, SensorKind::camera);
        ConeVoxels cone;
        std::set<VoxelKey> passed;
        while (passed.size() < 100) passed.insert(somewhere());
        cone.passed.assign(passed.begin(), passed.end());
        cone.cap = {{somewhere(), 1.0F}};
        feed(map, cone, mapping.zone);
    }
    return map;
}

/// The least sum of the touched free voxels; empty: there is none.
std::optional<double> least_sum(const FusedMap& map, const PosedCapsule& capsule) {
    const SegmentToCubes segment(capsule.p_a, capsule.p_b);
    std::optional<double> least;
    map.for_each_known([&](VoxelKey key, float) {
        if (map.occupancy(key) != Occupancy::free) return;
        if (segment.distance(map.centre_of(key), 0.5 * map.resolution_m()) > capsule.radius_m + 1e-9) return;
        const double sum = free_evidence(voxel_state(map.layers(), key), kUnits).sum();
        least = std::min(least.value_or(sum), sum);
    });
    return least;
}

TEST(WeakestFree, is_the_touched_free_voxel_with_the_least_evidence) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-0.6, 0.6);
    int found_any = 0;
    for (int round = 0; round < 10; ++round) {
        const FusedMap map = random_map(random);
        for (int i = 0; i < 10; ++i) {
            const PosedCapsule capsule{{place(random), place(random), place(random)},
                                       {place(random), place(random), place(random)},
                                       0.15 * (place(random) + 0.6)};
            const auto expected = least_sum(map, capsule);
            const auto found = weakest_free_in(map, kUnits, capsule);
            ASSERT_EQ(found.has_value(), expected.has_value());
            if (!found) continue;
            ++found_any;
            EXPECT_EQ(found->evidence.sum(), *expected);
            EXPECT_EQ(found->evidence, free_evidence(voxel_state(map.layers(), found->voxel), kUnits));
            EXPECT_EQ(weakest_free_in(map, kUnits, capsule, found)->voxel, found->voxel);
        }
    }
    EXPECT_GT(found_any, 50);
}

TEST(WeakestFree, in_space_without_a_free_voxel_is_none) {
    FusedMap map(MapConfig{});
    const PosedCapsule capsule{{0, 0, 0}, {0, 0, 0.2}, 0.1};
    EXPECT_FALSE(weakest_free_in(map, kUnits, capsule));
    ASSERT_TRUE(map.set_cube({*map.key_of({0, 0, 0}), 0}, 1.0F));
    EXPECT_FALSE(weakest_free_in(map, kUnits, capsule)) << "occupied";
    EXPECT_FALSE(weakest_free_in(map, kUnits, {{1e5, 0, 0}, {1e5, 0, 0.2}, 0.1})) << "outside";
}

class FreeDemandTest : public testing::Test {
  protected:
    /// All is free by 2.5 images, and the voxel at the hand by half of one.
    FreeDemandTest() { mark(map_, {0.42, 0.02, 0.3}, -0.2F); }

    [[nodiscard]] PostureAnswer worst(double sum_min, const FusedMap& map) const {
        return *worst_of(query_, map, *query_.pose(std::array{0.0, 0.0}), {.sum_min = sum_min});
    }

    TwoJointArm arm_;
    RobotQuery query_ = RobotQuery::build(arm_.rig, arm_.robot).value();
    FusedMap map_ = free_about_origin();
};

TEST_F(FreeDemandTest, makes_space_with_less_evidence_unknown) {
    EXPECT_EQ(worst(0.0, map_).state, PostureState::free);
    EXPECT_EQ(worst(0.5, map_).state, PostureState::free);
    const PostureAnswer weak = worst(0.51, map_);
    EXPECT_EQ(weak.state, PostureState::unknown);
    EXPECT_EQ(arm_.robot.link_names()[weak.link.value()], "hand");
    EXPECT_EQ(weak.voxel, map_.key_of({0.42, 0.02, 0.3}));
    EXPECT_EQ(worst(2.5, without(map_, {0.4, 0.0, 0.28}, {0.44, 0.04, 0.32})).state, PostureState::unknown)
        << "it has not been measured";
    mark(map_, {0.38, 0.02, 0.3}, 1.0F);
    EXPECT_EQ(worst(100.0, map_).state, PostureState::occupied);
}

TEST_F(FreeDemandTest, goes_before_stale) {
    FusedMap aging = free_about_origin(10);
    confirm_about_origin(aging, {});
    aging.advance_time({20'000'000'000});
    EXPECT_EQ(worst(3.0, aging).state, PostureState::stale);
    EXPECT_EQ(worst(4.0, aging).state, PostureState::unknown) << "free by 3.5 images";
}

TEST_F(FreeDemandTest, holds_for_all_of_a_way_and_the_way_tells_its_weakest_voxel) {
    const std::vector<double> aside{0.6, 0.0};
    const std::vector<double> there{0.0, 0.0};
    const Leg leg(query_, map_, aside, there);
    LegConfig config;
    LegAnswer answer = ask(query_, map_, leg, config).value();
    EXPECT_EQ(answer.worst.state, PostureState::free);
    ASSERT_TRUE(answer.free);
    EXPECT_EQ(answer.free->weakest.evidence, (FreeEvidence{0.5, 0.0}));
    EXPECT_EQ(answer.free->weakest.voxel, map_.key_of({0.42, 0.02, 0.3}));
    config.demand.sum_min = 1.0;
    answer = ask(query_, map_, leg, config).value();
    EXPECT_EQ(answer.worst.state, PostureState::unknown);
    EXPECT_GT(answer.share, 0.5);
}

TEST_F(FreeDemandTest, frees_the_arms_own_space_too) {
    FusedMap map = map_.copy();
    const auto capsules = query_.pose(std::array{0.0, 0.0});
    EXPECT_EQ(free_own_space(map, {*capsules, *capsules}, 0.05), 0U);
    EXPECT_EQ(free_own_space(map, {*capsules, *capsules}, 0.05, [] { return false; }, {.sum_min = 1.0}), 1U);
    EXPECT_EQ(worst(2.5, map).state, PostureState::free);
    EXPECT_EQ(voxel_state(map.layers(), *map.key_of({0.42, 0.02, 0.3})).log_odds, -2.0F);
}

}  // namespace
}  // namespace octoskin
