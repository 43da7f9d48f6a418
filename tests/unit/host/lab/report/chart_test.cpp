#include "host/lab/report/chart.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/lab/report/charts.hpp"

namespace octoskin::report {
namespace {

using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pointwise;

int occurrences(const std::string& text, std::string_view part) {
    int count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++count;
    }
    return count;
}

evaluation::PairedDifference difference_of(std::vector<std::optional<double>> f1) {
    evaluation::PairedDifference difference{"robust/fused - robust/depth", {0, 1, 2}, {}};
    difference.metrics.emplace("f1", evaluation::summarise(std::move(f1)));
    difference.metrics.emplace("recall", evaluation::summarise({std::nullopt}));
    return difference;
}

TEST(RoundTicks, are_one_two_or_five_times_a_power_of_ten_apart) {
    EXPECT_THAT(round_ticks(0.0, 1.0, 5),
                Pointwise(DoubleNear(1e-12), std::vector<double>{0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
    EXPECT_THAT(round_ticks(-633.0, 412.0, 6),
                Pointwise(DoubleNear(1e-9), std::vector<double>{-600, -400, -200, 0, 200, 400}));
    EXPECT_THAT(round_ticks(0.35, 0.8, 9),
                Pointwise(DoubleNear(1e-12),
                          std::vector<double>{0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8}));
}

TEST(RoundTicks, stay_within_the_axis) {
    for (const double tick : round_ticks(0.013, 0.0371, 4)) {
        EXPECT_GE(tick, 0.013);
        EXPECT_LE(tick, 0.0371);
    }
}

TEST(Chart, puts_points_where_the_axes_say) {
    Chart chart({.low = 0.0, .high = 10.0, .label = "x"}, {.low = 0.0, .high = 1.0, .label = "y"}, 182.0,
                168.0);
    // Drawing area: 64 px left, 18 px right, 16 px above, 52 px below: 100 px by 100 px.
    chart.line({{0.0, 0.0}, {5.0, 0.5}, {10.0, 1.0}}, "depth");
    EXPECT_THAT(chart.svg("title"), HasSubstr("points=\"64.0,116.0 114.0,66.0 164.0,16.0\""));
}

TEST(Chart, escapes_every_text) {
    Chart chart({.label = "a<b"}, {.label = "c&d"});
    chart.text({0.5, 0.5}, 0.0, 0.0, "\"quoted\"", "note");
    const std::string svg = chart.svg("<title>");
    EXPECT_THAT(svg, HasSubstr("a&lt;b"));
    EXPECT_THAT(svg, HasSubstr("c&amp;d"));
    EXPECT_THAT(svg, HasSubstr("&quot;quoted&quot;"));
    EXPECT_THAT(svg, Not(HasSubstr("<title>")));
}

TEST(UpdateCurves, end_at_the_figures_of_the_papers_equations) {
    // exp(L) / (1 + exp(L)) with L = 1 - 0.07 d and 1 - 0.1 d, by hand: d = 0.04, 4 and 0.51, 4 m.
    const std::string svg = update_curves_svg(UpdateModel{});
    EXPECT_THAT(svg, HasSubstr(">0.731<"));
    EXPECT_THAT(svg, HasSubstr(">0.673<"));
    EXPECT_THAT(svg, HasSubstr(">0.721<"));
    EXPECT_THAT(svg, HasSubstr(">0.646<"));
    EXPECT_THAT(svg, HasSubstr("a beam passed through: 0.401"));
}

TEST(UpdateCurves, follow_the_model_of_the_run) {
    UpdateModel model;
    model.proximity.slope_per_m = 0.0;
    model.proximity.offset = 0.5;
    EXPECT_EQ(occurrences(update_curves_svg(model), ">0.622<"), 2) << "1 / (1 + exp(-0.5)) at both ends";
}

TEST(Calibration, draws_one_dot_for_each_bin_that_has_voxels) {
    evaluation::MapSummary map{"robust", "fused", {0}, {}, {}};
    map.calibration[1] = {.count = 1000, .probability_sum = 120.0, .occupied_count = 20};
    map.calibration[9] = {.count = 10, .probability_sum = 9.5, .occupied_count = 9};
    const std::vector<const evaluation::MapSummary*> maps = {&map};
    EXPECT_EQ(occurrences(calibration_svg(maps), "class=\"dot fused\""), 2);
}

TEST(Calibration, of_no_map_is_an_empty_diagram) {
    EXPECT_EQ(occurrences(calibration_svg({}), "<circle"), 0);
}

TEST(Calibration, never_takes_a_maps_name_for_a_class) {
    EXPECT_EQ(css_class_of("depth"), "depth");
    EXPECT_EQ(css_class_of("\"><script>"), "other");
}

TEST(Paired, draws_a_dot_for_each_seed_and_leaves_out_undefined_rows) {
    const std::string svg = paired_svg(difference_of({0.09, 0.07, std::nullopt}), {"f1", "recall"}, "unit");
    EXPECT_EQ(occurrences(svg, "class=\"seed\""), 2);
    EXPECT_EQ(occurrences(svg, "class=\"row\""), 1);
    EXPECT_THAT(svg, HasSubstr(">+0.080 ± 0.014<"));
}

/// The class of the only bar of a chart of one metric.
std::string bar_of(std::string_view metric, double change) {
    evaluation::PairedDifference difference{"robust/fused - robust/depth", {0}, {}};
    difference.metrics.emplace(std::string(metric), evaluation::summarise({change}));
    const std::string svg = paired_svg(difference, {metric}, "unit");
    const bool is_better = svg.find("class=\"bar better\"") != std::string::npos;
    const bool is_worse = svg.find("class=\"bar worse\"") != std::string::npos;
    return is_better == is_worse ? "unclear" : is_better ? "better" : "worse";
}

TEST(Paired, colours_a_change_by_its_worth_and_not_by_its_sign) {
    for (const char* metric : {"missed", "incorrect", "lost", "log_loss", "brier"}) {
        EXPECT_EQ(bar_of(metric, -739.0), "better") << metric;
        EXPECT_EQ(bar_of(metric, 390.0), "worse") << metric;
    }
    for (const char* metric : {"occupied", "free", "precision", "recall", "f1", "iou", "precision_tolerant",
                               "occluded_recall", "object_recall", "coverage"}) {
        EXPECT_EQ(bar_of(metric, 0.1), "better") << metric;
        EXPECT_EQ(bar_of(metric, -0.1), "worse") << metric;
    }
}

TEST(Paired, labels_its_ticks_with_as_many_digits_as_tell_them_apart) {
    const std::string svg = paired_svg(difference_of({0.012, 0.008, 0.010}), {"f1"}, "unit");
    for (const char* label : {">+0.002<", ">+0.004<", ">+0.010<", ">+0.012<"}) {
        EXPECT_EQ(occurrences(svg, label), 1) << label;
    }
    EXPECT_THAT(svg, Not(HasSubstr(">+0.00<")));
}

TEST(TickDigits, tell_neighbours_apart) {
    EXPECT_EQ(tick_digits({0.0, 100.0}), 0);
    EXPECT_EQ(tick_digits({0.0, 0.5}), 1);
    EXPECT_EQ(tick_digits({0.0, 0.002}), 3);
    EXPECT_EQ(tick_digits({0.0}), 2);
}

TEST(Paired, shows_zero_even_if_every_seed_is_far_from_it) {
    EXPECT_THAT(paired_svg(difference_of({0.9, 1.0, 0.95}), {"f1"}, "unit"),
                HasSubstr("text-anchor=\"middle\">0<"));
}

TEST(Paired, survives_differences_that_are_all_zero) {
    const std::string svg = paired_svg(difference_of({0.0, 0.0, 0.0}), {"f1"}, "unit");
    EXPECT_EQ(occurrences(svg, "class=\"seed\""), 3);
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(Paired, is_empty_without_a_defined_row) {
    EXPECT_EQ(paired_svg(difference_of({}), {"recall", "no_such_metric"}, "unit"), "");
}

}  // namespace
}  // namespace octoskin::report
