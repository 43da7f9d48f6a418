#include "host/lab/depth_study/hand_study.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "host/lab/depth_study/depth_study.hpp"
#include "tests/unit/host/lab/depth_study/plate_case.hpp"

namespace octoskin::depth_study {
namespace {

/// Nothing but a wall behind the hand's paths.
std::vector<HandFigures> figures_of(const NamedNoise& noise, const std::vector<std::string>& configurations,
                                    std::uint64_t seed) {
    const sim::World world({evaluation::box("wall", {3.42, -6.0, -6.0}, {3.6, 6.0, 6.0})});
    const sim::Scenario scenario = plate_scenario();
    const rig::Camera camera = small_camera();
    const std::vector<Contender> all = contenders(configurations, noise);
    auto figures = study_hand({.world = world,
                               .scenario = scenario,
                               .camera = camera,
                               .T_map_base = Eigen::Isometry3d::Identity(),
                               .noise = noise,
                               .seed = seed,
                               .contenders = all});
    EXPECT_TRUE(figures) << figures.error().message();
    return std::move(*figures);
}

TEST(HandStudy, has_a_row_for_each_path_speed_and_contender) {
    const auto figures = figures_of(no_noise(), {"denoised", "paper"}, 0);
    std::set<std::tuple<std::string, HandPath, double>> rows;
    for (const HandFigures& row : figures) {
        rows.emplace(row.subject.label, row.path, row.speed_m_per_s);
        EXPECT_GT(row.voxels, 0U);
        EXPECT_LE(row.occupied + row.free, row.voxels);
    }
    EXPECT_EQ(rows.size(), 2U * 2U * kHandSpeeds_m_per_s.size());
    EXPECT_EQ(figures.size(), rows.size());
}

TEST(HandStudy, follows_a_hand_without_noise) {
    HandFigures denoised;  // sums and longest times
    HandFigures paper;
    for (const HandFigures& row : figures_of(no_noise(), {"denoised", "paper"}, 0)) {
        HandFigures& sum = row.subject.label == "paper" ? paper : denoised;
        sum.voxels += row.voxels;
        sum.occupied += row.occupied;
        sum.free += row.free;
        sum.appears_s = std::max(sum.appears_s.value_or(0.0), row.appears_s.value_or(9.0));
        sum.leaves_s = std::max(sum.leaves_s.value_or(0.0), row.leaves_s.value_or(9.0));
    }
    EXPECT_EQ(denoised.appears_s, 0.0);
    EXPECT_LT(denoised.leaves_s, 1.0);
    EXPECT_GT(denoised.occupied, denoised.voxels * 9 / 10);
    EXPECT_GT(paper.appears_s, 0.0);
    EXPECT_GT(paper.leaves_s, 0.0);
    EXPECT_GT(paper.free, denoised.free);
    EXPECT_LT(paper.occupied, denoised.occupied);
}

TEST(HandStudy, has_the_same_figures_for_the_same_seed) {
    const auto text = [](std::uint64_t seed) {
        auto figures = figures_of(*named_noise("0.03"), {"denoised"}, seed);
        for (HandFigures& row : figures) row.subject.seed = 0;
        return depth_json({.program = "", .rig = "", .scene = DepthScene::hand, .seen = {}, .hand = figures});
    };
    const std::string figures = text(1);
    EXPECT_EQ(text(1), figures);
    EXPECT_NE(text(2), figures);
}

}  // namespace
}  // namespace octoskin::depth_study
