#include "host/lab/evaluation/aggregate.hpp"

#include <gtest/gtest.h>

namespace octoskin::evaluation {
namespace {

/// Inside a test, `Run` is GoogleTest's own.
using Runs = std::vector<Run>;

Run judge(std::string configuration, std::string map, std::uint64_t seed, std::uint64_t missed,
          std::optional<double> f1) {
    Run judged{std::move(configuration), std::move(map), seed, {}};
    judged.metrics.missed = missed;
    judged.metrics.f1 = f1;
    return judged;
}

TEST(Summarise, gives_mean_and_sample_standard_deviation) {
    const Summary summary = summarise({1.0, 2.0, 3.0, 4.0});
    EXPECT_DOUBLE_EQ(summary.mean.value(), 2.5);
    EXPECT_NEAR(summary.sd.value(), 1.2909944487358056, 1e-15);
    EXPECT_EQ(summary.per_seed, (std::vector<std::optional<double>>{1.0, 2.0, 3.0, 4.0}));
}

TEST(Summarise, leaves_out_undefined_seeds_but_keeps_their_place) {
    const Summary summary = summarise({std::nullopt, 2.0, 4.0});
    EXPECT_DOUBLE_EQ(summary.mean.value(), 3.0);
    EXPECT_NEAR(summary.sd.value(), 1.4142135623730951, 1e-15);
    ASSERT_EQ(summary.per_seed.size(), 3U);
    EXPECT_FALSE(summary.per_seed[0].has_value());
}

TEST(Summarise, knows_no_spread_of_one_seed_and_nothing_of_none) {
    EXPECT_EQ(summarise({7.0}).mean.value(), 7.0);
    EXPECT_FALSE(summarise({7.0}).sd.has_value());
    EXPECT_FALSE(summarise({}).mean.has_value());
    EXPECT_FALSE(summarise({std::nullopt}).mean.has_value());
}

TEST(Aggregate, sorts_each_maps_runs_by_seed) {
    const Runs runs = {judge("robust", "fused", 2, 30, 0.6), judge("robust", "depth", 0, 100, 0.5),
                       judge("robust", "fused", 0, 10, 0.4), judge("robust", "fused", 1, 20, 0.5)};
    const auto summaries = aggregate(runs);
    ASSERT_EQ(summaries.size(), 2U);
    EXPECT_EQ(summaries[0].map, "fused");
    EXPECT_EQ(summaries[0].seeds, (std::vector<std::uint64_t>{0, 1, 2}));
    EXPECT_EQ(summaries[0].at("missed").per_seed, (std::vector<std::optional<double>>{10.0, 20.0, 30.0}));
    EXPECT_DOUBLE_EQ(summaries[0].at("missed").mean.value(), 20.0);
    EXPECT_DOUBLE_EQ(summaries[0].at("missed").sd.value(), 10.0);
    EXPECT_EQ(summaries[1].map, "depth");
    EXPECT_DOUBLE_EQ(summaries[1].at("f1").mean.value(), 0.5);
}

TEST(Aggregate, keeps_maps_of_one_name_in_two_configurations_apart) {
    const Runs runs = {judge("paper", "fused", 0, 1, {}), judge("robust", "fused", 0, 2, {})};
    const auto summaries = aggregate(runs);
    ASSERT_EQ(summaries.size(), 2U);
    EXPECT_EQ(find_map(summaries, "paper", "fused")->at("missed").mean.value(), 1.0);
    EXPECT_EQ(find_map(summaries, "robust", "fused")->at("missed").mean.value(), 2.0);
    EXPECT_EQ(find_map(summaries, "robust", "depth"), nullptr);
}

TEST(Aggregate, pools_the_calibration_of_the_seeds) {
    Runs runs = {judge("robust", "fused", 0, 0, {}), judge("robust", "fused", 1, 0, {})};
    runs[0].metrics.calibration[7] = {.count = 10, .probability_sum = 7.5, .occupied_count = 9};
    runs[1].metrics.calibration[7] = {.count = 30, .probability_sum = 22.5, .occupied_count = 21};
    const auto summaries = aggregate(runs);
    EXPECT_EQ(summaries[0].calibration[7].count, 40U);
    EXPECT_DOUBLE_EQ(summaries[0].calibration[7].mean_predicted().value(), 0.75);
    EXPECT_DOUBLE_EQ(summaries[0].calibration[7].observed_fraction().value(), 0.75);
}

TEST(Aggregate, pools_the_evidence_behind_free_of_the_seeds) {
    Runs runs = {judge("robust", "fused", 0, 0, {}), judge("robust", "fused", 1, 0, {})};
    runs[0].metrics.free_calibration.images[5] = {.voxels = 10, .surface = 1};
    runs[1].metrics.free_calibration.images[5] = {.voxels = 30, .surface = 5};
    runs[1].metrics.free_calibration.sum[7] = {.voxels = 2, .surface = 0};
    const auto summaries = aggregate(runs);
    EXPECT_DOUBLE_EQ(summaries[0].free_calibration.images[5].surface_share().value(), 0.15);
    EXPECT_EQ(summaries[0].free_calibration.sum[7].voxels, 2U);
    EXPECT_EQ(summaries[0].free_calibration.beams[5].voxels, 0U);
}

TEST(PairedDifference, subtracts_seed_by_seed) {
    // The two maps spread by 100 over the seeds; their difference does not spread at all.
    const Runs runs = {judge("robust", "fused", 0, 100, 0.5), judge("robust", "fused", 1, 200, 0.6),
                       judge("robust", "depth", 0, 130, 0.4), judge("robust", "depth", 1, 230, 0.5)};
    const auto summaries = aggregate(runs);
    const auto difference = paired_difference(summaries[0], summaries[1]);
    EXPECT_EQ(difference.name, "robust/fused - robust/depth");
    const Summary& missed = difference.metrics.at("missed");
    EXPECT_DOUBLE_EQ(missed.mean.value(), -30.0);
    EXPECT_DOUBLE_EQ(missed.sd.value(), 0.0);
    EXPECT_NEAR(difference.metrics.at("f1").mean.value(), 0.1, 1e-12);
}

TEST(PairedDifference, uses_only_seeds_that_both_have) {
    const Runs runs = {judge("a", "fused", 0, 5, {}),  judge("a", "fused", 1, 7, 0.5),
                       judge("a", "fused", 3, 9, 0.7), judge("a", "depth", 1, 1, 0.1),
                       judge("a", "depth", 2, 2, 0.1), judge("a", "depth", 3, 4, {})};
    const auto summaries = aggregate(runs);
    const auto difference = paired_difference(summaries[0], summaries[1]);
    EXPECT_EQ(difference.seeds, (std::vector<std::uint64_t>{1, 3}));
    EXPECT_EQ(difference.metrics.at("missed").per_seed, (std::vector<std::optional<double>>{6.0, 5.0}));
    EXPECT_EQ(difference.metrics.at("f1").per_seed, (std::vector<std::optional<double>>{0.4, std::nullopt}));
}

TEST(StandardDifferences, ask_what_fusion_adds_and_how_configurations_differ) {
    Runs runs;
    for (const char* configuration : {"paper", "robust"}) {
        for (const char* map : {"depth", "proximity", "fused"}) {
            runs.push_back(judge(configuration, map, 0, 0, {}));
        }
    }
    std::vector<std::string> names;
    for (const auto& difference : standard_differences(aggregate(runs))) {
        names.push_back(difference.name);
    }
    EXPECT_EQ(names,
              (std::vector<std::string>{"paper/fused - paper/depth", "paper/fused - paper/proximity",
                                        "robust/fused - robust/depth", "robust/fused - robust/proximity",
                                        "robust/fused - paper/fused"}));
}

TEST(StandardDifferences, leave_out_what_was_not_run) {
    const Runs runs = {judge("robust", "fused", 0, 0, {})};
    EXPECT_TRUE(standard_differences(aggregate(runs)).empty());
}

}  // namespace
}  // namespace octoskin::evaluation
