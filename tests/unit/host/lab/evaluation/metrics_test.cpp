#include "host/lab/evaluation/metrics.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/host/lab/evaluation/keys.hpp"
#include "tests/unit/host/lab/evaluation/metric_names.hpp"

namespace octoskin::evaluation {
namespace {

constexpr auto kOccupied = Occupancy::occupied;
constexpr auto kFree = Occupancy::free;
constexpr auto kUnknown = Occupancy::unknown;

/// One voxel as all three see it.
struct Case {
    Occupancy camera;
    SurfaceVoxel surface;
    MapVoxel map;
};

// One of every kind that the definitions tell apart, and a few twice so that no two figures are equal.
const std::vector<Case> kCases = {
    {kOccupied, {.is_surface = true, .is_near_surface = true}, {kOccupied, 0.95F}},
    {kOccupied, {.is_surface = true, .is_near_surface = true, .is_occluded = true}, {kOccupied, 0.85F}},
    {kOccupied,
     {.is_surface = true, .is_near_surface = true, .is_hidden_object = true, .is_occluded = true},
     {kUnknown, 0.5F}},
    {kOccupied,
     {.is_surface = true, .is_near_surface = true, .is_hidden_object = true, .is_occluded = true},
     {kOccupied, 0.75F}},
    {kOccupied, {.is_surface = true, .is_near_surface = true}, {kFree, 0.25F}},
    {kFree, {.is_near_surface = true}, {kOccupied, 0.65F}},
    {kUnknown, {}, {kOccupied, 0.55F}},
    {kFree, {}, {kFree, 0.15F}},
    {kFree, {}, {kUnknown, 0.5F}},
    {kUnknown, {.is_near_surface = true, .is_interior = true}, {kOccupied, 0.95F}},
    {kUnknown, {}, {kFree, 0.35F}},
    {kOccupied, {}, {kFree, 0.45F}},
    {kUnknown, {.is_surface = true, .is_near_surface = true}, {kUnknown, 0.5F}},
    {kOccupied,
     {.is_surface = true, .is_near_surface = true, .is_hidden_object = true, .is_seen = true},
     {kOccupied, 0.95F}},
};

Metrics metrics_of(const std::vector<Case>& cases) {
    const KeyBox box = row(static_cast<int>(cases.size()));
    Truth truth{0.04, VoxelGrid<Occupancy>(box), VoxelGrid<SurfaceVoxel>(box)};
    VoxelGrid<MapVoxel> map(box);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        truth.camera[i] = cases[i].camera;
        truth.surface[i] = cases[i].surface;
        map[i] = cases[i].map;
    }
    return compute_metrics(map, truth);
}

TEST(Metrics, count_table_one_against_the_camera_truth) {
    const Metrics metrics = metrics_of(kCases);
    EXPECT_EQ(metrics.occupied, 4U);
    EXPECT_EQ(metrics.free, 1U);
    EXPECT_EQ(metrics.missed, 1U);
    EXPECT_EQ(metrics.incorrect, 3U) << "free and unknown truth alike, interiors too";
    EXPECT_EQ(metrics.lost, 2U);
}

TEST(Metrics, every_pair_of_states_adds_to_at_most_one_column) {
    struct Expected {
        Occupancy truth;
        Occupancy map;
        std::array<std::uint64_t, 5> occupied_free_missed_incorrect_lost;
    };
    const std::vector<Expected> table = {
        {kOccupied, kOccupied, {1, 0, 0, 0, 0}}, {kOccupied, kFree, {0, 0, 0, 0, 1}},
        {kOccupied, kUnknown, {0, 0, 1, 0, 0}},  {kFree, kOccupied, {0, 0, 0, 1, 0}},
        {kFree, kFree, {0, 1, 0, 0, 0}},         {kFree, kUnknown, {0, 0, 0, 0, 0}},
        {kUnknown, kOccupied, {0, 0, 0, 1, 0}},  {kUnknown, kFree, {0, 0, 0, 0, 0}},
        {kUnknown, kUnknown, {0, 0, 0, 0, 0}},
    };
    for (const auto& expected : table) {
        const Metrics m = metrics_of({{expected.truth, {}, {expected.map, 0.5F}}});
        EXPECT_EQ((std::array{m.occupied, m.free, m.missed, m.incorrect, m.lost}),
                  expected.occupied_free_missed_incorrect_lost)
            << "truth " << static_cast<int>(expected.truth) << " map " << static_cast<int>(expected.map);
    }
}

TEST(Metrics, compare_with_the_analytic_surfaces_outside_of_solids) {
    // Marked: 6 voxels, of them 4 surface and 1 beside one. Surface: 7 voxels. The marked interior is out.
    const Metrics metrics = metrics_of(kCases);
    EXPECT_DOUBLE_EQ(metrics.precision.value(), 4.0 / 6.0);
    EXPECT_DOUBLE_EQ(metrics.recall.value(), 4.0 / 7.0);
    EXPECT_DOUBLE_EQ(metrics.f1.value(), 8.0 / 13.0);
    EXPECT_DOUBLE_EQ(metrics.iou.value(), 4.0 / 9.0);
    EXPECT_DOUBLE_EQ(metrics.precision_tolerant.value(), 5.0 / 6.0);
}

TEST(Metrics, look_at_what_the_camera_cannot_see) {
    const Metrics metrics = metrics_of(kCases);
    EXPECT_DOUBLE_EQ(metrics.occluded_recall.value(), 2.0 / 3.0);
    EXPECT_DOUBLE_EQ(metrics.object_recall.value(), 1.0 / 2.0) << "an object's seen voxels do not count";
}

TEST(Metrics, cover_the_known_share_of_what_is_not_interior) {
    EXPECT_DOUBLE_EQ(metrics_of(kCases).coverage.value(), 10.0 / 13.0);
}

TEST(Metrics, score_the_probabilities_with_unknown_as_one_half) {
    // By hand: 2.475 / 13, and the mean of -ln of the probability given to what is true.
    const Metrics metrics = metrics_of(kCases);
    EXPECT_NEAR(metrics.brier.value(), 2.475 / 13.0, 1e-7);
    EXPECT_NEAR(metrics.log_loss.value(), 0.5429224738912833, 1e-7);
}

TEST(Metrics, calibrate_known_voxels_in_ten_bins) {
    const Calibration bins = metrics_of(kCases).calibration;
    std::vector<std::uint64_t> counts;
    std::vector<std::uint64_t> occupied;
    for (const auto& bin : bins) {
        counts.push_back(bin.count);
        occupied.push_back(bin.occupied_count);
    }
    EXPECT_EQ(counts, (std::vector<std::uint64_t>{0, 1, 1, 1, 1, 1, 1, 1, 1, 2}));
    EXPECT_EQ(occupied, (std::vector<std::uint64_t>{0, 0, 1, 0, 0, 0, 0, 1, 1, 2}));
    EXPECT_FALSE(bins[0].mean_predicted().has_value());
    EXPECT_FALSE(bins[0].observed_fraction().has_value());
    EXPECT_NEAR(bins[9].mean_predicted().value(), 0.95, 1e-7);
    EXPECT_EQ(bins[9].observed_fraction().value(), 1.0);
    EXPECT_EQ(bins[5].observed_fraction().value(), 0.0);
}

TEST(Metrics, put_certainty_into_the_last_bin_and_keep_its_loss_finite) {
    const Metrics metrics = metrics_of({{kFree, {}, {kOccupied, 1.0F}}});
    EXPECT_EQ(metrics.calibration[9].count, 1U);
    EXPECT_NEAR(metrics.log_loss.value(), 20.72, 0.01);
    EXPECT_EQ(metrics.brier.value(), 1.0);
}

TEST(Metrics, are_empty_where_there_is_nothing_to_divide_by) {
    const Metrics nothing_marked = metrics_of({{kFree, {}, {kFree, 0.2F}}});
    EXPECT_FALSE(nothing_marked.precision.has_value());
    EXPECT_FALSE(nothing_marked.recall.has_value());
    EXPECT_FALSE(nothing_marked.f1.has_value());
    EXPECT_FALSE(nothing_marked.iou.has_value());
    EXPECT_FALSE(nothing_marked.precision_tolerant.has_value());
    EXPECT_FALSE(nothing_marked.occluded_recall.has_value());
    EXPECT_FALSE(nothing_marked.object_recall.has_value());
    EXPECT_EQ(nothing_marked.coverage.value(), 1.0);
    const Metrics all_interior = metrics_of({{kFree, {.is_interior = true}, {kFree, 0.2F}}});
    EXPECT_FALSE(all_interior.coverage.has_value());
    EXPECT_FALSE(all_interior.brier.has_value());
}

TEST(Metrics, of_a_map_with_nothing_right_are_zero_not_empty) {
    const Metrics metrics =
        metrics_of({{kFree, {}, {kOccupied, 0.7F}}, {kOccupied, {.is_surface = true}, {}}});
    EXPECT_EQ(metrics.precision.value(), 0.0);
    EXPECT_EQ(metrics.recall.value(), 0.0);
    EXPECT_EQ(metrics.f1.value(), 0.0);
}

TEST(SampleMap, reads_state_and_probability_of_every_voxel) {
    FusedMap map(MapConfig{});
    feed(map, std::vector<VoxelUpdate>{{key(0, 0, 0), 0.85F}, {key(1, 0, 0), -0.4F}});
    const auto samples = sample_map(map, row(3));
    EXPECT_EQ(samples[0].occupancy, kOccupied);
    EXPECT_NEAR(samples[0].probability, 0.70057F, 1e-5);  // 1 / (1 + exp(-0.85))
    EXPECT_EQ(samples[1].occupancy, kFree);
    EXPECT_NEAR(samples[1].probability, 0.40131F, 1e-5);
    EXPECT_EQ(samples[2].occupancy, kUnknown);
    EXPECT_EQ(samples[2].probability, 0.5F);
}

TEST(Evaluate, judges_a_map_by_its_own_threshold) {
    MapConfig config;
    config.log_odds_occupied = 0.8F;
    FusedMap map(config);
    feed(map, std::vector<VoxelUpdate>{{key(0, 0, 0), 0.85F}, {key(1, 0, 0), 0.75F}});
    Truth truth{0.04, VoxelGrid<Occupancy>(row(2), kOccupied), VoxelGrid<SurfaceVoxel>(row(2))};
    const Metrics metrics = evaluate(map, truth, MissUnits{});
    EXPECT_EQ(metrics.occupied, 1U);
    EXPECT_EQ(metrics.lost, 1U);
}

TEST(MetricFields, name_every_scalar_once) {
    EXPECT_TRUE(std::ranges::equal(metric_fields(), kMetricNames, {}, &MetricField::name));
}

TEST(MetricFields, each_reads_the_figure_of_its_name) {
    Metrics metrics;
    metrics.occupied = 1;
    metrics.free = 2;
    metrics.missed = 3;
    metrics.incorrect = 4;
    metrics.lost = 5;
    metrics.precision = 6;
    metrics.recall = 7;
    metrics.f1 = 8;
    metrics.iou = 9;
    metrics.precision_tolerant = 10;
    metrics.occluded_recall = 11;
    metrics.object_recall = 12;
    metrics.coverage = 13;
    metrics.log_loss = 14;
    metrics.brier = 15;
    metrics.seen.emplace();
    metrics.seen->seen_occupied = 16;
    metrics.seen->seen_free = 17;
    metrics.seen->seen_unknown = 18;
    metrics.seen->f1_seen = 19;
    metrics.seen->f1_noise_free = 20;
    metrics.seen->body_2cm = 21;
    metrics.seen->body_5cm = 22;
    metrics.seen->availability_5cm = 23;
    metrics.beside_camera = {.lost_beyond_camera = 24, .freed_occupied = 25, .freed_seen_unknown = 26};
    double expected = 1.0;
    for (const auto& field : metric_fields()) {
        EXPECT_EQ(field.value(metrics).value(), expected) << field.name;
        EXPECT_EQ(field.is_count, expected <= 5.0 || expected == 24.0) << field.name;
        EXPECT_EQ(field.group == MetricGroup::seen, expected > 15.0 && expected < 24.0) << field.name;
        EXPECT_EQ(field.group == MetricGroup::beside_camera, expected > 23.0) << field.name;
        expected += 1.0;
    }
}

TEST(MetricFields, of_what_is_seen_are_empty_without_a_camera) {
    const Metrics metrics = metrics_of(kCases);
    for (const auto& field : metric_fields()) {
        EXPECT_EQ(field.value(metrics).has_value(), field.group < MetricGroup::seen) << field.name;
    }
}

/// Surface voxels but for the last, all occupied in the camera truth.
TEST(BesideCamera, counts_what_only_the_map_with_ranges_has_as_free) {
    struct States {
        Occupancy camera;
        Occupancy both;
    };
    constexpr std::array<States, 8> kVoxels{{{kOccupied, kFree},
                                             {kOccupied, kOccupied},
                                             {kOccupied, kUnknown},
                                             {kOccupied, kOccupied},
                                             {kUnknown, kFree},
                                             {kUnknown, kOccupied},
                                             {kFree, kFree},
                                             {kOccupied, kFree}}};
    const KeyBox box = row(kVoxels.size());
    Truth truth{0.04, VoxelGrid<Occupancy>(box, kOccupied), VoxelGrid<SurfaceVoxel>(box)};
    VoxelGrid<MapVoxel> camera(box);
    VoxelGrid<MapVoxel> both(box);
    for (std::size_t i = 0; i < kVoxels.size(); ++i) {
        camera[i].occupancy = kVoxels[i].camera;
        both[i].occupancy = kVoxels[i].both;
        truth.surface[i].is_surface = i + 1 < kVoxels.size();
    }
    const BesideCamera without_camera = compare(both, camera, truth);
    EXPECT_EQ(without_camera.lost_beyond_camera, 1U);
    EXPECT_EQ(without_camera.freed_occupied, 0.25);
    EXPECT_EQ(without_camera.freed_seen_unknown, std::nullopt);

    truth.seen = SeenTruth{0.04, truth.surface, {}, {}, std::nullopt};
    for (const std::size_t seen : {0U, 4U, 5U}) truth.seen->voxels.push_back({.key = box.key_at(seen)});
    EXPECT_EQ(compare(both, camera, truth).freed_seen_unknown, 0.5);
    truth.camera[4] = kFree;
    EXPECT_EQ(compare(both, camera, truth).lost_beyond_camera, 0U);
}

TEST(MetricFields, come_group_by_group) {
    const auto fields = metric_fields();
    EXPECT_TRUE(std::ranges::is_sorted(fields, {}, &MetricField::group));
}

}  // namespace
}  // namespace octoskin::evaluation
