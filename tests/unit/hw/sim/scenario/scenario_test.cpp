// The scenario file: the experiment's numbers, and what each kind of mistake is told. Oracle: the numbers of
// the experiment's description, typed in again here.
#include "hw/sim/scenario/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <variant>

#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

const std::filesystem::path kExperiment =
    std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/worlds/experiment.scenario.yaml";

/// The experiment with some keys laid over it.
class ScenarioFile : public testing::Test {
  protected:
    Result<Scenario, Error> read_with(const std::string& overlay) {
        std::ofstream(file_) << "extends: " << kExperiment.string() << "\n" << overlay << "\n";
        return read_scenario(file_);
    }
    Error error_of(const std::string& overlay) {
        const auto scenario = read_with(overlay);
        EXPECT_FALSE(scenario) << overlay << " was accepted";
        const Error error = error_in(scenario);
        EXPECT_TRUE(has_its_fields(error)) << overlay;
        EXPECT_TRUE(error.file == file_ || error.file == kExperiment) << error.file;
        return error;
    }

    const testing_support::ScratchFolder scratch_;
    const std::filesystem::path file_ = scratch_ / "changed.yaml";
};

TEST_F(ScenarioFile, of_the_experiment_says_what_the_experiment_is) {
    const auto scenario = read_scenario(kExperiment);
    ASSERT_TRUE(scenario) << scenario.error().message();
    EXPECT_EQ(scenario->name, "experiment");
    EXPECT_EQ(scenario->world, std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/worlds/experiment.sdf");
    EXPECT_EQ(scenario->rest_s, 3.0);
    EXPECT_EQ(scenario->motion.link, "panda_link8");
    EXPECT_EQ(scenario->motion.ticks(), 300u);
    EXPECT_EQ(scenario->motion.tick_rate_hz, 30.0);
    const Eigen::Isometry3d quarter = scenario->motion.T_base_link(75);
    EXPECT_NEAR((quarter.translation() - Eigen::Vector3d(0.45, 0.0, 0.75)).norm(), 0.0, 1e-15);
    EXPECT_EQ(Eigen::Matrix3d(quarter.linear()), Eigen::Matrix3d(Eigen::Vector3d(1, -1, -1).asDiagonal()));
    EXPECT_EQ(scenario->motion.start_position.size(), 7);
    EXPECT_EQ(scenario->motion.start_position[3], -2.356);
    EXPECT_EQ(std::get<GaussianNoise>(scenario->depth_noise.model).sigma_m, 0.03);
    EXPECT_EQ(scenario->ranges.sigma_m, 0.02);
    EXPECT_EQ(scenario->ranges.min_m, 0.04);
    EXPECT_EQ(scenario->ranges.max_m, 4.0);
    EXPECT_EQ(scenario->slow_clocks.factor_min, 1.04);
    EXPECT_EQ(scenario->slow_clocks.factor_max, 1.09);
    EXPECT_THAT(scenario->hidden_models, testing::ElementsAre("cone", "crate"));
    EXPECT_EQ(scenario->region.p_base_max, Eigen::Vector3d(1.4, 1.2, 1.4));
    EXPECT_EQ(scenario->region.floor_top_m, -0.02);
}

TEST_F(ScenarioFile, shifts_the_map_by_the_listed_seeds_and_by_a_draw_for_others) {
    const auto scenario = read_scenario(kExperiment);
    ASSERT_TRUE(scenario);
    EXPECT_EQ(scenario->map_shift_m(0), Eigen::Vector3d(0.002990, 0.020829, 0.001814));
    EXPECT_EQ(scenario->map_shift_m(4), Eigen::Vector3d(0.018570, 0.037851, 0.036570));
    for (std::uint64_t seed = 5; seed < 200; ++seed) {
        const Eigen::Vector3d shift = scenario->map_shift_m(seed);
        EXPECT_EQ(shift, scenario->map_shift_m(seed));
        EXPECT_NE(shift, scenario->map_shift_m(seed + 1));
        EXPECT_GE(shift.minCoeff(), 0.0);
        EXPECT_LT(shift.maxCoeff(), 0.04);
    }
}

TEST_F(ScenarioFile, takes_other_values_laid_over_it) {
    const auto scenario =
        read_with("depth: {sigma_m: 0}\nregion: {floor_top_m: null}\nmotion: {circle: {revolutions: 2}}");
    ASSERT_TRUE(scenario) << scenario.error().message();
    EXPECT_EQ(std::get<GaussianNoise>(scenario->depth_noise.model).sigma_m, 0.0);
    EXPECT_FALSE(scenario->region.floor_top_m);
    EXPECT_EQ(scenario->motion.ticks(), 600u);
    const auto even = read_with("slow_clocks: {factor_min: 1.075, factor_max: 1.075}");
    ASSERT_TRUE(even) << even.error().message();
    EXPECT_EQ(even->slow_clocks.factor_min, 1.075);
    EXPECT_EQ(even->slow_clocks.factor_max, 1.075);
    EXPECT_EQ(even->ranges.reflectivity, 0.5);
    const auto dark = read_with("ranges: {reflectivity: 0.17}");
    ASSERT_TRUE(dark) << dark.error().message();
    EXPECT_EQ(dark->ranges.reflectivity, 0.17);
}

TEST_F(ScenarioFile, says_how_sensors_are_that_nothing_is_wrong_with) {
    const auto scenario = read_with(
        "sensor_traits:\n  - {register: 0x47, reads: 0x0c}\n"
        "  - {node_id: 2, sensor: 16, register: 0x7C, reads: 1, mask: 1}\n"
        "  - {range_spread_us: 1000, range_step_us: 300, boot_load_us: 3000}");
    ASSERT_TRUE(scenario) << scenario.error().message();
    const std::vector<TraitsOf> expected{
        {.traits = {.misread = {{.index = 0x47, .value = 12}}}},
        {.node_id = 2, .sensor = 16, .traits = {.misread = {{.index = 0x7C, .value = 1, .mask = 1}}}},
        {.traits = {.range_spread = Microseconds{1'000},
                    .range_step = Microseconds{300},
                    .boot_load = Microseconds{3'000}}}};
    EXPECT_EQ(scenario->sensor_traits, expected);
    EXPECT_TRUE(read_with("name: plain")->sensor_traits.empty());
    EXPECT_THAT(error_of("sensor_traits: [{reads: 3}]"),
                AllOf(code_is(ErrorCode::missing_key), key_is("sensor_traits[0].reads")));
    EXPECT_THAT(error_of("sensor_traits: [{register: 0x47}]"),
                AllOf(code_is(ErrorCode::missing_key), key_is("sensor_traits[0].reads")));
    EXPECT_THAT(error_of("sensor_traits: [{register: 0x200, reads: 1}]"),
                AllOf(code_is(ErrorCode::out_of_range), key_is("sensor_traits[0].register")));
    EXPECT_THAT(error_of("sensor_traits: [{sensor: 34}]"),
                AllOf(code_is(ErrorCode::out_of_range), key_is("sensor_traits[0].sensor"), value_is("'34'")));
    EXPECT_THAT(error_of("sensor_traits: [{}, {range_spread_us: 20001}]"),
                AllOf(code_is(ErrorCode::out_of_range), key_is("sensor_traits[1].range_spread_us")));
}

TEST_F(ScenarioFile, takes_the_noise_of_a_kinect_with_its_defaults_or_other_numbers) {
    const auto plain = read_with("depth: {noise: kinect, sigma_m: null}");
    ASSERT_TRUE(plain) << plain.error().message();
    const auto& published = std::get<KinectNoise>(plain->depth_noise.model);
    EXPECT_EQ(published.sigma_min_m, 0.0012);
    EXPECT_EQ(published.sigma_min_at_m, 0.4);
    EXPECT_EQ(published.sigma_growth_per_m, 0.0019);
    EXPECT_EQ(published.bias_growth_per_m, 0.0015);
    EXPECT_EQ(published.bias_spacing_px, 16u);
    EXPECT_EQ(published.disparity_step_px, 0.125);
    EXPECT_EQ(published.baseline_m, 0.075);
    EXPECT_EQ(published.focal_px, 580.0);
    EXPECT_EQ(published.edge_step_m, 0.05);
    EXPECT_EQ(published.flying_share, 0.3);
    EXPECT_EQ(published.missing_share, 0.3);
    const auto other = read_with(
        "depth:\n  noise: kinect\n  kinect: {sigma_min_m: 0.01, sigma_min_at_m: 0.02, sigma_growth_per_m: "
        "0.03,"
        " bias_growth_per_m: 0.04, bias_spacing_px: 5, disparity_step_px: 6, baseline_m: 7, focal_px: 8,"
        " edge_step_m: 9, flying_share: 0.1, missing_share: 0.9}");
    ASSERT_TRUE(other) << other.error().message();
    const auto& kinect = std::get<KinectNoise>(other->depth_noise.model);
    EXPECT_EQ(kinect.sigma_min_m, 0.01);
    EXPECT_EQ(kinect.sigma_min_at_m, 0.02);
    EXPECT_EQ(kinect.sigma_growth_per_m, 0.03);
    EXPECT_EQ(kinect.bias_growth_per_m, 0.04);
    EXPECT_EQ(kinect.bias_spacing_px, 5u);
    EXPECT_EQ(kinect.disparity_step_px, 6.0);
    EXPECT_EQ(kinect.baseline_m, 7.0);
    EXPECT_EQ(kinect.focal_px, 8.0);
    EXPECT_EQ(kinect.edge_step_m, 9.0);
    EXPECT_EQ(kinect.flying_share, 0.1);
    EXPECT_EQ(kinect.missing_share, 0.9);
}

TEST_F(ScenarioFile, refuses_a_camera_noise_that_contradicts_itself) {
    EXPECT_THAT(error_of("depth: {noise: fractal}"),
                AllOf(code_is(ErrorCode::unknown_word), key_is("depth.noise"), value_is("'fractal'")));
    EXPECT_THAT(error_of("depth: {kinect: {focal_px: 600}}"),
                AllOf(code_is(ErrorCode::conflict), key_is("depth.kinect")));
    EXPECT_THAT(error_of("depth: {noise: kinect, kinect: {flying_share: 0.75, missing_share: 0.26}}"),
                AllOf(code_is(ErrorCode::out_of_range), key_is("depth.kinect.missing_share")));
    EXPECT_THAT(error_of("depth: {noise: gaussian, sigma_m: null}"),
                AllOf(code_is(ErrorCode::missing_key), key_is("depth.sigma_m")));
}

TEST_F(ScenarioFile, with_an_unknown_key_is_refused_with_file_line_and_key) {
    EXPECT_THAT(error_of("depth:\n  sigma_mm: 30"),
                AllOf(code_is(ErrorCode::unknown_key), file_is("changed.yaml"), line_is(3),
                      key_is("depth.sigma_mm"), remedy_is(HasSubstr("sigma_m?"))));
    EXPECT_THAT(error_of("camera: {sigma_m: 0.03}"),
                AllOf(code_is(ErrorCode::unknown_key), key_is("camera")));
}

TEST_F(ScenarioFile, with_a_wrong_value_is_refused_with_what_was_expected) {
    EXPECT_THAT(error_of("depth: {sigma_m: 30}"),
                AllOf(code_is(ErrorCode::out_of_range), key_is("depth.sigma_m"), value_is("'30'")));
    EXPECT_THAT(error_of("depth: {sigma_m: nan}"), key_is("depth.sigma_m"));
    EXPECT_THAT(error_of("motion: {rest_s: 1}"), key_is("motion.rest_s"));
    EXPECT_THAT(error_of("motion: {circle: {towards_start: [0, 2, 0]}}"),
                AllOf(code_is(ErrorCode::out_of_range), key_is("motion.circle.towards_start")));
    EXPECT_THAT(error_of("motion: {circle: {towards_quarter: [0, 1, 0]}}"),
                AllOf(key_is("motion.circle.towards_quarter"), what_is(HasSubstr("right angles"))));
    EXPECT_THAT(error_of("motion: {circle: {towards_quarter: [0, 0, 0.5]}}"),
                AllOf(key_is("motion.circle.towards_quarter"), what_is(HasSubstr("length 1"))));
    EXPECT_THAT(error_of("motion: {circle: {ticks_per_revolution: 0}}"),
                key_is("motion.circle.ticks_per_revolution"));
    EXPECT_THAT(error_of("motion: {circle: {start_position_rad: [0, left]}}"),
                AllOf(code_is(ErrorCode::wrong_type), key_is("motion.circle.start_position_rad[1]"),
                      value_is("'left'")));
    EXPECT_THAT(error_of("ranges: {min_m: 5}"), key_is("ranges.max_m"));
    EXPECT_THAT(error_of("slow_clocks: {factor_min: 2}"), key_is("slow_clocks.factor_min"));
    EXPECT_THAT(error_of("slow_clocks: {factor_min: 1.095}"), key_is("slow_clocks.factor_max"));
    EXPECT_THAT(error_of("region: {max_m: [-1, 1.2, 1.4]}"), key_is("region.max_m"));
    EXPECT_THAT(error_of("seeds: {map_shift_m: [[0, 0]]}"), key_is("seeds.map_shift_m[0]"));
    EXPECT_THAT(error_of("world: no-such.sdf"), AllOf(code_is(ErrorCode::not_found), line_is(2),
                                                      key_is("world"), value_is(HasSubstr("no-such.sdf"))));
    EXPECT_THAT(error_of("world: [a, b]"), key_is("world"));
    EXPECT_THAT(error_of("world: " + std::string(300, 'w')),
                AllOf(code_is(ErrorCode::not_found), file_is("changed.yaml"), line_is(2),
                      value_is(StartsWith("none at "))));
    EXPECT_THAT(error_of("hidden_models: cone"),
                AllOf(code_is(ErrorCode::wrong_type), key_is("hidden_models")));
}

TEST_F(ScenarioFile, knows_where_it_says_what_may_turn_out_wrong_later) {
    const auto scenario = read_with("hidden_models: []\nmotion:\n  circle:\n    link: hand");
    ASSERT_TRUE(scenario) << scenario.error().message();
    const Error fault{ErrorCode::conflict, "x", "1", "y"};
    const auto place_is = [](const char* file, int line, const char* key) {
        return AllOf(code_is(ErrorCode::conflict), file_is(file), line_is(line), key_is(key), what_is("x"),
                     value_is("1"), remedy_is("y"));
    };
    EXPECT_THAT(scenario->error("motion.circle.link", fault),
                place_is("changed.yaml", 5, "motion.circle.link"));
    EXPECT_THAT(scenario->error("hidden_models", fault), place_is("changed.yaml", 2, "hidden_models"));
    for (const char* key : {"region", "motion.circle.start_position_rad"}) {
        const Error error = scenario->error(key, fault);
        EXPECT_GT(error.line, 0);
        EXPECT_THAT(error, place_is("experiment.scenario.yaml", error.line, key));
    }
    EXPECT_THAT(scenario->error("name", fault), place_is("changed.yaml", 0, "name"));
}

TEST_F(ScenarioFile, without_a_required_key_or_that_is_not_there_is_refused) {
    EXPECT_THAT(error_in(read_with("ranges: {sigma_m: null}")),
                AllOf(code_is(ErrorCode::missing_key), key_is("ranges.sigma_m")));
    EXPECT_THAT(error_in(read_with("motion: null")),
                AllOf(code_is(ErrorCode::missing_key), key_is("motion")));
    const auto absent = read_scenario("no-such.scenario.yaml");
    ASSERT_FALSE(absent);
    EXPECT_THAT(absent.error(), AllOf(code_is(ErrorCode::not_found), file_is("no-such.scenario.yaml")));
}

}  // namespace
}  // namespace octoskin::sim
