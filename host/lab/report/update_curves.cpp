#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/lab/report/chart.hpp"
#include "host/lab/report/charts.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

constexpr double kRangeMax_m = 4.0;

double probability_of(double log_odds) {
    return 1.0 / (1.0 + std::exp(-log_odds));
}

/// The curve from the range at which hits begin to count; before it, a line at 0.5.
struct Curve {
    std::vector<ChartPoint> silent;
    std::vector<ChartPoint> counting;
};

Curve curve_of(const HitModel& hit) {
    constexpr int kSteps = 400;
    Curve curve;
    for (int i = 0; i <= kSteps; ++i) {
        const double range_m = kRangeMax_m * i / kSteps;
        const auto log_odds = static_cast<double>(hit.log_odds(range_m));
        auto& part = log_odds == 0.0 ? curve.silent : curve.counting;
        part.push_back({range_m, probability_of(log_odds)});
    }
    return curve;
}

void draw(Chart& chart, const Curve& curve, std::string_view css_class) {
    chart.line(curve.silent, fmt::format("{} faint", css_class));
    chart.line(curve.counting, css_class);
}

/// Values at both ends, written beside them.
void label_ends(Chart& chart, const Curve& curve, std::string_view css_class, double dy_first,
                double dy_last) {
    if (curve.counting.empty()) {
        return;
    }
    const auto& first = curve.counting.front();
    const auto& last = curve.counting.back();
    const std::string css = fmt::format("note {}", css_class);
    chart.text(first, 6.0, dy_first, ratio_text(first.y), css);
    chart.text(last, -4.0, dy_last, ratio_text(last.y), css, "end");
}

constexpr int kReadings = 10;

/// Probability after readings that all hit or all passed, up to the limit of a voxel's counts.
std::vector<ChartPoint> counted(const CountModel& counts, float mass, bool is_hit) {
    std::vector<ChartPoint> points;
    for (int n = 0; n <= kReadings; ++n) {
        const float count = std::min(mass * static_cast<float>(n), counts.counts_max);
        const float hits = counts.prior_hits + (is_hit ? count : 0.0F);
        const float misses = counts.prior_misses + (is_hit ? 0.0F : count);
        points.push_back({static_cast<double>(n), static_cast<double>(hits / (hits + misses))});
    }
    return points;
}

void draw_counts(Chart& chart, const CountModel& counts, const ConeModel& beam, std::string_view name,
                 std::string_view css_class) {
    const auto hits = counted(counts, beam.hit_mass, true);
    const auto misses = counted(counts, beam.miss_mass, false);
    chart.line(hits, css_class);
    chart.line(misses, fmt::format("{} passed", css_class));
    const std::string css = fmt::format("note {}", css_class);
    chart.text(hits[1], 8.0, 14.0, fmt::format("{}: {}", name, ratio_text(hits[1].y)), css);
    chart.text(misses[1], 8.0, css_class == "fused" ? 16.0 : -6.0, ratio_text(misses[1].y), css);
}

}  // namespace

std::string update_curves_svg(const UpdateModel& model, bool has_rays) {
    const Curve proximity = has_rays ? curve_of(model.proximity) : Curve{};
    const Curve depth = curve_of(model.depth);
    Chart chart({.low = 0.0, .high = kRangeMax_m, .label = "range, m", .tick_count = 8},
                {.low = 0.35, .high = 0.8, .label = "P(occupied) after one update", .tick_count = 9});
    draw(chart, proximity, "proximity");
    draw(chart, depth, "depth");
    label_ends(chart, proximity, "proximity", -8.0, -8.0);
    label_ends(chart, depth, "depth", 18.0, 18.0);
    const double miss = probability_of(static_cast<double>(model.miss_log_odds));
    chart.line({{0.0, miss}, {kRangeMax_m, miss}}, "miss");
    chart.text({kRangeMax_m, miss}, -4.0, -7.0, "a beam passed through: " + ratio_text(miss), "note miss",
               "end");
    return chart.svg(
        "Probability that a voxel is occupied after one hit, over the range, for each kind of sensor");
}

std::string counting_curves_svg(const RangeCounting& counting) {
    assert(counting.cone || counting.zone);
    Chart chart({.low = 0.0, .high = kReadings, .label = "ranges, one after the other", .tick_count = 10},
                {.low = 0.0, .high = 1.0, .label = "P(occupied) by counts", .tick_count = 10});
    const auto threshold = static_cast<double>(counting.counts.occupied_probability);
    chart.line({{0.0, threshold}, {kReadings, threshold}}, "ideal");
    chart.text({kReadings, threshold}, -4.0, -6.0, "occupied from " + ratio_text(threshold), "note", "end");
    if (counting.cone) draw_counts(chart, counting.counts, *counting.cone, "whole cone", "proximity");
    if (counting.zone)
        draw_counts(chart, counting.counts, *counting.zone, "zone", counting.cone ? "fused" : "proximity");
    return chart.svg("Probability that a voxel is occupied over the number of ranges that hit or passed it");
}

}  // namespace octoskin::report
