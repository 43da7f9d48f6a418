// Oracle: every voxel about the capsule one by one, its distance by golden section.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "host/core/query/capsule_query.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/random_space.hpp"
#include "tests/support/sampled_distance.hpp"

namespace octoskin {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();

struct LookedFor {
    double occupied_m = kNothing;
    double not_free_m = kNothing;
};

LookedFor looked_for(const FusedMap& map, const PosedCapsule& capsule, double reach_m) {
    const double about_m = capsule.radius_m + reach_m + map.resolution_m();
    const VoxelKey lowest = *map.key_of(capsule.p_a.cwiseMin(capsule.p_b).array() - about_m);
    const VoxelKey highest = *map.key_of(capsule.p_a.cwiseMax(capsule.p_b).array() + about_m);
    LookedFor nearest;
    for (std::uint16_t x = lowest.x; x <= highest.x; ++x) {
        for (std::uint16_t y = lowest.y; y <= highest.y; ++y) {
            for (std::uint16_t z = lowest.z; z <= highest.z; ++z) {
                const Occupancy state = map.occupancy({x, y, z});
                if (state == Occupancy::free) continue;
                const double distance_m = sampled_distance(capsule.p_a, capsule.p_b, map.centre_of({x, y, z}),
                                                           0.5 * map.resolution_m());
                const double gap_m = std::max(0.0, distance_m - capsule.radius_m);
                if (gap_m > reach_m) continue;
                nearest.not_free_m = std::min(nearest.not_free_m, gap_m);
                if (state == Occupancy::occupied) nearest.occupied_m = std::min(nearest.occupied_m, gap_m);
            }
        }
    }
    return nearest;
}

TEST(CapsuleClearance, is_what_a_look_at_every_voxel_says) {
    RandomSpace space(9, 0.04);
    constexpr double kReach_m = 0.2;
    std::array<unsigned, 3> seen{};  // touched, apart, out of reach
    for (unsigned i = 0; i < testing_support::cases(150); ++i) {
        const FusedMap map = space.map();
        PosedCapsule capsule = space.capsule(i);
        capsule.radius_m *= 0.3;  // among free space, too
        const LookedFor expected = looked_for(map, capsule, kReach_m);
        const auto found = clearance(map, capsule, kReach_m);
        ASSERT_TRUE(found);
        ++seen.at(expected.occupied_m == 0.0 ? 0 : expected.occupied_m < kNothing ? 1 : 2);
        ASSERT_EQ(found->occupied_m.has_value(), expected.occupied_m < kNothing) << i;
        ASSERT_EQ(found->not_free_m.has_value(), expected.not_free_m < kNothing) << i;
        if (found->occupied_m) {
            ASSERT_NEAR(*found->occupied_m, expected.occupied_m, 2e-9) << i;
        }
        if (found->not_free_m) {
            ASSERT_NEAR(*found->not_free_m, expected.not_free_m, 2e-9) << i;
        }
    }
    EXPECT_GE(seen[0], testing_support::cases(150) / 20);
    EXPECT_GE(seen[1], testing_support::cases(150) / 20);
}

TEST(CapsuleClearance, is_that_to_the_octrees_bounds_if_these_are_nearest) {
    FusedMap map{MapConfig{.resolution_m = 0.04}};
    const double bound_m = 32768 * 0.04;
    ASSERT_TRUE(map.set_cube({{65536 - 64, 32768, 32768}, 6}, -1.0F));
    const Eigen::Vector3d p(bound_m - 0.5, 1.28, 1.28);
    const auto found = clearance(map, {p, p, 0.1}, 0.45);
    ASSERT_TRUE(found && found->not_free_m);
    EXPECT_NEAR(*found->not_free_m, 0.4, 1e-8);
    EXPECT_FALSE(found->occupied_m);
}

TEST(CapsuleClearance, refuses_a_reach_that_is_none) {
    const FusedMap map{MapConfig{}};
    for (const double reach_m :
         {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e7})
        EXPECT_EQ(clearance(map, {}, reach_m).error(), CapsuleFault::too_large) << reach_m;
    EXPECT_EQ(clearance(map, {{0, 0, std::nan("")}, {0, 0, 0}, 0.1}, 0.5).error(), CapsuleFault::not_finite);
}

}  // namespace
}  // namespace octoskin
