#include "host/lab/evaluation/region.hpp"

#include <gtest/gtest.h>

#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::evaluation {
namespace {

Eigen::Isometry3d shifted(double x, double y, double z) {
    Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
    T_map_base.translation() << x, y, z;
    return T_map_base;
}

TEST(Region, of_the_experiment_is_50_by_60_by_35_voxels) {
    // Floor top -0.02 + 0.001814 m lies in layer -1, so the region begins at layer 0.
    const KeyBox box = region_of(RegionConfig{}, 0.04, shifted(0.002990, 0.020829, 0.001814));
    EXPECT_EQ(box, (KeyBox{key(-15, -30, 0), key(34, 29, 34)}));
    EXPECT_EQ(box.size(), 105000U);
}

TEST(Region, loses_a_layer_when_the_floor_moves_into_the_next) {
    // -0.02 + 0.030781 m lies in layer 0.
    const KeyBox box = region_of(RegionConfig{}, 0.04, shifted(0.008568, 0.036154, 0.030781));
    EXPECT_EQ(box, (KeyBox{key(-15, -30, 1), key(34, 29, 34)}));
}

TEST(Region, stays_put_in_the_map_when_the_world_moves_sideways) {
    const KeyBox here = region_of(RegionConfig{}, 0.04, shifted(0.0, 0.0, 0.0));
    const KeyBox there = region_of(RegionConfig{}, 0.04, shifted(0.5, -0.5, 0.0));
    EXPECT_EQ(here, there);
}

TEST(Region, without_a_floor_begins_at_its_own_bound) {
    const RegionConfig config{{0.0, 0.0, -0.2}, {0.1, 0.1, 0.1}, std::nullopt};
    EXPECT_EQ(region_of(config, 0.1, shifted(0, 0, 0)), (KeyBox{key(0, 0, -2), key(0, 0, 0)}));
}

TEST(Region, takes_voxels_whose_centre_is_inside) {
    const RegionConfig config{{0.04, -0.06, 0.0}, {0.36, 0.34, 0.1}, std::nullopt};
    // Centres along x: 0.05 .. 0.35; along y: -0.05 .. 0.25 (0.35 is outside).
    EXPECT_EQ(region_of(config, 0.1, shifted(0, 0, 0)), (KeyBox{key(0, -1, 0), key(3, 2, 0)}));
}

TEST(FloorLayer, follows_the_base_up) {
    EXPECT_EQ(floor_layer(-0.02, 0.04, shifted(0, 0, 0)), kOriginKey - 1);
    EXPECT_EQ(floor_layer(-0.02, 0.04, shifted(0, 0, 0.021)), kOriginKey);
    EXPECT_EQ(floor_layer(0.5, 0.04, shifted(0, 0, 0)), kOriginKey + 12);
}

TEST(RegionFault, finds_nothing_wrong_with_the_experiment) {
    EXPECT_FALSE(region_fault(RegionConfig{}, 0.04, shifted(0.002990, 0.020829, 0.001814)));
    EXPECT_FALSE(region_fault(RegionConfig{}, 0.01, shifted(0, 0, 0)));
}

TEST(RegionFault, says_what_leaves_nothing_to_judge) {
    const auto fault = [](const RegionConfig& config, double resolution_m) {
        return region_fault(config, resolution_m, shifted(0, 0, 0)).value_or(Error{}).code;
    };
    RegionConfig high_floor;
    high_floor.floor_top_m = 1.39;  // its layer is the highest of the box
    EXPECT_EQ(fault(high_floor, 0.04), ErrorCode::no_content);
    EXPECT_EQ(fault(RegionConfig{}, 5.0), ErrorCode::no_content);
    EXPECT_EQ(fault(RegionConfig{}, 1e-7), ErrorCode::out_of_range) << "the floor is outside the map";
    EXPECT_EQ(fault(RegionConfig{}, 1e-6), ErrorCode::out_of_range);
    EXPECT_EQ(fault({{0, 0, 0}, {2, 2, 2}, std::nullopt}, 1e-5), ErrorCode::out_of_range);
    EXPECT_EQ(fault({{-1, -1, -1}, {1, 1, 1}, std::nullopt}, 0.002), ErrorCode::limit_exceeded);
    const auto floor = region_fault(RegionConfig{}, 1e-7, shifted(0, 0, 0));
    EXPECT_NE(floor->what.find("floor"), std::string::npos);
}

}  // namespace
}  // namespace octoskin::evaluation
