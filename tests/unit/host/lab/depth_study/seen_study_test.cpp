#include "host/lab/depth_study/seen_study.hpp"

#include <gmock/gmock.h>

#include <set>
#include <span>
#include <tuple>

#include "host/lab/depth_study/depth_study.hpp"
#include "tests/unit/host/lab/depth_study/plate_case.hpp"

namespace octoskin::depth_study {
namespace {

using testing::ElementsAre;

std::vector<SeenFigures> stationary(const PlateCase& plate, std::uint64_t seed,
                                    const std::vector<double>& times_s) {
    auto figures = study_stationary(plate.of_seed(seed), times_s);
    EXPECT_TRUE(figures) << figures.error().message();
    return std::move(*figures);
}

/// All of them, as text.
std::string text_of(const std::vector<SeenFigures>& figures) {
    return depth_json({.program = "", .rig = "", .seen = figures, .hand = {}});
}

using TimeOf = std::tuple<double, std::string>;
std::vector<TimeOf> rows_of(const std::vector<SeenFigures>& figures) {
    std::vector<TimeOf> rows;
    for (const SeenFigures& row : figures) rows.emplace_back(row.t_s, row.subject.label);
    return rows;
}

TEST(SeenStudy, judges_every_contender_at_every_time) {
    const PlateCase plate(*named_noise("0.02"),
                          contenders({"denoised", "paper"}, *named_noise("0.02"), {1.0, 2.0}));
    // 0.24 s: the first image at or after it. A time that names the same image comes once.
    const auto figures = stationary(plate, 7, {0.3, 0.0, 0.24, 0.3});
    EXPECT_THAT(rows_of(figures),
                ElementsAre(TimeOf(0.0, "denoised"), TimeOf(0.0, "denoised x2"), TimeOf(0.0, "paper"),
                            TimeOf(0.3, "denoised"), TimeOf(0.3, "denoised x2"), TimeOf(0.3, "paper")));
    for (const SeenFigures& row : figures) {
        EXPECT_EQ(row.subject.scenario, "plate");
        EXPECT_EQ(row.subject.noise, "0.02");
        EXPECT_EQ(row.subject.seed, 7U);
        EXPECT_EQ(row.subject.sigma_factor, row.subject.label == "denoised x2" ? 2.0 : 1.0);
        EXPECT_EQ(row.seen.all.voxels, 100U) << "the plate's front";
        EXPECT_EQ(row.seen.all.occupied + row.seen.all.free + row.seen.all.unknown, 100U);
    }
}

TEST(SeenStudy, has_the_same_figures_for_the_same_seed) {
    const PlateCase plate(*named_noise("0.03"), contenders({"denoised", "fast"}, *named_noise("0.03")));
    const std::string figures = text_of(stationary(plate, 1, {0.2}));
    EXPECT_EQ(text_of(stationary(plate, 1, {0.2})), figures);
    auto others = stationary(plate, 2, {0.2});
    for (SeenFigures& row : others) row.subject.seed = 1;
    EXPECT_NE(text_of(others), figures);
}

TEST(SeenStudy, finds_no_fault_in_an_image_without_noise) {
    const PlateCase plate(no_noise(), contenders({"denoised", "paper"}, no_noise()));
    for (const SeenFigures& row : stationary(plate, 0, {0.5})) {
        SCOPED_TRACE(row.subject.label);
        EXPECT_EQ(row.seen.f1_seen, 1.0);
        EXPECT_EQ(row.seen.precision, 1.0);
        EXPECT_EQ(row.seen.seen_free, 0.0);
        EXPECT_EQ(row.seen.body_2cm, 0.0);
        EXPECT_GT(row.seen.clear_spheres, 1'000U);
        EXPECT_GT(row.seen.availability_5cm, 0.99);
        EXPECT_LT(row.seen.f1_noise_free, 1.0) << "the back of the plate is surface, too";
    }
}

TEST(SeenStudy, tells_contenders_apart) {
    const NamedNoise noise = *named_noise("0.03");
    const PlateCase plate(noise, contenders({"denoised", "fast", "paper"}, noise, {1.0, 0.3}));
    const auto figures = stationary(plate, 0, {0.0, 1.0});
    ASSERT_EQ(figures.size(), 10U);
    std::set<std::string> texts;
    for (SeenFigures row : std::span(figures).first(5)) {
        row.subject = {};
        texts.insert(text_of({row}));
    }
    EXPECT_EQ(texts.size(), 5U) << "of the first image";
    EXPECT_GT(figures[5].seen.f1_seen, 0.95) << "denoised, the mean of eleven images";
    EXPECT_LT(figures[9].seen.f1_seen, 0.85) << "paper: an edge of a voxel is four thirds of a deviation";
}

TEST(SeenStudy, judges_a_moving_camera_at_its_first_and_its_last_image) {
    const PlateCase plate(no_noise(), contenders({"denoised", "paper"}, no_noise()));
    const auto figures = study_moving(plate.of_seed(0), 0.4);
    ASSERT_TRUE(figures) << figures.error().message();
    EXPECT_THAT(rows_of(*figures), ElementsAre(TimeOf(0.0, "denoised"), TimeOf(0.0, "paper"),
                                               TimeOf(0.4, "denoised"), TimeOf(0.4, "paper")));
    for (const SeenFigures& row : *figures) {
        EXPECT_GE(row.seen.all.voxels, 100U) << "from its circle the camera sees sides, too";
        EXPECT_GT(row.seen.seen_occupied, 0.8);
        EXPECT_EQ(row.seen.precision, 1.0) << row.subject.label;
    }
}

TEST(SeenStudy, refuses_a_region_without_voxels) {
    const PlateCase plate(no_noise(), contenders({"paper"}, no_noise()));
    DepthCase of = plate.of_seed(0);
    sim::Scenario scenario = plate_scenario();
    scenario.region.p_base_max = scenario.region.p_base_min;
    const DepthCase without{.world = of.world,
                            .scenario = scenario,
                            .camera = of.camera,
                            .T_map_base = of.T_map_base,
                            .noise = of.noise,
                            .seed = 0,
                            .contenders = of.contenders};
    const auto refused = study_stationary(without, {0.0});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::bad_config);
}

}  // namespace
}  // namespace octoskin::depth_study
