// Oracle: every voxel of the capsule's box one by one, its distance by golden section.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <tuple>

#include "host/core/query/capsule_query.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/random_space.hpp"
#include "tests/support/sampled_distance.hpp"

namespace octoskin {
namespace {

/// The worst is the least.
struct Candidate {
    int rank = 2;  ///< 0 occupied, 1 unknown, 2 nothing but free
    double steps = 0.0;
    MortonCode code = 0;
    friend bool operator<(const Candidate& a, const Candidate& b) {
        return std::tie(a.rank, a.steps, a.code) < std::tie(b.rank, b.steps, b.code);
    }
};

Candidate looked_for(const FusedMap& map, const PosedCapsule& capsule) {
    const double reach_m = capsule.radius_m + map.resolution_m();
    const VoxelKey lowest = *map.key_of(capsule.p_a.cwiseMin(capsule.p_b).array() - reach_m);
    const VoxelKey highest = *map.key_of(capsule.p_a.cwiseMax(capsule.p_b).array() + reach_m);
    Candidate worst;
    for (std::uint16_t x = lowest.x; x <= highest.x; ++x) {
        for (std::uint16_t y = lowest.y; y <= highest.y; ++y) {
            for (std::uint16_t z = lowest.z; z <= highest.z; ++z) {
                const Occupancy state = map.occupancy({x, y, z});
                if (state == Occupancy::free) continue;
                const double distance_m = sampled_distance(capsule.p_a, capsule.p_b, map.centre_of({x, y, z}),
                                                           0.5 * map.resolution_m());
                if (distance_m > capsule.radius_m + 1e-9) continue;
                worst = std::min(worst, Candidate{state == Occupancy::occupied ? 0 : 1,
                                                  std::round(distance_m * 1e9), morton_of({x, y, z})});
            }
        }
    }
    return worst;
}

class CapsuleSearch : public testing::TestWithParam<double> {};

TEST_P(CapsuleSearch, finds_what_a_look_at_every_voxel_does) {
    RandomSpace space(GetParam() > 0.03 ? 5 : 6, GetParam());
    std::array<unsigned, 3> seen{};
    for (unsigned i = 0; i < testing_support::cases(200); ++i) {
        const FusedMap map = space.map();
        const PosedCapsule capsule = space.capsule(i);
        const Candidate expected = looked_for(map, capsule);
        const auto answer = worst_in(map, capsule);
        ASSERT_TRUE(answer);
        ++seen.at(static_cast<std::size_t>(expected.rank));
        constexpr std::array kStates{Occupancy::occupied, Occupancy::unknown, Occupancy::free};
        ASSERT_EQ(answer->state, kStates.at(static_cast<std::size_t>(expected.rank))) << i;
        EXPECT_EQ(is_free(map, std::span(&capsule, 1)).value(), expected.rank == 2) << i;
        ASSERT_EQ(answer->voxel.has_value(), expected.rank != 2) << i;
        if (!answer->voxel) continue;
        ASSERT_EQ(std::round(answer->distance_m * 1e9), expected.steps) << i;
        ASSERT_EQ(morton_of(*answer->voxel), expected.code) << i;
    }
    for (const unsigned count : seen) EXPECT_GE(count, testing_support::cases(200) / 20);
}

INSTANTIATE_TEST_SUITE_P(Resolutions, CapsuleSearch, testing::Values(0.04, 0.02));

}  // namespace
}  // namespace octoskin
