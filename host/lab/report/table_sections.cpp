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
    for (const auto& field : evaluation::metric_fields()) {
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
            head += fmt::format("<th>{}</th>", map_title(map.map));
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
Brier score judge its probabilities, with one half for unknown voxels. Mean ± standard deviation over the seeds.</p>
)";

}  // namespace

std::string map_title(std::string_view map) {
    if (map == "depth") {
        return "Depth camera only";
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
            html += fmt::format("<tr class=\"group\"><th colspan=\"6\">{}</th></tr>\n{}", map_title(row.map),
                                rows);
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

}  // namespace octoskin::report
