#include "host/core/mapping/free_evidence.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/voxel_brick.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

constexpr VoxelKey kVoxel{32768, 32768, 32768};

FreeEvidence of_state(float prior, float hits, float misses, const MissUnits& units = {}) {
    return free_evidence({.log_odds = -1.0F, .prior = prior, .hits = hits, .misses = misses}, units);
}

TEST(FreeEvidence, counts_the_misses_in_the_prior_as_images) {
    float prior = 0.0F;
    for (const double images : {1.0, 2.0, 3.0, 4.0, 5.0}) {
        prior -= 0.4F;  // rounding accumulates
        EXPECT_EQ(of_state(prior, 0.0F, 0.0F).images, images);
    }
    EXPECT_EQ(of_state(-0.2F, 0.0F, 0.0F).images, 0.5) << "an image of a moving camera";
    EXPECT_EQ(of_state(1.5F, 0.0F, 0.0F).images, 0.0);
    EXPECT_EQ(of_state(kUnknownLogOdds, 0.0F, 0.0F).sum(), 0.0);
}

TEST(FreeEvidence, counts_misses_less_hits_as_beams) {
    EXPECT_EQ(of_state(kUnknownLogOdds, 0.0F, 2.4F).beams, 2.0);
    EXPECT_EQ(of_state(kUnknownLogOdds, 0.6F, 2.4F).beams, 1.5);
    EXPECT_EQ(of_state(kUnknownLogOdds, 3.0F, 2.4F).beams, 0.0);
    EXPECT_EQ(of_state(-0.8F, 0.0F, 3.6F), (FreeEvidence{2.0, 3.0}));
    EXPECT_EQ(of_state(-0.8F, 0.0F, 3.6F).sum(), 5.0);
}

TEST(FreeEvidence, of_measurements_that_never_free_is_none) {
    EXPECT_EQ(of_state(-2.0F, 0.0F, 5.0F, {.log_odds = 0.0F, .misses = 0.0F}).sum(), 0.0);
}

TEST(FreeEvidence, has_the_units_of_the_mapping) {
    EXPECT_EQ(miss_units(denoised_mapping()), (MissUnits{0.4F, 1.2F}));
    MappingConfig mapping;
    mapping.model.miss_log_odds = -0.8F;
    mapping.cone.miss_mass = 2.0F;
    EXPECT_EQ(miss_units(mapping), (MissUnits{0.8F, 2.0F}));
}

TEST(FreeEvidence, of_a_voxel_of_a_map_is_that_of_its_images_and_ranges) {
    const MappingConfig mapping = denoised_mapping();
    const MissUnits units = miss_units(mapping);
    FusedMap map(mapping.map);
    const auto evidence = [&] { return free_evidence(voxel_state(map.layers(), kVoxel), units); };
    EXPECT_EQ(evidence().sum(), 0.0) << "unknown";
    const std::vector<VoxelUpdate> miss{{kVoxel, -0.4F}};
    for (const double images : {1.0, 2.0, 3.0, 4.0, 5.0, 5.0, 5.0}) {
        feed(map, miss, SensorKind::camera);
        EXPECT_EQ(evidence(), (FreeEvidence{images, 0.0})) << "the clamp is five";
    }
    ConeVoxels cone;
    cone.passed = {kVoxel};
    feed(map, cone, mapping.zone);
    feed(map, cone, mapping.zone);
    EXPECT_EQ(evidence(), (FreeEvidence{5.0, 2.0}));
    feed(map, cone, mapping.cone);
    EXPECT_EQ(evidence(), (FreeEvidence{5.0, 2.31})) << "0.37 of 1.2";
}

}  // namespace
}  // namespace octoskin
