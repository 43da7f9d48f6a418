#include "host/lab/evaluation/results.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/host/lab/evaluation/metric_names.hpp"

namespace octoskin::evaluation {
namespace {

/// Inside a test, `Run` is GoogleTest's own.
using Runs = std::vector<Run>;

Run judge(const std::string& configuration, const std::string& map, std::uint64_t seed,
          std::uint64_t missed) {
    Run judged{configuration, map, seed, {}};
    judged.metrics.missed = missed;
    judged.metrics.f1 = 0.25 + 0.25 * static_cast<double>(seed);
    judged.metrics.free_calibration.beams[2] = {.voxels = 50, .surface = 2};
    judged.metrics.calibration[6] = {.count = 4, .probability_sum = 2.6, .occupied_count = 3};
    return judged;
}

Results two_seeds() {
    const Runs runs = {
        judge("robust", "depth", 0, 2000), judge("robust", "fused", 0, 1500),
        judge("robust", "depth", 1, 2200), judge("robust", "fused", 1, 1600),
        judge("paper", "fused", 1, 1100),
    };
    Results results = collect(runs, {{"simulate", 12.5, 14.25}}, {{"world", "experiment.sdf"}});
    results.is_papers_experiment = true;
    return results;
}

TEST(Collect, lists_each_seed_once_in_order) {
    EXPECT_EQ(two_seeds().seeds, (std::vector<std::uint64_t>{0, 1}));
}

TEST(MetricsJson, nests_configuration_map_metric_and_statistic) {
    const auto json = nlohmann::json::parse(metrics_json(two_seeds()));
    const auto& missed = json.at("robust").at("depth").at("missed");
    EXPECT_EQ(missed.at("mean"), 2100.0);
    EXPECT_NEAR(missed.at("sd").get<double>(), 141.4213562373095, 1e-9);
    EXPECT_EQ(missed.at("per_seed"), (nlohmann::json{2000.0, 2200.0}));
    EXPECT_EQ(json.at("robust").at("fused").at("f1").at("mean"), 0.375);
    EXPECT_EQ(json.at("paper").at("fused").at("missed").at("mean"), 1100.0);
}

TEST(MetricsJson, has_every_metric_by_its_full_name_in_every_map) {
    const auto json = nlohmann::json::parse(metrics_json(two_seeds()));
    for (const std::string_view name : kMetricNames) {
        for (const char* map : {"depth", "fused"}) {
            const auto& metric = json.at("robust").at(map).at(name);
            EXPECT_EQ(metric.size(), 3U) << name;
            EXPECT_TRUE(metric.contains("mean") && metric.contains("sd") && metric.contains("per_seed"));
        }
    }
}

TEST(MetricsJson, writes_null_for_what_is_undefined) {
    const auto json = nlohmann::json::parse(metrics_json(two_seeds()));
    EXPECT_TRUE(json.at("robust").at("fused").at("precision").at("mean").is_null());
    EXPECT_TRUE(json.at("paper").at("fused").at("missed").at("sd").is_null()) << "one seed has no spread";
}

TEST(MetricsJson, keeps_everything_else_under_one_reserved_key) {
    const auto json = nlohmann::json::parse(metrics_json(two_seeds()));
    EXPECT_EQ(json.size(), 3U);  // robust, paper, run
    const auto& rest = json.at("run");
    EXPECT_EQ(rest.at("seeds"), (nlohmann::json{0, 1}));
    const auto& paired = rest.at("paired").at("robust/fused - robust/depth");
    EXPECT_EQ(paired.at("seeds"), (nlohmann::json{0, 1}));
    EXPECT_EQ(paired.at("metrics").at("missed").at("per_seed"), (nlohmann::json{-500.0, -600.0}));
    EXPECT_EQ(rest.at("times").at(0).at("part"), "simulate");
    EXPECT_EQ(rest.at("times").at(0).at("wall_s"), 12.5);
    EXPECT_EQ(rest.at("times").at(0).at("cpu_s"), 14.25);
    EXPECT_EQ(rest.at("provenance").at("world"), "experiment.sdf");
}

TEST(MetricsJson, tabulates_the_calibration_pooled_over_seeds) {
    const auto json = nlohmann::json::parse(metrics_json(two_seeds()));
    const auto& bins = json.at("run").at("calibration").at("robust").at("depth");
    ASSERT_EQ(bins.size(), 10U);
    EXPECT_EQ(bins.at(6).at("from"), 0.6);
    EXPECT_EQ(bins.at(6).at("to"), 0.7);
    EXPECT_EQ(bins.at(6).at("count"), 8);
    EXPECT_NEAR(bins.at(6).at("mean_predicted").get<double>(), 0.65, 1e-12);
    EXPECT_NEAR(bins.at(6).at("observed_fraction").get<double>(), 0.75, 1e-12);
    EXPECT_TRUE(bins.at(0).at("mean_predicted").is_null());
}

TEST(MetricsJson, tabulates_free_voxels_by_evidence_pooled_over_seeds) {
    const auto json = nlohmann::json::parse(metrics_json(two_seeds()));
    const auto& free = json.at("run").at("free_calibration").at("robust").at("depth");
    ASSERT_EQ(free.at("beams").size(), kFreeBins);
    EXPECT_EQ(free.at("beams").at(2), (nlohmann::json{{"voxels", 100}, {"surface", 4}}));
    EXPECT_EQ(free.at("images").at(2).at("voxels"), 0);
    EXPECT_EQ(free.at("sum").size(), kFreeBins);
}

TEST(MetricsTable, has_a_row_for_free_voxels_with_evidence_only) {
    const std::string text = metrics_table(two_seeds());
    EXPECT_NE(text.find("beams 2"), std::string::npos);
    EXPECT_NE(text.find("0.040 (100)"), std::string::npos);
    EXPECT_EQ(text.find("beams 1"), std::string::npos);
}

/// Two seeds of one map; in each the camera sees ten voxels of a cable and one that is too coarse.
Results with_a_cable() {
    Runs runs = {judge("fast", "depth", 0, 10), judge("fast", "depth", 1, 20)};
    for (Run& run : runs) {
        SeenMetrics& seen = run.metrics.seen.emplace();
        seen.by_class[0] = {.voxels = 10,
                            .occupied = 1,
                            .free = 7,
                            .unknown = 2,
                            .body_2cm = {.spheres = 40, .free = 30},
                            .body_5cm = {.spheres = 40, .free = 11}};
        seen.too_coarse = {.voxels = 1, .free = 1, .body_2cm = {.spheres = 4}, .body_5cm = {.spheres = 4}};
        seen.seen_free = 8.0 / 11.0;
    }
    return collect(runs);
}

TEST(MetricsJson, tabulates_what_is_seen_by_thickness_pooled_over_seeds) {
    const auto json = nlohmann::json::parse(metrics_json(with_a_cable()));
    const auto& classes = json.at("run").at("thickness").at("fast").at("depth");
    EXPECT_EQ(classes.size(), 7U);
    EXPECT_EQ(classes.at("rod_5_8_mm"), nlohmann::json::parse(R"({"voxels": 20, "occupied": 2, "free": 14,
        "unknown": 4, "body_2cm": {"spheres": 80, "free": 60}, "body_5cm": {"spheres": 80, "free": 22}})"));
    EXPECT_EQ(classes.at("board").at("voxels"), 0);
    EXPECT_EQ(classes.at("too_coarse").at("voxels"), 2);
    EXPECT_NEAR(json.at("fast").at("depth").at("seen_free").at("mean").get<double>(), 8.0 / 11.0, 1e-12);
    EXPECT_FALSE(nlohmann::json::parse(metrics_json(two_seeds())).at("run").contains("thickness"))
        << "without a camera";
}

TEST(MetricsTable, shows_thin_things_only_where_a_camera_sees_some) {
    const std::string table = metrics_table(with_a_cable());
    EXPECT_NE(
        table.find(
            "seen thickness      map            voxels   occupied     free  unknown  body_2cm  body_5cm\n"
            "rod_5_8_mm          depth              20      0.100    0.700    0.200     0.750     0.275\n"
            "too_coarse          depth               2      0.000    1.000    0.000     0.000     0.000\n"),
        std::string::npos)
        << table;
    EXPECT_NE(table.find("  [seen by the camera]\n"), std::string::npos);
    const std::string without = metrics_table(two_seeds());
    EXPECT_EQ(without.find("seen"), std::string::npos) << without;
}

TEST(MetricsJson, survives_text_that_is_not_utf8) {
    Results results = two_seeds();
    results.provenance = {{"world", "caf\xe9.sdf"}};
    EXPECT_TRUE(nlohmann::json::accept(metrics_json(results)));
}

TEST(MetricsJson, is_the_same_text_for_the_same_results) {
    EXPECT_EQ(metrics_json(two_seeds()), metrics_json(two_seeds()));
}

TEST(MetricsTable, shows_ours_beside_the_papers) {
    const std::string table = metrics_table(two_seeds());
    EXPECT_NE(
        table.find("Strong et al. 2021, Table I   depth               970      27510       3523        299"),
        std::string::npos);
    EXPECT_NE(table.find("robust                        depth                 0          0       2100"),
              std::string::npos);
    EXPECT_NE(table.find("missed                        2100 ± 141           1550 ± 71           -550 ± 71"),
              std::string::npos);
    EXPECT_NE(table.find("simulate                                       12.50       14.25"),
              std::string::npos);
}

TEST(MetricsTable, keeps_its_columns_aligned_under_long_names) {
    const Runs runs = {judge("a_configuration_with_a_very_long_name", "fused", 0, 10),
                       judge("a_configuration_with_a_very_long_name", "depth", 0, 30)};
    const std::string table = metrics_table(collect(runs));
    const auto end_of = [&](std::string_view part) {
        const std::size_t at = table.find(part);
        EXPECT_NE(at, std::string::npos) << part;
        return at + part.size() - table.rfind('\n', at);
    };
    const std::string name = "a_configuration_with_a_very_long_name";
    EXPECT_EQ(end_of("     Missed"), end_of(name + "   depth                 0          0         30"));
    EXPECT_EQ(end_of("seed by seed" + std::string(72, ' ') + "f1"),
              end_of(name + "/fused - " + name + "/depth          +0.000"));
}

TEST(MetricsTable, counts_its_seeds_in_words_that_fit) {
    EXPECT_NE(metrics_table(two_seeds()).find("robust, mean ± sd of 2 seeds\n"), std::string::npos);
    const Runs one = {judge("robust", "fused", 0, 10)};
    EXPECT_NE(metrics_table(collect(one)).find("robust, one seed\n"), std::string::npos);
}

TEST(MetricsTable, leaves_the_papers_figures_to_the_papers_experiment) {
    Results results = two_seeds();
    results.is_papers_experiment = false;
    EXPECT_EQ(metrics_table(results).find("Strong"), std::string::npos);
    EXPECT_NE(metrics_table(results).find("robust          depth                 0          0       2100"),
              std::string::npos);
}

TEST(MetricsTable, shows_undefined_figures_as_a_dash) {
    const std::string table = metrics_table(two_seeds());
    EXPECT_EQ(table.find("nan"), std::string::npos);
    EXPECT_NE(table.find("precision                              -                   -                   -"),
              std::string::npos);
}

TEST(MetricsTable, one_seed_has_no_spread) {
    const Runs runs = {judge("robust", "fused", 7, 1500)};
    const std::string table = metrics_table(collect(runs));
    EXPECT_NE(table.find("robust, one seed"), std::string::npos) << table;
    EXPECT_EQ(table.find("±"), std::string::npos) << table;
    EXPECT_NE(metrics_table(two_seeds()).find("robust, mean ± sd of 2 seeds"), std::string::npos);
}

TEST(MetricsTable, nothing_has_no_sign) {
    Runs runs = {judge("robust", "depth", 0, 10), judge("robust", "fused", 0, 10),
                 judge("robust", "depth", 1, 10), judge("robust", "fused", 1, 10)};
    runs[1].metrics.f1 = *runs[0].metrics.f1 - 1e-5;  // a difference of -0.00001 that rounds to zero
    const std::string table = metrics_table(collect(runs));
    EXPECT_EQ(table.find("-0.000"), std::string::npos) << table;
    runs[1].metrics.f1 = *runs[0].metrics.f1 - 0.1;
    EXPECT_NE(metrics_table(collect(runs)).find("-0.050"), std::string::npos);
}

}  // namespace
}  // namespace octoskin::evaluation
