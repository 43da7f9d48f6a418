#include "host/core/mapping/ray_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace octoskin {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint16_t kZero = 32768;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Along x through the middle of voxels of 4 cm.
Beam beam_along_x(std::optional<double> range_m, double clear_limit_m = 0.0) {
    Beam beam;
    beam.p_map_sensor = {0.02, 0.02, 0.02};
    beam.direction_map = Eigen::Vector3d::UnitX();
    beam.range_m = range_m;
    beam.clear_limit_m = clear_limit_m;
    return beam;
}

VoxelUpdate update_at(int x, float log_odds) {
    return {{static_cast<std::uint16_t>(kZero + x), kZero, kZero}, log_odds};
}

/// In the order of the ray.
std::vector<VoxelUpdate> terms_of(const Result<const RayEvidence*, BeamRejection>& evidence) {
    EXPECT_EQ((*evidence)->terms.rule, EvidenceRule::terms);
    EXPECT_EQ((*evidence)->terms.sensor, SensorKind::range);
    std::vector<VoxelUpdate> terms;
    for_each_term((*evidence)->terms, [&](const VoxelUpdate& term) { terms.push_back(term); });
    return terms;
}

TEST(RayModel, misses_what_it_passes_and_hits_its_endpoint_last) {
    RayModel model(paper_mapping());
    const auto evidence = model.find(beam_along_x(0.12));
    ASSERT_TRUE(evidence.has_value());
    EXPECT_THAT(terms_of(evidence), ElementsAre(update_at(0, -0.4F), update_at(1, -0.4F), update_at(2, -0.4F),
                                                update_at(3, 0.9916F)));
}

std::vector<VoxelUpdate> weakened_by(const Result<const RayEvidence*, BeamRejection>& evidence) {
    EXPECT_EQ((*evidence)->weakened.rule, EvidenceRule::weaken);
    EXPECT_EQ((*evidence)->weakened.sensor, SensorKind::range);
    std::vector<VoxelUpdate> weakened;
    for_each_term((*evidence)->weakened, [&](const VoxelUpdate& term) { weakened.push_back(term); });
    return weakened;
}

TEST(RayModel, only_weakens_where_its_surface_may_be) {
    MappingConfig config = paper_mapping();
    config.ray_end_sigmas = 2.0;
    RayModel model(config);
    // The end is at 0.22 m. The voxels of 4 cm end at 0.04, 0.08 m ...: the third at 0.12 m.
    Beam beam = beam_along_x(0.2);
    const auto misses_at = [](std::initializer_list<int> voxels) {
        std::vector<VoxelUpdate> misses;
        for (const int x : voxels) misses.push_back(update_at(x, -0.4F));
        return misses;
    };
    struct Case {
        double sigma_m;
        std::vector<VoxelUpdate> passed;
        std::vector<VoxelUpdate> weakened;
    };
    for (const Case& c :
         {Case{0.0, misses_at({0, 1, 2, 3, 4}), {}}, Case{0.0099, misses_at({0, 1, 2, 3, 4}), {}},
          Case{0.0101, misses_at({0, 1, 2, 3}), misses_at({4})},
          Case{0.0501, misses_at({0, 1}), misses_at({2, 3, 4})}, Case{0.5, {}, misses_at({0, 1, 2, 3, 4})}}) {
        SCOPED_TRACE(c.sigma_m);
        beam.sigma_m = c.sigma_m;
        const auto evidence = model.find(beam);
        ASSERT_TRUE(evidence.has_value());
        std::vector<VoxelUpdate> terms = c.passed;
        terms.push_back(update_at(5, 0.986F));
        EXPECT_EQ(terms_of(evidence), terms);
        EXPECT_EQ(weakened_by(evidence), c.weakened);
    }
    beam.range_m.reset();
    beam.clear_limit_m = 0.12;
    config.no_return_clear_m = 1.0;
    RayModel clearing(config);
    const auto without_end = clearing.find(beam);
    ASSERT_TRUE(without_end.has_value());
    EXPECT_EQ(terms_of(without_end), misses_at({0, 1, 2}));
    EXPECT_THAT(weakened_by(without_end), IsEmpty());
}

TEST(RayModel, leaves_out_a_hit_of_zero_but_not_the_misses_before_it) {
    MappingConfig config = paper_mapping();
    config.model.proximity.range_min_m = 0.2;
    RayModel model(config);
    const auto evidence = model.find(beam_along_x(0.08));
    ASSERT_TRUE(evidence.has_value());
    EXPECT_THAT(terms_of(evidence), ElementsAre(update_at(0, -0.4F), update_at(1, -0.4F)));
}

TEST(RayModel, hits_only_if_sensor_and_endpoint_share_a_voxel) {
    MappingConfig config = paper_mapping();
    config.map.resolution_m = 0.4;
    RayModel model(config);
    const auto evidence = model.find(beam_along_x(0.1));
    ASSERT_TRUE(evidence.has_value());
    EXPECT_THAT(terms_of(evidence), ElementsAre(update_at(0, 0.993F)));
}

TEST(RayModel, leaves_the_map_alone_without_return_by_default) {
    for (const MappingConfig& config : {paper_mapping(), robust_mapping()}) {
        RayModel model(config);
        const auto evidence = model.find(beam_along_x(std::nullopt, 1.0));
        ASSERT_TRUE(evidence.has_value());
        EXPECT_THAT(terms_of(evidence), IsEmpty());
    }
}

TEST(RayModel, clears_without_return_up_to_the_smaller_limit_and_never_marks) {
    MappingConfig config = paper_mapping();
    config.no_return_clear_m = 0.12;
    RayModel model(config);
    const auto by_config = model.find(beam_along_x(std::nullopt, 4.0));
    ASSERT_TRUE(by_config.has_value());
    EXPECT_THAT(terms_of(by_config),
                ElementsAre(update_at(0, -0.4F), update_at(1, -0.4F), update_at(2, -0.4F)));
    const auto by_beam = model.find(beam_along_x(std::nullopt, 0.08));
    ASSERT_TRUE(by_beam.has_value());
    EXPECT_THAT(terms_of(by_beam), ElementsAre(update_at(0, -0.4F), update_at(1, -0.4F)));
    const auto not_at_all = model.find(beam_along_x(std::nullopt, 0.0));
    ASSERT_TRUE(not_at_all.has_value());
    EXPECT_THAT(terms_of(not_at_all), IsEmpty());
}

TEST(RayModel, names_why_a_beam_is_refused) {
    MappingConfig config = paper_mapping();
    config.no_return_clear_m = 1.0;
    RayModel model(config);
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
        Beam beam = beam_along_x(1.0);
        beam.p_map_sensor.y() = bad;
        EXPECT_EQ(model.find(beam).error(), BeamRejection::origin_not_finite);
        beam = beam_along_x(1.0);
        beam.direction_map.z() = bad;
        EXPECT_EQ(model.find(beam).error(), BeamRejection::direction_not_unit);
        EXPECT_EQ(model.find(beam_along_x(bad)).error(), BeamRejection::range_not_valid);
        EXPECT_EQ(model.find(beam_along_x(std::nullopt, bad)).error(), BeamRejection::limit_not_valid);
    }
    EXPECT_EQ(model.find(beam_along_x(-0.001)).error(), BeamRejection::range_not_valid);
    EXPECT_EQ(model.find(beam_along_x(std::nullopt, -0.001)).error(), BeamRejection::limit_not_valid);
    EXPECT_EQ(model.find(beam_along_x(1e6)).error(), BeamRejection::outside_map);
    EXPECT_EQ(model.find(beam_along_x(1e300)).error(), BeamRejection::outside_map);
    Beam beam = beam_along_x(1.0);
    beam.direction_map = Eigen::Vector3d::Zero();
    EXPECT_EQ(model.find(beam).error(), BeamRejection::direction_not_unit);
    beam.direction_map = Eigen::Vector3d::UnitX() * 1.00001;
    EXPECT_EQ(model.find(beam).error(), BeamRejection::direction_not_unit);
    beam.direction_map = Eigen::Vector3d::UnitX() * 1.0000001;
    EXPECT_TRUE(model.find(beam).has_value());
    beam = beam_along_x(1.0);
    beam.p_map_sensor.x() = -2000.0;
    EXPECT_EQ(model.find(beam).error(), BeamRejection::outside_map);
}

}  // namespace
}  // namespace octoskin
