#include "host/core/mapping/cone_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>

namespace octoskin {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr BeamOptics kCone{.half_angle_rad = 13.5 * kRadPerDeg, .sigma_rad = 7.0 * kRadPerDeg};

MappingConfig config_of(double resolution_m) {
    MappingConfig config = robust_mapping();
    config.map.resolution_m = resolution_m;
    config.cone.hit_range_max_m = 0.9;
    config.cone.cap_half_thickness_m = 0.04;
    config.cone.cap_sigmas = 2.0;
    config.cone.core_weight_min = 0.7;
    config.cone.core_margin_voxels = 0.5;
    return config;
}

Beam beam_to(const Eigen::Vector3d& direction, std::optional<double> range_m) {
    Beam beam;
    beam.p_map_sensor = {0.513, -0.247, 0.391};
    beam.direction_map = direction.normalized();
    beam.range_m = range_m;
    beam.sigma_m = 0.005;
    beam.optics = kCone;
    return beam;
}

/// What a voxel's centre says, with trigonometry, and by how much: a voxel within 1e-9 of a limit is not
/// judged.
struct Verdict {
    bool is_in = false;
    bool is_close = false;
};
Verdict all_of(std::initializer_list<double> margins) {
    Verdict verdict{true, false};
    for (const double margin : margins) {
        verdict.is_in = verdict.is_in && margin >= 0.0;
        verdict.is_close = verdict.is_close || std::fabs(margin) < 1e-9;
    }
    return verdict;
}

class BruteForce {
  public:
    BruteForce(const MappingConfig& config, const Beam& beam)
        : config_(config), beam_(beam), lattice_(config.map.resolution_m) {}

    // 0.7 of the peak of a Gaussian of 7 degrees: 5.9123 degrees off the axis.
    Verdict is_passed(VoxelKey key, double core_rad = 5.912313 * kRadPerDeg) const {
        const Eigen::Vector3d v = lattice_.centre_of(key) - beam_.p_map_sensor;
        const double along = v.dot(beam_.direction_map);
        const double aside = v.cross(beam_.direction_map).norm();
        const double core = std::tan(core_rad);
        const double end = *beam_.range_m - 0.05;
        const Verdict verdict =
            all_of({along, 0.5 * config_.map.resolution_m + along * core - aside, end - v.norm()});
        return {verdict.is_in,
                verdict.is_close || std::fabs(0.5 * config_.map.resolution_m + along * core - aside) < 1e-6};
    }
    Verdict is_in_cap(VoxelKey key) const {
        const Eigen::Vector3d v = lattice_.centre_of(key) - beam_.p_map_sensor;
        return all_of({13.5 * kRadPerDeg - angle(key), v.norm() - (*beam_.range_m - 0.05),
                       *beam_.range_m + 0.05 - v.norm()});
    }
    /// A quarter of the way off the axis, half an edge before and behind the range.
    Verdict is_in_middle(VoxelKey key) const {
        const double off_m =
            std::fabs((lattice_.centre_of(key) - beam_.p_map_sensor).norm() - *beam_.range_m);
        return all_of({3.375 * kRadPerDeg - angle(key), 0.5 * config_.map.resolution_m - off_m});
    }
    VoxelKey end() const {
        return *lattice_.key_of(beam_.p_map_sensor + *beam_.range_m * beam_.direction_map);
    }
    double angle(VoxelKey key) const {
        const Eigen::Vector3d v = lattice_.centre_of(key) - beam_.p_map_sensor;
        return std::atan2(v.cross(beam_.direction_map).norm(), v.dot(beam_.direction_map));
    }
    /// Calls visit for each voxel of a cube about the sensor that holds all of the beam.
    template <class Visit>
    void for_each(Visit&& visit) const {
        const double reach = *beam_.range_m + 0.2;
        const VoxelKey low = *lattice_.key_of(beam_.p_map_sensor - Eigen::Vector3d::Constant(reach));
        const VoxelKey high = *lattice_.key_of(beam_.p_map_sensor + Eigen::Vector3d::Constant(reach));
        for (std::uint16_t x = low.x; x <= high.x; ++x) {
            for (std::uint16_t y = low.y; y <= high.y; ++y) {
                for (std::uint16_t z = low.z; z <= high.z; ++z) visit(VoxelKey{x, y, z});
            }
        }
    }

  private:
    MappingConfig config_;
    Beam beam_;
    VoxelLattice lattice_;
};

void expect_as_brute_force(const MappingConfig& config, const Beam& beam) {
    ConeFinder finder(config);
    const auto found = finder.find(beam);
    ASSERT_TRUE(found.has_value());
    const std::set<VoxelKey> passed((*found)->passed.begin(), (*found)->passed.end());
    EXPECT_EQ(passed.size(), (*found)->passed.size()) << "a voxel twice";
    std::map<VoxelKey, float> cap;
    for (const CapVoxel& voxel : (*found)->cap) EXPECT_TRUE(cap.emplace(voxel.key, voxel.weight).second);
    const std::set<VoxelKey> middle((*found)->middle.begin(), (*found)->middle.end());
    EXPECT_EQ(middle.size(), (*found)->middle.size());
    const BruteForce oracle(config, beam);
    std::size_t in_cap = 0;
    std::size_t in_middle = 0;
    oracle.for_each([&](VoxelKey key) {
        const Verdict is_passed = oracle.is_passed(key);
        if (!is_passed.is_close) {
            EXPECT_EQ(passed.contains(key), is_passed.is_in);
        }
        const Verdict is_in_middle = oracle.is_in_middle(key);
        in_middle += is_in_middle.is_in ? 1U : 0U;
        if (!is_in_middle.is_close && is_in_middle.is_in) {
            EXPECT_TRUE(middle.contains(key));
        }
        const Verdict is_in_cap = oracle.is_in_cap(key);
        if (is_in_cap.is_close) return;
        EXPECT_EQ(cap.contains(key), is_in_cap.is_in);
        if (!is_in_cap.is_in) return;
        ++in_cap;
        const double sigmas = oracle.angle(key) / (7.0 * kRadPerDeg);
        EXPECT_NEAR(cap.at(key), std::exp(-0.5 * sigmas * sigmas), 1e-6);
    });
    EXPECT_GT(in_cap, 0U);
    EXPECT_EQ(middle.size(), std::max<std::size_t>(in_middle, 1));
    if (in_middle == 0) {
        EXPECT_TRUE(middle.contains(oracle.end()));
    }
}

TEST(ConeFinder, finds_what_trigonometry_says_of_every_voxel_along_the_axes) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0})
            expect_as_brute_force(config_of(0.04), beam_to(sign * Eigen::Vector3d::Unit(axis), 0.8));
    }
}

TEST(ConeFinder, finds_what_trigonometry_says_of_every_voxel_in_any_direction) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 20; ++i) {
        const Eigen::Vector3d direction(normal(random), normal(random), normal(random));
        SCOPED_TRACE(direction.transpose());
        expect_as_brute_force(config_of(0.04), beam_to(direction, 0.2 + 0.03 * i));
        expect_as_brute_force(config_of(0.1), beam_to(direction, 0.6 + 0.01 * i));
    }
}

TEST(ConeFinder, frees_no_more_than_34_degrees_off_the_axis_of_a_cone_that_is_wider) {
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    for (const double half_deg : {30.0, 34.0, 36.0, 45.0, 89.0}) {
        for (int i = 0; i < 3; ++i) {
            Beam beam = beam_to({normal(random), normal(random), normal(random)}, 0.7);
            beam.optics = {.half_angle_rad = half_deg * kRadPerDeg, .sigma_rad = 2.0};
            ConeFinder finder(config_of(0.04));
            const auto found = finder.find(beam);
            ASSERT_TRUE(found.has_value());
            const std::set<VoxelKey> passed((*found)->passed.begin(), (*found)->passed.end());
            const BruteForce oracle(config_of(0.04), beam);
            std::size_t wrong = 0;
            oracle.for_each([&](VoxelKey key) {
                const Verdict verdict = oracle.is_passed(key, std::min(half_deg * kRadPerDeg, 0.6));
                wrong += !verdict.is_close && verdict.is_in != passed.contains(key) ? 1U : 0U;
            });
            EXPECT_EQ(wrong, 0U) << half_deg << " degrees about " << beam.direction_map.transpose();
            EXPECT_GT(passed.size(), 300U);
        }
    }
}

TEST(ConeFinder, frees_space_and_marks_nothing_beyond_the_longest_range_that_marks) {
    ConeFinder finder(config_of(0.04));
    const auto found = finder.find(beam_to(Eigen::Vector3d::UnitX(), 0.901));
    ASSERT_TRUE(found.has_value());
    EXPECT_THAT((*found)->cap, testing::IsEmpty());
    EXPECT_THAT((*found)->middle, testing::IsEmpty());
    EXPECT_GT((*found)->passed.size(), 60U);
}

TEST(ConeFinder, marks_the_ends_own_voxel_where_a_cap_holds_no_centre) {
    MappingConfig config = config_of(0.4);
    config.cone.cap_half_thickness_m = 0.001;
    config.cone.cap_sigmas = 0.0;
    ConeFinder finder(config);
    const auto found = finder.find(beam_to(Eigen::Vector3d::UnitX(), 0.3));
    ASSERT_TRUE(found.has_value());
    const VoxelKey end = *VoxelLattice(0.4).key_of(Eigen::Vector3d(0.813, -0.247, 0.391));
    EXPECT_THAT((*found)->cap, testing::ElementsAre(CapVoxel{end, 1.0F}));
    EXPECT_THAT((*found)->middle, testing::ElementsAre(end));
}

TEST(ConeFinder, cap_reaches_as_far_off_the_axis_as_it_is_told) {
    MappingConfig config = config_of(0.04);
    const Beam beam = beam_to({0.3, -0.8, 0.5}, 0.8);
    const BruteForce oracle(config, beam);
    std::size_t all = 0;
    std::set<VoxelKey> expected;
    ConeFinder whole(config);
    for (const CapVoxel& voxel : (*whole.find(beam))->cap) {
        ++all;
        if (oracle.angle(voxel.key) <= 0.5 * 13.5 * kRadPerDeg) expected.insert(voxel.key);
    }
    config.cone.cap_angle_share = 0.5;
    ConeFinder finder(config);
    std::set<VoxelKey> found;
    for (const CapVoxel& voxel : (*finder.find(beam))->cap) found.insert(voxel.key);
    EXPECT_EQ(found, expected);
    EXPECT_GT(found.size(), 5U);
    EXPECT_LT(found.size(), all);
}

TEST(ConeFinder, finds_a_zones_voxels_by_the_parameters_of_zones) {
    MappingConfig config = config_of(0.04);
    config.zone = {.hit_range_max_m = 0.7, .cap_half_thickness_m = 0.02, .core_weight_min = 0.9};
    MappingConfig swapped = config;
    std::swap(swapped.cone, swapped.zone);
    ConeFinder finder(config);
    ConeFinder other(swapped);
    for (const double range_m : {0.5, 0.8}) {
        Beam beam = beam_to({0.3, -0.8, 0.5}, range_m);
        const ConeVoxels as_cone = **finder.find(beam);
        beam.optics.is_zone = true;
        const ConeVoxels as_zone = **finder.find(beam);
        EXPECT_EQ(as_zone.cap.empty(), range_m > 0.7);
        EXPECT_LT(as_zone.passed.size(), as_cone.passed.size());
        EXPECT_EQ((*other.find(beam))->passed, as_cone.passed);
        EXPECT_EQ((*other.find(beam))->cap, as_cone.cap);
    }
}

TEST(ConeFinder, clears_without_return_only_as_far_as_it_may_and_never_marks) {
    MappingConfig config = config_of(0.04);
    Beam beam = beam_to(Eigen::Vector3d::UnitX(), std::nullopt);
    beam.clear_limit_m = 0.5;
    ConeFinder never(config);
    EXPECT_THAT((*never.find(beam))->passed, testing::IsEmpty());
    config.no_return_clear_m = 2.0;
    ConeFinder finder(config);
    const auto found = finder.find(beam);
    EXPECT_THAT((*found)->cap, testing::IsEmpty());
    EXPECT_THAT((*found)->passed,
                testing::Contains(*VoxelLattice(0.04).key_of(Eigen::Vector3d(0.513 + 0.46, -0.247, 0.391))));
    for (const VoxelKey key : (*found)->passed)
        EXPECT_LT((VoxelLattice(0.04).centre_of(key) - beam.p_map_sensor).norm(), 0.5);
}

TEST(ConeFinder, names_why_a_beam_is_refused) {
    ConeFinder finder(config_of(0.04));
    Beam beam = beam_to(Eigen::Vector3d::UnitX(), 0.5);
    beam.p_map_sensor.x() = 1.0e4;
    EXPECT_EQ(finder.find(beam).error(), BeamRejection::outside_map);
    beam.p_map_sensor.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(finder.find(beam).error(), BeamRejection::origin_not_finite);
}

}  // namespace
}  // namespace octoskin
