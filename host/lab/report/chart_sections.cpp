#include <fmt/format.h>

#include "host/lab/report/charts.hpp"
#include "host/lab/report/sections.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

constexpr std::string_view kPairedText =
    R"(<p>Each dot is one seed’s fused map minus the same seed’s depth map, the bar their mean (configuration
<code>{}</code>). The spread of a metric over seeds comes mostly from the phase of the voxel grid relative to the
furniture; a paired difference cancels it.</p>
<ul class="legend">
<li><i class="swatch-better"></i>better</li>
<li><i class="swatch-worse"></i>worse</li>
</ul>
<div class="charts">
)";

constexpr std::string_view kVoxelCaption =
    R"(Fewer is better, except for occupied. Fusion has a cost: beams that graze a surface erase part of it, which
counts as lost.)";

constexpr std::string_view kUpdateHead =
    R"(<section id="update" class="split">
<h2>How much one measurement counts</h2>
<div>
<p>The probability that a voxel is occupied after a single hit, from the update model that this run used{}.</p>
)";

/// For a run whose range sensors are ideal rays, as in the paper.
constexpr std::string_view kPapersLabels =
    R"(<p>The paper’s text gives 0.73 → 0.68 for the camera and 0.72 → 0.64 for the proximity sensor; its equations give
the reverse, so the two labels are swapped. This report uses the equations.</p>
)";

constexpr std::string_view kCountingText =
    R"(<p>The range sensors {} see a cone. Their ranges have no such curve: they are counted as hits H and misses F of
a voxel, and P = (a + H) / (a + b + H + F). Here a = {:g} and b = {:g} without other measurements; camera measurements
increase them. A range of up to {} adds {} to H in total, shared by the voxels of its cap: most get a small part of
it. Every range adds {} to F of each voxel that it passed near its axis. A voxel is occupied from P = {:g} on if it has
{:g} hits or the camera confirms it. A voxel with such ranges only is free with more than {:g} misses.</p>
)";

constexpr std::string_view kUpdateCaption =
    R"(Hits nearer than a sensor’s minimum range (dotted) change nothing. Dashed: a voxel that a beam passed
through.)";

constexpr std::string_view kCountingCaption =
    R"(A voxel without other measurements. Solid: each range’s hit counts for it alone, the maximum of counting.
Dashed: each range passed it.)";

constexpr std::string_view kCalibrationText =
    R"(<section id="calibration" class="split">
<h2>Are the probabilities calibrated?</h2>
<div>
<p>Known voxels in ten bins of predicted probability, all seeds pooled. On the dotted diagonal, of the voxels with
70 % seven in ten are surface. A dot above it: more of these voxels are surface than predicted; below: fewer. So for
occupied voxels (over 0.5), above is underconfident and below overconfident; for free voxels, above is overconfident and
below underconfident. The larger a dot, the more voxels (on a
logarithmic scale).</p>
<ul class="legend">
)";

/// "0.7 m", or for both kinds of beam "0.7 m (of a zone 2 m)".
template <class Number>
std::string of_each_beam(const RangeCounting& ranges, Number ConeModel::*figure, std::string_view unit) {
    const auto text = [&](const ConeModel& beam) { return fmt::format("{:g}{}", beam.*figure, unit); };
    if (!ranges.cone || !ranges.zone) return text(ranges.cone ? *ranges.cone : *ranges.zone);
    return fmt::format("{} (of a zone {})", text(*ranges.cone), text(*ranges.zone));
}

std::string counting_text(const RangeCounting& ranges) {
    const CountModel& counts = ranges.counts;
    return fmt::format(
        fmt::runtime(kCountingText), ranges.has_rays ? "that are no rays" : "of this run", counts.prior_hits,
        counts.prior_misses, of_each_beam(ranges, &ConeModel::hit_range_max_m, " m"),
        of_each_beam(ranges, &ConeModel::hit_mass, ""), of_each_beam(ranges, &ConeModel::miss_mass, ""),
        counts.occupied_probability, counts.hits_min, counts.misses_min);
}

}  // namespace

std::string chart_figure(const std::string& svg, std::string_view caption) {
    if (svg.empty()) {
        return {};
    }
    return fmt::format("<figure class=\"chart\">\n{}<figcaption>{}</figcaption></figure>\n", svg, caption);
}

std::string legend_entry(std::string_view map, std::string_view title) {
    return fmt::format("<li><i class=\"line {}\"></i>{}</li>\n", css_class_of(map), title);
}

std::string paired_section(const ReportInput& input) {
    const auto* fused = find_map(input.results.maps, input.main_configuration, "fused");
    const auto* depth = find_map(input.results.maps, input.main_configuration, "depth");
    if (fused == nullptr || depth == nullptr) {
        return {};
    }
    std::string html = "<section id=\"paired\">\n<h2>What fusion adds, seed by seed</h2>\n";
    const auto difference = paired_difference(*fused, *depth);
    html += fmt::format(fmt::runtime(kPairedText), escaped(input.main_configuration));
    html += chart_figure(
        paired_svg(difference, {"f1", "recall", "occluded_recall", "object_recall", "coverage", "precision"},
                   "fused − depth"),
        "More is better in every row.");
    html += chart_figure(
        paired_svg(difference, {"missed", "incorrect", "lost", "occupied"}, "fused − depth, voxels"),
        kVoxelCaption);
    return html + "</div>\n</section>\n";
}

std::string update_section(const ReportInput& input) {
    const RangeCounting& ranges = input.range_counting;
    std::string html =
        fmt::format(fmt::runtime(kUpdateHead), ranges.has_rays ? " (Fig. 2 of the paper)" : "");
    if (ranges.has_rays) html += kPapersLabels;
    const bool is_counting = ranges.cone || ranges.zone;
    if (is_counting) html += counting_text(ranges);
    html += "<ul class=\"legend\">\n";
    if (ranges.has_rays) html += legend_entry("proximity", "Range sensor");
    html += legend_entry("depth", "Depth camera") + "</ul>\n</div>\n<div>\n";
    html += chart_figure(update_curves_svg(input.update_model, ranges.has_rays), kUpdateCaption);
    if (is_counting) html += chart_figure(counting_curves_svg(ranges), kCountingCaption);
    return html + "</div>\n</section>\n";
}

std::string calibration_section(const ReportInput& input) {
    std::string html(kCalibrationText);
    std::vector<const evaluation::MapSummary*> maps;
    for (const auto& map : input.results.maps) {
        if (map.configuration == input.main_configuration) {
            maps.push_back(&map);
            html += legend_entry(map.map, map_title(map.map, input));
        }
    }
    html += "</ul>\n</div>\n";
    html += chart_figure(calibration_svg(maps), "The map’s log-odds are clamped: no voxel is ever certain.");
    return html + "</section>\n";
}

}  // namespace octoskin::report
