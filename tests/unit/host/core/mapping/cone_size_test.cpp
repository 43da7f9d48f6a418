#include "host/core/mapping/cone_size.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

#include "host/core/mapping/cone_finder.hpp"

namespace octoskin {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

MappingConfig config_of(double resolution_m) {
    MappingConfig config = fast_mapping();
    config.map.resolution_m = resolution_m;
    config.no_return_clear_m = 100.0;
    return config;
}

Beam beam_of(double half_angle_deg, double sigma_deg, std::optional<double> range_m) {
    Beam beam;
    beam.p_map_sensor = {0.513, -0.247, 0.391};
    beam.range_m = range_m;
    beam.sigma_m = 0.01;
    beam.optics = {.half_angle_rad = half_angle_deg * kRadPerDeg, .sigma_rad = sigma_deg * kRadPerDeg};
    return beam;
}

TEST(ConeSize, is_no_less_than_what_is_found_nor_much_more_where_that_is_many) {
    std::mt19937 random(11);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<>(low, high)(random);
    };
    for (int i = 0; i < 200; ++i) {
        MappingConfig config = config_of(between(0.01, 0.1));
        config.cone.hit_range_max_m = between(0.0, 2.0);
        config.cone.core_margin_voxels = between(0.0, 2.0);
        config.cone.cap_sigmas = between(0.0, 10.0);
        Beam beam = beam_of(between(0.1, 45.0), between(0.1, 90.0), between(0.01, 2.0));
        beam.clear_limit_m = 2.0;
        if (i % 3 == 0) beam.range_m.reset();
        beam.direction_map =
            Eigen::Vector3d(between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0)).normalized();
        ConeFinder finder(config);
        const auto found = finder.find(beam);
        ASSERT_TRUE(found);
        const double at_most = cone_voxels_at_most(beam, config);
        EXPECT_LE(static_cast<double>((*found)->passed.size() + (*found)->cap.size()), at_most);
        const auto passed = static_cast<double>((*found)->passed.size());
        if ((*found)->cap.empty() && passed > 10'000.0) {
            EXPECT_LT(at_most, 3.0 * passed);
        }
    }
}

TEST(ConeSize, is_known_before_any_voxel_is_looked_at) {
    EXPECT_GT(cone_voxels_at_most(beam_of(45.0, 45.0, 8.0), config_of(0.001)), 1e11);
    EXPECT_TRUE(is_cone_too_large(beam_of(45.0, 45.0, 8.0), config_of(0.001)));
    EXPECT_TRUE(is_cone_too_large(beam_of(45.0, 45.0, 8.0), config_of(0.02)));
    EXPECT_FALSE(is_cone_too_large(beam_of(45.0, 45.0, 8.0), config_of(0.04)));
    // What is sold: 13.5 degrees and 4 m.
    EXPECT_FALSE(is_cone_too_large(beam_of(13.5, 7.0, 4.0), config_of(0.006)));
    EXPECT_TRUE(is_cone_too_large(beam_of(13.5, 7.0, 4.0), config_of(0.004)));
    const auto refused = ConeFinder(config_of(0.004)).find(beam_of(13.5, 7.0, 4.0));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error(), BeamRejection::cone_too_large);
}

TEST(ConeSize, counts_how_far_space_is_freed_without_return) {
    Beam beam = beam_of(13.5, 7.0, std::nullopt);
    beam.clear_limit_m = 4.0;
    EXPECT_FALSE(is_cone_too_large(beam, config_of(0.04)));
    beam.clear_limit_m = 100.0;
    EXPECT_TRUE(is_cone_too_large(beam, config_of(0.04)));
    MappingConfig config = config_of(0.04);
    config.no_return_clear_m = 4.0;
    EXPECT_FALSE(is_cone_too_large(beam, config));
}

TEST(ConeSize, counts_the_box_of_a_cap_whose_range_is_not_sure) {
    MappingConfig config = config_of(0.01);
    config.cone.hit_range_max_m = 4.0;
    config.cone.cap_sigmas = 10.0;
    Beam beam = beam_of(13.5, 7.0, 1.5);
    EXPECT_FALSE(is_cone_too_large(beam, config));
    for (const double sigma_m : {1.0, 1e6, std::numeric_limits<double>::infinity()}) {
        beam.sigma_m = sigma_m;
        EXPECT_TRUE(is_cone_too_large(beam, config)) << sigma_m;
    }
}

}  // namespace
}  // namespace octoskin
