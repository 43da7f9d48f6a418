// How fast the depth updates follow what has come and gone: an image at 10 Hz, ranges at 30 Hz.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

constexpr VoxelKey kKey{32768, 32768, 32768};

Evidence image(float term) {
    Evidence terms;
    terms.miss = -0.4F;
    terms.take_image({{kKey, term}});
    return terms;
}
const Evidence kPassing = image(-0.4F);
ConeVoxels cone_through() {
    ConeVoxels cone;
    cone.passed = {kKey};
    return cone;
}
ConeVoxels cone_onto() {
    ConeVoxels cone;
    cone.cap = {{kKey, 1.0F}};
    return cone;
}

/// What a voxel may have been through: images that hit it, then ranges that did, then ranges that passed it.
struct Past {
    int images = 0;
    int hits = 0;
    int misses = 0;
};

/// Every past that leaves the voxel occupied.
std::vector<FusedMap> occupied_maps(const MappingConfig& mapping) {
    std::vector<FusedMap> maps;
    for (const int images : {0, 1, 3, 20})
        for (const int hits : {0, 1, 5, 60})
            for (const int misses : {0, 3, 10}) {
                FusedMap map(mapping.map);
                for (int i = 0; i < images; ++i) feed(map, image(0.9F));
                for (int i = 0; i < hits; ++i) feed(map, cone_onto(), mapping.cone);
                for (int i = 0; i < misses; ++i) feed(map, cone_through(), mapping.cone);
                if (map.occupancy(kKey) == Occupancy::occupied) maps.push_back(std::move(map));
            }
    return maps;
}

template <class Apply>
int times_until(FusedMap& map, Occupancy wanted, const Apply& apply) {
    int times = 0;
    for (; times < 1000 && map.occupancy(kKey) != wanted; ++times) apply(map);
    return times;
}

struct Update {
    const char* name;
    MappingConfig mapping;
    int images_to_clear;  ///< images that pass an occupied voxel, until it is free
    int images_to_mark;   ///< images of something in a free voxel, until it is occupied
};

class Clearing : public testing::TestWithParam<Update> {
  protected:
    [[nodiscard]] static const MappingConfig& mapping() { return GetParam().mapping; }
};

TEST_P(Clearing, is_done_by_a_few_images_whatever_was_there) {
    auto maps = occupied_maps(mapping());
    EXPECT_GT(maps.size(), 30U);
    int most = 0;
    for (FusedMap& map : maps)
        most = std::max(most, times_until(map, Occupancy::free, [](FusedMap& m) { feed(m, kPassing); }));
    EXPECT_EQ(most, GetParam().images_to_clear);
}

TEST_P(Clearing, is_done_by_a_range_sensors_thirty_cones_whatever_was_there) {
    for (FusedMap& map : occupied_maps(mapping()))
        EXPECT_LE(times_until(map, Occupancy::free,
                              [](FusedMap& m) { feed(m, cone_through(), robust_mapping().cone); }),
                  30);
}

TEST_P(Clearing, is_done_by_a_range_sensors_thirty_rays_whatever_the_camera_saw) {
    FusedMap map(mapping().map);
    for (int i = 0; i < 50; ++i) feed(map, image(0.9F));
    EXPECT_LE(times_until(map, Occupancy::free,
                          [](FusedMap& m) {
                              feed(m, std::vector<VoxelUpdate>{{kKey, -0.4F}});
                          }),
              30);
}

// The third image of what has come is taken 0.2 s after the first.
TEST_P(Clearing, is_undone_by_a_few_images_of_what_has_come) {
    int most = 0;
    for (const float hit : {0.9F, 0.8F, 0.6F, 0.5F}) {  // ranges of 1 to 5 m
        for (const int cones : {0, 5, 60}) {
            FusedMap map(mapping().map);
            for (int i = 0; i < 50; ++i) feed(map, kPassing);
            for (int i = 0; i < cones; ++i) feed(map, cone_through(), mapping().cone);
            most = std::max(most,
                            times_until(map, Occupancy::occupied, [&](FusedMap& m) { feed(m, image(hit)); }));
        }
    }
    EXPECT_EQ(most, GetParam().images_to_mark);
}

TEST_P(Clearing, leaves_a_surface_that_the_camera_goes_on_seeing) {
    FusedMap map(mapping().map);
    for (int i = 0; i < 20; ++i) feed(map, image(0.9F));
    for (int i = 0; i < 300; ++i) {
        feed(map, cone_through(), mapping().cone);
        if (i % 3 == 0) feed(map, image(0.9F));
        EXPECT_EQ(map.occupancy(kKey), Occupancy::occupied);
    }
}

INSTANTIATE_TEST_SUITE_P(Updates, Clearing,
                         testing::Values(Update{"fast", fast_mapping(), 5, 3},
                                         Update{"robust", robust_mapping(), 5, 3},
                                         Update{"denoised", denoised_mapping(), 8, 2}),
                         [](const auto& tested) { return tested.param.name; });

/// As a pixel has it that ended in the voxel and now ends behind it.
void see_through(FusedMap& map) {
    Evidence retracted;
    retracted.rule = EvidenceRule::weaken;
    retracted.sensor = SensorKind::camera;
    retracted.miss = std::numeric_limits<float>::lowest();
    put_in(retracted.last(brick_of(kKey)).voxels, cell_of(kKey));
    feed(map, retracted);
    feed(map, kPassing);
}

TEST(Clearing, is_done_by_one_image_of_denoised_where_no_range_was_counted) {
    for (const int images : {1, 3, 20}) {
        FusedMap map(denoised_mapping().map);
        for (int i = 0; i < images; ++i) feed(map, image(0.9F));
        EXPECT_EQ(times_until(map, Occupancy::free, see_through), 1) << images;
    }
}

TEST(Clearing, takes_no_longer_where_the_camera_retracts_what_it_saw) {
    int most = 0;
    for (FusedMap& map : occupied_maps(denoised_mapping()))
        most = std::max(most, times_until(map, Occupancy::free, see_through));
    EXPECT_EQ(most, 5);
}

TEST(Clearing, of_the_papers_update_takes_what_its_clamps_take) {
    FusedMap map(paper_mapping().map);
    for (int i = 0; i < 20; ++i) feed(map, image(0.9F));
    EXPECT_EQ(times_until(map, Occupancy::free, [](FusedMap& m) { feed(m, kPassing); }), 9);
}

}  // namespace
}  // namespace octoskin
