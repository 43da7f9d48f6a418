#include "host/lab/evaluation/free_calibration.hpp"

#include <gtest/gtest.h>

#include "tests/support/evidence.hpp"
#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::evaluation {
namespace {

std::uint64_t voxels_of(const FreeBins& bins) {
    std::uint64_t sum = 0;
    for (const FreeBin& bin : bins) sum += bin.voxels;
    return sum;
}

class FreeCalibrationTest : public testing::Test {
  protected:
    void set(int x, float log_odds) { ASSERT_TRUE(map_.set_cube({key(x, 0, 0), 0}, log_odds)); }

    FusedMap map_{denoised_mapping().map};
    VoxelGrid<SurfaceVoxel> surface_{row(6)};
};

TEST_F(FreeCalibrationTest, is_of_free_voxels_by_their_images) {
    set(0, -0.4F);
    set(1, -0.4F);
    set(2, -1.2F);
    set(3, 0.8F);  // occupied; the voxel behind it is unknown
    set(5, -2.0F);
    for (const int x : {1, 3, 4, 5}) surface_.at(key(x, 0, 0)).is_surface = true;
    const FreeCalibration found = free_calibration(map_, {}, surface_);
    EXPECT_EQ(voxels_of(found.images), 4U);
    EXPECT_EQ(found.images[1].voxels, 2U);
    EXPECT_EQ(found.images[1].surface, 1U);
    EXPECT_DOUBLE_EQ(found.images[1].surface_share().value(), 0.5);
    EXPECT_EQ(found.images[3].voxels, 1U) << "three misses are not two";
    EXPECT_EQ(found.images[3].surface, 0U);
    EXPECT_EQ(found.images[5].surface, 1U);
    EXPECT_FALSE(found.images[2].surface_share());
    EXPECT_EQ(found.beams[0].voxels, 4U);
    EXPECT_EQ(found.sum[5].voxels, 1U);
}

TEST_F(FreeCalibrationTest, leaves_out_the_inside_of_solids) {
    set(0, -0.4F);
    set(1, -0.4F);
    surface_.at(key(0, 0, 0)).is_interior = true;
    EXPECT_EQ(voxels_of(free_calibration(map_, {}, surface_).sum), 1U);
}

TEST_F(FreeCalibrationTest, counts_beams_apart_and_in_the_sum) {
    ConeVoxels cone;  // passed more often than counts.misses_min: less is not known as free
    cone.passed = {key(0, 0, 0), key(1, 0, 0)};
    for (int i = 0; i < 4; ++i) feed(map_, cone, zone_model());
    feed(map_, std::vector<VoxelUpdate>{{key(1, 0, 0), -0.4F}}, SensorKind::camera);
    const FreeCalibration found = free_calibration(map_, {}, surface_);
    EXPECT_EQ(found.beams[4].voxels, 2U);
    EXPECT_EQ(found.images[0].voxels, 1U);
    EXPECT_EQ(found.images[1].voxels, 1U);
    EXPECT_EQ(found.sum[4].voxels, 1U);
    EXPECT_EQ(found.sum[5].voxels, 1U);
    FreeCalibration twice = found;
    twice.add(found);
    EXPECT_EQ(twice.beams[4].voxels, 4U);
}

TEST_F(FreeCalibrationTest, sums_up_what_a_minimum_leaves_free) {
    FreeBins bins;
    bins[0] = {.voxels = 10, .surface = 5};
    bins[4] = {.voxels = 20, .surface = 2};
    bins.back() = {.voxels = 70, .surface = 0};
    const FreeBins least = at_least(bins);
    EXPECT_EQ(least[0].voxels, 100U);
    EXPECT_EQ(least[0].surface, 7U);
    EXPECT_EQ(least[1].voxels, 90U);
    EXPECT_EQ(least[4].surface, 2U);
    EXPECT_EQ(least[5].surface, 0U);
    EXPECT_EQ(least.back().voxels, 70U);
}

TEST_F(FreeCalibrationTest, has_one_bin_for_all_with_more) {
    MapConfig config = map_.config();
    config.log_odds_min = -100.0F;
    FusedMap map(config);
    ASSERT_TRUE(map.set_cube({key(0, 0, 0), 0}, -100.0F));
    EXPECT_EQ(free_calibration(map, {}, surface_).images.back().voxels, 1U);
}

}  // namespace
}  // namespace octoskin::evaluation
