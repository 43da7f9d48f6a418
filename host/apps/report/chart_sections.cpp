#include <fmt/format.h>

#include "host/apps/report/charts.hpp"
#include "host/apps/report/sections.hpp"
#include "host/apps/report/text.hpp"

namespace octoskin::report {
namespace {

constexpr std::string_view kPairedText =
    R"(<p>Each dot is one seed’s fused map minus the same seed’s depth map, the bar their mean (configuration
<code>{}</code>). The spread of a metric over seeds is mostly the phase of the voxel grid against the furniture; a
paired difference cancels it.</p>
<ul class="legend">
<li><i class="swatch-better"></i>better</li>
<li><i class="swatch-worse"></i>worse</li>
</ul>
<div class="charts">
)";

constexpr std::string_view kVoxelCaption =
    R"(Fewer is better, except for occupied. Fusion is not free: beams that graze a surface erase some of it, which
shows as lost.)";

constexpr std::string_view kUpdateText =
    R"(<section id="update" class="split">
<h2>How much one measurement counts</h2>
<div>
<p>The probability that a voxel is occupied after a single hit, from the update model that this run used (Fig. 2 of the
paper). The paper’s prose gives 0.73 → 0.68 to the camera and 0.72 → 0.64 to the proximity sensor; its equations say the
reverse, so the two labels are swapped. We keep the equations.</p>
<ul class="legend">
)";

constexpr std::string_view kUpdateCaption =
    R"(Hits nearer than a sensor’s minimum range (dotted) change nothing. Dashed: a voxel that a beam passed
through.)";

constexpr std::string_view kCalibrationText =
    R"(<section id="calibration" class="split">
<h2>Can the probabilities be believed?</h2>
<div>
<p>Known voxels in ten bins of predicted probability, all seeds pooled. On the dotted diagonal a map that says 70 % is
right seven times in ten. A dot above it: more of these voxels are surface than the map says; below: fewer. So for what
a map calls occupied (over 0.5), above is too timid and below too bold; for what it calls free, above is too bold and
below too timid. The larger a dot, the more voxels (on a
logarithmic scale).</p>
<ul class="legend">
)";

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
    std::string html(kUpdateText);
    html += legend_entry("proximity", "Range sensor") + legend_entry("depth", "Depth camera");
    html += "</ul>\n</div>\n" + chart_figure(update_curves_svg(input.update_model), kUpdateCaption);
    return html + "</section>\n";
}

std::string calibration_section(const ReportInput& input) {
    std::string html(kCalibrationText);
    std::vector<const evaluation::MapSummary*> maps;
    for (const auto& map : input.results.maps) {
        if (map.configuration == input.main_configuration) {
            maps.push_back(&map);
            html += legend_entry(map.map, map_title(map.map));
        }
    }
    html += "</ul>\n</div>\n";
    html += chart_figure(calibration_svg(maps), "The map’s log-odds are clamped: no voxel is ever certain.");
    return html + "</section>\n";
}

}  // namespace octoskin::report
