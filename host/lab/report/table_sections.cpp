#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host/lab/report/sections.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

using evaluation::MapSummary;

constexpr std::array<std::string_view, 5> kTableOne = {"occupied", "free", "missed", "incorrect", "lost"};

std::string paper_row(const evaluation::PaperRow& row) {
    std::string html = "<tr class=\"paper\"><th>Strong et al. 2021</th>";
    for (const auto count : {row.occupied, row.free, row.missed, row.incorrect}) {
        html += fmt::format("<td>{}</td>", count_text(static_cast<double>(count)));
    }
    return html + "<td>not given</td></tr>\n";
}

std::string our_row(const MapSummary& map, bool is_main) {
    std::string html = fmt::format("<tr{}><th>octoskin, <code>{}</code></th>",
                                   is_main ? " class=\"main\"" : "", escaped(map.configuration));
    for (const auto column : kTableOne) {
        html += fmt::format("<td>{}</td>", summary_text(map.at(column), {.is_count = true}));
    }
    return html + "</tr>\n";
}

/// "Fused, Missed falls by 30.1 % against the camera alone in the paper, by 29.9 % in `robust`."
std::string missed_sentence(const ReportInput& input) {
    const auto& paper = evaluation::kPaperTable;
    const auto change = [](double before, double after) {
        return signed_text(percent_text(after / before - 1.0));
    };
    std::string text =
        fmt::format("Fused against camera alone, Missed changes by {} in the paper",
                    change(static_cast<double>(paper[0].missed), static_cast<double>(paper[2].missed)));
    for (const auto& map : input.results.maps) {
        const auto* depth = find_map(input.results.maps, map.configuration, "depth");
        if (map.map == "fused" && depth != nullptr && *depth->at("missed").mean > 0.0) {
            text += fmt::format(", by {} in <code>{}</code>",
                                change(*depth->at("missed").mean, *map.at("missed").mean),
                                escaped(map.configuration));
        }
    }
    return text + ".";
}

std::vector<std::string> configurations_of(const ReportInput& input) {
    std::vector<std::string> names;
    for (const auto& map : input.results.maps) {
        if (std::ranges::find(names, map.configuration) == names.end()) {
            names.push_back(map.configuration);
        }
    }
    return names;
}

std::string metric_rows(const std::vector<const MapSummary*>& maps,
                        const std::optional<evaluation::PairedDifference>& difference) {
    std::string html;
    std::optional<evaluation::MetricGroup> group;
    for (const auto& field : evaluation::metric_fields()) {
        const auto has = [&](const MapSummary* map) { return has_group(map->metrics, field.group); };
        if (std::ranges::none_of(maps, has)) continue;
        if (group != field.group)
            html += fmt::format("<tr class=\"group\"><th colspan=\"{}\">{}</th></tr>\n",
                                maps.size() + (difference ? 2 : 1), title_of(field.group));
        group = field.group;
        std::string name(field.name);
        std::ranges::replace(name, '_', ' ');
        html += fmt::format("<tr><th>{}</th>", name);
        for (const auto* map : maps) {
            html +=
                fmt::format("<td>{}</td>", summary_text(map->at(field.name), {.is_count = field.is_count}));
        }
        if (difference) {
            html +=
                fmt::format("<td>{}</td>", summary_text(difference->metrics.find(field.name)->second,
                                                        {.is_count = field.is_count, .is_difference = true}));
        }
        html += "</tr>\n";
    }
    return html;
}

std::string configuration_table(const ReportInput& input, const std::string& configuration) {
    std::vector<const MapSummary*> maps;
    std::string head = "<tr><th>metric</th>";
    for (const auto& map : input.results.maps) {
        if (map.configuration == configuration) {
            maps.push_back(&map);
            head += fmt::format("<th>{}</th>", map_title(map.map, input));
        }
    }
    std::optional<evaluation::PairedDifference> difference;
    const auto* fused = find_map(input.results.maps, configuration, "fused");
    const auto* depth = find_map(input.results.maps, configuration, "depth");
    if (fused != nullptr && depth != nullptr) {
        difference = paired_difference(*fused, *depth);
        head += "<th>fused − depth, paired</th>";
    }
    return fmt::format(
        "<details{}>\n<summary>Configuration <code>{}</code></summary>\n<div class=\"table\"><table>\n"
        "<thead>{}</tr></thead>\n<tbody>\n{}</tbody></table></div>\n</details>\n",
        configuration == input.main_configuration ? " open" : "", escaped(configuration), head,
        metric_rows(maps, difference));
}

constexpr std::array<std::string_view, evaluation::kThicknessClasses> kThicknessTitles = {
    "rod, 5 to 8 mm", "rod, 10 to 16 mm", "rod, 20 to 40 mm", "rod, 70 to 90 mm", "board", "other"};

/// Shares of one class of thickness in the map with this title; empty without a voxel of it.
std::string thickness_row(std::string_view thickness, const std::string& map,
                          const evaluation::SeenShares& shares) {
    if (shares.voxels == 0) return "";
    std::string html = fmt::format("<tr><th>{}: {}</th><td>{}</td>", thickness, map,
                                   count_text(static_cast<double>(shares.voxels)));
    for (const auto& share : {shares.occupied_share(), shares.free_share(), shares.unknown_share(),
                              shares.body_2cm.free_share(), shares.body_5cm.free_share()})
        html += fmt::format("<td>{}</td>", ratio_text(share.value()));
    return html + "</tr>\n";
}

std::string thickness_rows(const std::vector<const MapSummary*>& maps, const ReportInput& input) {
    std::string html;
    const auto add = [&](std::string_view thickness, const MapSummary& map,
                         const evaluation::SeenShares& shares) {
        html += thickness_row(thickness, map_title(map.map, input), shares);
    };
    for (std::size_t i = 0; i < kThicknessTitles.size(); ++i) {
        for (const auto* map : maps) add(kThicknessTitles[i], *map, map->seen->by_class[i]);
    }
    for (const auto* map : maps) add("too coarse", *map, map->seen->too_coarse);
    return html;
}

constexpr std::string_view kThicknessText =
    R"(<section id="thickness">
<h2>What the {}, by thickness</h2>
<p>Surface voxels that a noise-free image has a pixel on, in <code>{}</code>, over all seeds; a voxel is of the thickest
solid seen in it. Too coarse: rods of 5 to 8 mm on which a pixel is more than 2 mm wider than the rod. Body: share of
spheres of 2 and 5 cm radius, 1 cm deep in a seen surface, whose voxels are all free: there a planner would collide.</p>
<div class="table"><table>
<thead><tr><th></th><th>voxels</th><th>occupied</th><th>free</th><th>unknown</th><th>body 2 cm</th><th>body 5 cm</th></tr></thead>
<tbody>
{}</tbody></table></div>
</section>
)";

/// A row for each bin in which a map has voxels. `bins_of`: of a map.
template <class BinsOf>
std::string free_rows(std::string_view title, const std::vector<const MapSummary*>& maps,
                      const BinsOf& bins_of) {
    std::string html;
    for (std::size_t i = 0; i < evaluation::kFreeBins; ++i) {
        const auto bin = [&](const MapSummary* map) { return bins_of(map->free_calibration)[i]; };
        if (std::ranges::none_of(maps, [&](const auto* map) { return bin(map).voxels > 0; })) continue;
        html +=
            fmt::format("<tr><th>{} {}{}</th>", title, i, i + 1 < evaluation::kFreeBins ? "" : " or more");
        for (const auto* map : maps) {
            const auto share = bin(map).surface_share();
            html += fmt::format("<td>{}</td><td>{}</td>", share ? percent_text(*share) : "",
                                count_text(static_cast<double>(bin(map).voxels)));
        }
        html += "</tr>\n";
    }
    return html;
}

constexpr std::string_view kFreeText =
    R"(<section id="free">
<h2>How free is free?</h2>
<p>Voxels that a map of <code>{}</code> calls free, over all seeds, by the number of images and ranges behind it, rounded
down: the share that is a surface after all, and the number of voxels.</p>
<div class="table"><table>
<thead><tr><th></th>{}</tr></thead>
<tbody>
{}</tbody></table></div>
</section>
)";

constexpr std::string_view kTableText =
    R"(<section id="paper">
<h2>{}</h2>
<p>Voxels of the judged region against the map of a noise-free camera that is moved round the scene without
the robot. Occupied and free: the same in both. Missed: occupied in truth, unknown in the map.
Incorrect: occupied in the map, not in truth. Lost{}: occupied in truth, free in the map; without it, Missed could be
lowered by clearing more.</p>
<div class="table"><table>
<thead><tr><th></th><th>Occupied</th><th>Free</th><th>Missed</th><th>Incorrect</th><th>Lost</th></tr></thead>
<tbody>
)";

constexpr std::string_view kPaperCaveat =
    R"( The paper’s scene, region and camera are not published in full, so counts can be compared in their proportions
only.</p>
)";

constexpr std::string_view kMetricsText =
    R"(<section id="metrics">
<h2>All metrics</h2>
<p>The first five as above. The others compare with the voxels that the world’s surfaces pass through; voxels inside a solid
are not judged. Occluded recall is over surface voxels more than two voxels from every voxel that the camera sees, object
recall over those of the objects that the scenario names as hidden. Coverage is the known share of the region; log loss and
Brier score judge its probabilities, with one half for unknown voxels. Seen by the camera: shares of the surface voxels that
a noise-free image has a pixel on; F1 of precision and their occupied share, and the plain F1 of that image; body tests as
below; availability, the share of clear spheres of 5 cm in seen space that are free. Mean ± standard deviation over the seeds.</p>
)";

}  // namespace

std::string cameras_title(const ReportInput& input) {
    return input.cameras > 1 ? fmt::format("{} depth cameras", input.cameras) : "Depth camera";
}

std::string map_title(std::string_view map, const ReportInput& input) {
    if (map == "depth") {
        return cameras_title(input) + " only";
    }
    if (map == "proximity") {
        return "Range sensors only";
    }
    return map == "fused" ? "Fused" : escaped(map);
}

std::string paper_section(const ReportInput& input) {
    const bool is_papers = input.results.is_papers_experiment;
    std::string html = fmt::format(fmt::runtime(kTableText),
                                   is_papers ? "Beside the paper’s table" : "Against a camera’s ground truth",
                                   is_papers ? ", the column that the paper leaves out" : "");
    for (const auto& row : evaluation::kPaperTable) {
        std::string rows = is_papers ? paper_row(row) : "";
        for (const auto& map : input.results.maps) {
            if (map.map == row.map) {
                rows += our_row(map, map.configuration == input.main_configuration);
            }
        }
        if (!rows.empty()) {
            html += fmt::format("<tr class=\"group\"><th colspan=\"6\">{}</th></tr>\n{}",
                                map_title(row.map, input), rows);
        }
    }
    html += "</tbody></table></div>\n";
    if (is_papers) {
        html += "<p>" + missed_sentence(input) + std::string(kPaperCaveat);
    }
    return html + "</section>\n";
}

std::string metrics_section(const ReportInput& input) {
    std::string html(kMetricsText);
    for (const auto& configuration : configurations_of(input)) {
        html += configuration_table(input, configuration);
    }
    return html + "</section>\n";
}

std::string thickness_section(const ReportInput& input) {
    std::vector<const MapSummary*> maps;
    for (const auto& map : input.results.maps) {
        if (map.configuration == input.main_configuration && map.seen) maps.push_back(&map);
    }
    if (maps.empty()) return "";
    return fmt::format(fmt::runtime(kThicknessText), input.cameras > 1 ? "cameras see" : "camera sees",
                       escaped(input.main_configuration), thickness_rows(maps, input));
}

std::string free_section(const ReportInput& input) {
    std::vector<const MapSummary*> maps;
    std::string head;
    for (const auto& map : input.results.maps) {
        if (map.configuration != input.main_configuration) continue;
        maps.push_back(&map);
        head += fmt::format("<th>{}</th><th>voxels</th>", map_title(map.map, input));
    }
    using evaluation::FreeCalibration;
    const std::string rows =
        free_rows("images:", maps, [](const FreeCalibration& free) { return free.images; }) +
        free_rows("beams:", maps, [](const FreeCalibration& free) { return free.beams; }) +
        free_rows("both, at least", maps, [](const FreeCalibration& free) { return at_least(free.sum); });
    if (rows.empty()) return "";
    return fmt::format(fmt::runtime(kFreeText), escaped(input.main_configuration), head, rows);
}

}  // namespace octoskin::report
