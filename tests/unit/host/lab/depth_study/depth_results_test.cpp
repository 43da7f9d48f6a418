// The tables and the JSON of a depth study.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "host/lab/depth_study/depth_study.hpp"

namespace octoskin::depth_study {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;

Subject subject(const std::string& noise, std::uint64_t seed, const std::string& label = "fast") {
    return {.scenario = "plate",
            .noise = noise,
            .configuration = "fast",
            .sigma_factor = 1.0,
            .label = label,
            .seed = seed};
}

SeenFigures seen(const Subject& of, double precision, double free) {
    SeenFigures figures{.subject = of, .t_s = 0.5, .seen = {}, .free = {}};
    figures.seen.precision = precision;
    figures.seen.seen_free = free;
    evaluation::SeenShares& boards =
        figures.seen.by_class[static_cast<std::size_t>(evaluation::ThicknessClass::board)];
    boards.voxels = 10;
    boards.occupied = of.seed;
    boards.free = 1;
    boards.body_2cm = {.spheres = 40, .free = 3};
    figures.seen.all = boards;
    figures.free.images[2] = {.voxels = 50, .surface = of.seed};
    return figures;
}

HandFigures hand(const Subject& of, std::uint64_t occupied, std::optional<double> leaves_s) {
    return {.subject = of,
            .path = HandPath::sideways,
            .speed_m_per_s = 0.05,
            .appears_s = 0.2,
            .voxels = 10,
            .occupied = occupied,
            .free = 1,
            .leaves_s = leaves_s};
}

DepthResults seen_results() {
    return {.program = "octoskin 1",
            .rig = "small",
            .scene = DepthScene::moving,
            .seen = {seen(subject("0.01", 1), 0.9, 0.1), seen(subject("0.01", 3), 0.8, 0.3),
                     seen(subject("0.01", 1, "fast x2"), 0.7, 0.0), seen(subject("kinect", 1), 0.5, 0.25)},
            .hand = {}};
}

DepthResults hand_results() {
    return {.program = "octoskin 1",
            .rig = "small",
            .scene = DepthScene::hand,
            .seen = {},
            .hand = {hand(subject("0.01", 1), 8, 0.4), hand(subject("0.01", 2), 6, 0.6),
                     hand(subject("0.02", 1), 5, std::nullopt)}};
}

/// The words of each line that begins with the scenario.
std::vector<std::vector<std::string>> rows_of(const std::string& tables) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(tables);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("plate")) continue;
        std::istringstream words(line);
        rows.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
    }
    return rows;
}

TEST(DepthTables, have_means_and_the_worst_seed_by_noise) {
    const auto rows = rows_of(depth_tables(seen_results()));
    ASSERT_EQ(rows.size(), 9U) << "three tables for each noise";
    EXPECT_THAT(rows[0], ElementsAre("plate", "fast", "0.5", "0.850", "(0.800)", "-", "-", "-", "0.200",
                                     "(0.300)", "-", "-", "-", "-"));
    EXPECT_THAT(rows[1], ElementsAre("plate", "fast", "x2", "0.5", "0.700", "(0.700)", "-", "-", "-", "0.000",
                                     "(0.000)", "-", "-", "-", "-"));
    EXPECT_THAT(rows[6], ElementsAre("plate", "fast", "0.5", "0.500", "(0.500)", "-", "-", "-", "0.250",
                                     "(0.250)", "-", "-", "-", "-"));
}

// Occupied: 1 and 3 of 10.
TEST(DepthTables, pool_the_seeds_voxels_of_a_thickness) {
    const auto rows = rows_of(depth_tables(seen_results()));
    ASSERT_EQ(rows.size(), 9U);
    EXPECT_THAT(rows[2], testing::IsSupersetOf({"plate", "fast", "0.5", "0.200", "0.100"}));
    EXPECT_EQ(std::ranges::count(rows[2], "-"), static_cast<std::ptrdiff_t>(evaluation::kThicknessClasses));
}

// 1 and 3 surface voxels of 50 each.
TEST(DepthTables, have_the_surface_share_of_free_voxels_by_images) {
    const auto rows = rows_of(depth_tables(seen_results()));
    ASSERT_EQ(rows.size(), 9U);
    EXPECT_THAT(rows[4], ElementsAre("plate", "fast", "0.5", "0.0400", "(100)"));
    EXPECT_THAT(rows[8], ElementsAre("plate", "fast", "0.5", "0.0200", "(50)"));
}

TEST(DepthTables, have_a_hands_times_and_that_it_never_left) {
    const auto rows = rows_of(depth_tables(hand_results()));
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_THAT(rows[0], ElementsAre("plate", "fast", "sideways", "0.05", "0.700", "(0.600)", "0.100",
                                     "(0.100)", "0.20", "(0.20)", "0.50", "(0.60)"));
    EXPECT_THAT(rows[1], ElementsAre("plate", "fast", "sideways", "0.05", "0.500", "(0.500)", "0.100",
                                     "(0.100)", "0.20", "(0.20)", "-", "(never)"));
}

TEST(DepthJson, has_each_seeds_figures) {
    const Json json = Json::parse(depth_json(seen_results()));
    EXPECT_EQ(json.at("program"), "octoskin 1");
    EXPECT_EQ(json.at("rig"), "small");
    EXPECT_EQ(json.at("scene"), "moving");
    ASSERT_EQ(json.at("figures").size(), 4U);
    const Json& second = json.at("figures").at(1);
    EXPECT_EQ(second.at("scenario"), "plate");
    EXPECT_EQ(second.at("noise"), "0.01");
    EXPECT_EQ(second.at("configuration"), "fast");
    EXPECT_EQ(second.at("sigma_factor"), 1.0);
    EXPECT_EQ(second.at("seed"), 3);
    EXPECT_EQ(second.at("t_s"), 0.5);
    EXPECT_EQ(second.at("precision"), 0.8);
    EXPECT_EQ(second.at("seen_free"), 0.3);
    EXPECT_TRUE(second.at("availability").is_null());
    EXPECT_EQ(second.at("thickness").size(), evaluation::kThicknessClasses + 1);
    for (const Json& shares : {second.at("all"), second.at("thickness").at("board")}) {
        EXPECT_EQ(shares.at("voxels"), 10);
        EXPECT_EQ(shares.at("occupied"), 3);
        EXPECT_EQ(shares.at("body_2cm"), (Json{{"spheres", 40}, {"free", 3}}));
    }
    EXPECT_EQ(second.at("thickness").at("too_coarse").at("voxels"), 0);
}

TEST(DepthJson, has_a_hands_figures) {
    const Json json = Json::parse(depth_json(hand_results()));
    EXPECT_EQ(json.at("scene"), "hand");
    ASSERT_EQ(json.at("figures").size(), 3U);
    EXPECT_EQ(json.at("figures").at(2), (Json{{"scenario", "plate"},
                                              {"noise", "0.02"},
                                              {"configuration", "fast"},
                                              {"sigma_factor", 1.0},
                                              {"seed", 1},
                                              {"path", "sideways"},
                                              {"speed_m_per_s", 0.05},
                                              {"voxels", 10},
                                              {"occupied", 5},
                                              {"free", 1},
                                              {"appears_s", 0.2},
                                              {"leaves_s", nullptr}}));
}

TEST(DepthJson, is_json_whatever_a_name_holds) {
    DepthResults results = seen_results();
    results.rig = "\xff";
    EXPECT_FALSE(Json::parse(depth_json(results), nullptr, false).is_discarded());
}

}  // namespace
}  // namespace octoskin::depth_study
