#include "host/lab/evaluation/unknown_space.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace octoskin::evaluation {
namespace {

const PocketRegion kBall{{0.0, 0.0, 0.0}, 0.5, 0.0};
constexpr double kVoxel_m3 = 0.04 * 0.04 * 0.04;

HostTime at(double t_s) {
    return HostTime{} + Nanoseconds(static_cast<std::int64_t>(t_s * 1e9));
}

/// Frees the voxels of the ball with x below a limit.
void free_up_to(FusedMap& map, double x_max_m) {
    for (double x = -0.5; x < x_max_m; x += 0.04) {
        for (double y = -0.5; y < 0.52; y += 0.04) {
            for (double z = 0.02; z < 0.52; z += 0.04)
                feed(map, std::vector<VoxelUpdate>{{*map.lattice().key_of({x, y, z}), -0.4F}});
        }
    }
}

TEST(UnknownSpace, is_sampled_every_quarter_of_a_second_and_at_the_end) {
    FusedMap depth{MapConfig{}};
    FusedMap fused{MapConfig{}};
    UnknownSpaceMeter meter(kBall);
    meter.see(at(5.0), &depth, fused);
    free_up_to(fused, 0.0);
    meter.see(at(5.1), &depth, fused);
    meter.see(at(5.26), &depth, fused);
    free_up_to(fused, 0.6);
    free_up_to(depth, 0.0);
    meter.see(at(5.4), &depth, fused);
    const UnknownSpace space = meter.finish(&depth, fused);

    const double half_ball_m3 = 2.0 / 3.0 * M_PI * 0.125;
    EXPECT_NEAR(space.region_m3, half_ball_m3, 0.02);
    ASSERT_EQ(space.samples.size(), 3U);
    EXPECT_DOUBLE_EQ(space.samples[0].t_s, 0.0);
    EXPECT_DOUBLE_EQ(space.samples[0].fused_m3, space.region_m3);
    EXPECT_DOUBLE_EQ(*space.samples[0].depth_m3, space.region_m3);
    EXPECT_NEAR(space.samples[1].t_s, 0.26, 1e-9);
    EXPECT_NEAR(space.samples[1].fused_m3, 0.5 * space.region_m3, 0.02);
    EXPECT_NEAR(space.samples[2].t_s, 0.4, 1e-9);
    EXPECT_NEAR(space.samples[2].fused_m3, 0.0, 100 * kVoxel_m3);
    EXPECT_NEAR(*space.samples[2].depth_m3, 0.5 * space.region_m3, 0.02);
    EXPECT_TRUE(space.pockets.empty()) << "all is free";
}

TEST(UnknownSpace, has_the_pockets_that_are_left_and_needs_no_camera) {
    FusedMap fused{MapConfig{}};
    UnknownSpaceMeter meter(kBall);
    free_up_to(fused, 0.2);
    meter.see(at(1.0), nullptr, fused);
    const UnknownSpace space = meter.finish(nullptr, fused);
    ASSERT_EQ(space.samples.size(), 2U);
    EXPECT_FALSE(space.samples[0].depth_m3);
    EXPECT_FALSE(space.depth_columns);
    ASSERT_EQ(space.pockets.size(), 1U);
    EXPECT_GT(space.pockets[0].centre.x(), 0.2);
    EXPECT_NEAR(space.pockets[0].volume_m3, space.samples[1].fused_m3, 1e-9);
}

TEST(UnknownSpace, tells_of_each_column_how_much_of_it_is_left) {
    FusedMap depth{MapConfig{}};
    FusedMap fused{MapConfig{}};
    const PocketRegion ball{{0.6, -0.4, 0.0}, 0.5, 0.0};
    feed(fused, std::vector<VoxelUpdate>{{*fused.lattice().key_of({0.62, -0.38, 0.14}), -0.4F},
                                         {*fused.lattice().key_of({0.62, -0.38, 0.22}), 2.0F},
                                         {*fused.lattice().key_of({0.62, -0.38, -0.1}), 2.0F}});
    UnknownSpaceMeter meter(ball);
    meter.see(at(1.0), &depth, fused);
    const UnknownSpace space = meter.finish(&depth, fused);
    ASSERT_TRUE(space.depth_columns);
    const UnknownColumns& columns = space.fused_columns;
    ASSERT_EQ(columns.unknown_m.size(), columns.side * columns.side);
    double sum_m = 0.0;
    for (std::size_t i = 0; i < columns.unknown_m.size(); ++i) {
        const double x = columns.low_x_m + (static_cast<double>(i % columns.side) + 0.5) * columns.edge_m;
        const double y = columns.low_y_m + (static_cast<double>(i / columns.side) + 0.5) * columns.edge_m;
        const double height_m = std::sqrt(std::max(0.0, 0.25 - x * x - y * y));
        const bool is_seen = std::abs(x - 0.02) < 0.01 && std::abs(y - 0.02) < 0.01;
        EXPECT_NEAR(space.depth_columns->unknown_m[i], height_m, 0.0201) << x << ' ' << y;
        EXPECT_NEAR(columns.unknown_m[i], space.depth_columns->unknown_m[i] - (is_seen ? 0.08 : 0.0), 1e-9);
        sum_m += columns.unknown_m[i];
    }
    EXPECT_NEAR(sum_m * 0.04 * 0.04, space.samples.back().fused_m3, 1e-9);
}

TEST(UnknownSpace, of_a_region_without_voxels_has_no_samples) {
    FusedMap fused{MapConfig{}};
    UnknownSpaceMeter meter({{0.0, 0.0, 0.0}, std::nan(""), 0.0});
    meter.see(at(1.0), nullptr, fused);
    EXPECT_TRUE(meter.finish(nullptr, fused).samples.empty());
}

}  // namespace
}  // namespace octoskin::evaluation
