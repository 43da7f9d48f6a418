#include <fmt/format.h>

#include "host/lab/report/charts.hpp"
#include "host/lab/report/sections.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

constexpr std::size_t kPocketsShown = 8;

constexpr std::string_view kText =
    R"(<section id="unknown">
<h2>Unknown space</h2>
<p>Unknown space within {} m of the robot’s base and above it, {} m³ in all, while the arm moves
(configuration <code>{}</code>, seed {}). The inside of solids stays unknown.</p>
<ul class="legend">
)";

constexpr std::string_view kDepthText =
    R"(<b>{}</b>, at the end, seen from above: how much of each column of that space is unknown,
from 0 m (no colour) to {} m (full colour).)";
constexpr std::string_view kFusedText =
    R"(<b>Fused</b>, at the end, seen from above: how much of each column of that space is unknown, from 0 m
(no colour) to {} m (full colour).)";
constexpr std::string_view kPocketText =
    R"( The numbers are the largest remaining pockets, at their centres; <code>octoskin query --unknown</code>
lists them, in the map’s frame, with a posture of the arm from which a sensor sees into each. The table has them relative
to the robot’s base.)";

std::string pocket_table(const evaluation::UnknownSpace& space) {
    std::string html =
        "<table>\n<thead><tr><th>Pocket</th><th>Volume, l</th><th>x from the base, m</th>"
        "<th>y, m</th><th>z, m</th></tr></thead>\n"
        "<tbody>\n";
    for (std::size_t i = 0; i < std::min(kPocketsShown, space.pockets.size()); ++i) {
        const auto& pocket = space.pockets[i];
        const Eigen::Vector3d at = pocket.centre - space.region.centre;
        html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", i + 1,
                            ratio_text(1e3 * pocket.volume_m3, 1), ratio_text(at.x(), 2),
                            ratio_text(at.y(), 2), ratio_text(at.z(), 2));
    }
    return html + "</tbody>\n</table>\n";
}

std::string change_caption(const evaluation::UnknownSpace& space, bool has_several_cameras) {
    const auto& end = space.samples.back();
    std::string caption = fmt::format("At the end {} m³ are unknown", ratio_text(end.fused_m3, 2));
    if (end.depth_m3)
        caption +=
            fmt::format("; the {} {} m³", has_several_cameras ? "cameras alone leave" : "camera alone leaves",
                        ratio_text(*end.depth_m3, 2));
    return caption + ".";
}

}  // namespace

std::string unknown_section(const ReportInput& input) {
    if (!input.results.unknown_space || input.results.unknown_space->samples.empty()) return {};
    const auto& space = *input.results.unknown_space;
    std::string html =
        fmt::format(fmt::runtime(kText), ratio_text(space.region.radius_m, 1), ratio_text(space.region_m3, 2),
                    escaped(input.main_configuration), input.picture_seed);
    if (space.samples.back().depth_m3) html += legend_entry("depth", map_title("depth", input));
    html += legend_entry("fused", map_title("fused", input)) + "</ul>\n<div class=\"charts\">\n";
    html += chart_figure(unknown_curves_svg(space), change_caption(space, input.cameras > 1)) +
            "</div>\n<div class=\"charts\">\n";
    const std::string most = ratio_text(unknown_column_max_m(space), 1);
    if (space.depth_columns)
        html += chart_figure(depth_columns_svg(space),
                             fmt::format(fmt::runtime(kDepthText), map_title("depth", input), most));
    std::string fused_text = fmt::format(fmt::runtime(kFusedText), most);
    if (!space.pockets.empty()) fused_text += kPocketText;
    html += chart_figure(fused_columns_svg(space, kPocketsShown), fused_text) + "</div>\n";
    if (!space.pockets.empty()) html += pocket_table(space);
    return html + "</section>\n";
}

}  // namespace octoskin::report
