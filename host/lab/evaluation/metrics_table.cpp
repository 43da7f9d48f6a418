#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "host/lab/evaluation/results.hpp"

namespace octoskin::evaluation {
namespace {

constexpr std::array<std::string_view, 5> kTableOne = {"occupied", "free", "missed", "incorrect", "lost"};
constexpr std::string_view kUndefined = "-";

std::string count_text(const std::optional<double>& value) {
    return value ? fmt::format("{:.0f}", *value) : std::string(kUndefined);
}

/// A difference that rounds to 0 is printed without a sign.
std::string without_negative_zero(std::string number) {
    const bool is_zero = number.find_first_of("123456789") == std::string::npos;
    if (is_zero && number.starts_with('-')) number.erase(0, 1);
    return number;
}

/// "0.620 ± 0.045", "2165 ± 30", with a sign if it is a difference.
std::string summary_text(const Summary& summary, bool is_count, bool is_difference) {
    if (!summary.mean) {
        return std::string(kUndefined);
    }
    const int digits = is_count ? 0 : 3;
    const std::string mean =
        without_negative_zero(is_difference ? fmt::format("{:+.{}f}", *summary.mean, digits)
                                            : fmt::format("{:.{}f}", *summary.mean, digits));
    return summary.sd ? fmt::format("{} ± {:.{}f}", mean, *summary.sd, digits) : mean;
}

void add_table_one(std::string& text, const Results& results) {
    constexpr std::string_view kPaper = "Strong et al. 2021, Table I";
    constexpr std::string_view kColumns = "{:<{}}{:<12}{:>11}{:>11}{:>11}{:>11}{:>11}\n";
    auto out = std::back_inserter(text);
    std::size_t width = results.is_papers_experiment ? kPaper.size() : 0;
    width = std::max(width, std::string_view("configuration").size());
    for (const auto& map : results.maps) {
        width = std::max(width, map.configuration.size());
    }
    width += 3;
    const bool has_seeds =
        std::ranges::any_of(results.maps, [](const auto& map) { return map.seeds.size() > 1; });
    fmt::format_to(out, "Voxels against the camera ground truth{}\n", has_seeds ? ", mean of the seeds" : "");
    fmt::format_to(out, kColumns, "configuration", width, "map", "Occupied", "Free", "Missed", "Incorrect",
                   "Lost");
    if (results.is_papers_experiment) {
        for (const auto& row : kPaperTable) {
            fmt::format_to(out, kColumns, kPaper, width, row.map, row.occupied, row.free, row.missed,
                           row.incorrect, kUndefined);
        }
    }
    for (const auto& map : results.maps) {
        fmt::format_to(out, "{:<{}}{:<12}", map.configuration, width, map.map);
        for (const auto column : kTableOne) {
            fmt::format_to(out, "{:>11}", count_text(map.at(column).mean));
        }
        fmt::format_to(out, "\n");
    }
}

/// A column of one of the tables below: a map, or a difference.
struct Column {
    std::string title;
    const MetricSummaries* metrics;
    bool is_difference;
};

std::string seeds_text(std::size_t seeds) {
    return seeds == 1 ? "one seed" : fmt::format("mean ± sd of {} seeds", seeds);
}

void add_columns(std::string& text, std::string_view heading, const std::vector<Column>& columns) {
    auto out = std::back_inserter(text);
    fmt::format_to(out, "\n{:<20}", heading);
    for (const auto& column : columns) {
        fmt::format_to(out, "{:>20}", column.title);
    }
    fmt::format_to(out, "\n");
    std::optional<MetricGroup> group;
    for (const auto& field : metric_fields()) {
        const auto has = [&](const Column& column) { return has_group(*column.metrics, field.group); };
        if (std::ranges::none_of(columns, has)) continue;
        if (group != field.group) fmt::format_to(out, "  [{}]\n", title_of(field.group));
        group = field.group;
        fmt::format_to(out, "{:<20}", field.name);
        for (const auto& column : columns) {
            const auto& summary = column.metrics->find(field.name)->second;
            fmt::format_to(out, "{:>20}", summary_text(summary, field.is_count, column.is_difference));
        }
        fmt::format_to(out, "\n");
    }
}

std::string share_text(const std::optional<double>& share) {
    return share ? fmt::format("{:.3f}", *share) : std::string(kUndefined);
}

void add_shares(std::string& text, std::string_view thickness, std::string_view map,
                const SeenShares& shares) {
    if (shares.voxels == 0) return;
    fmt::format_to(std::back_inserter(text), "{:<20}{:<12}{:>9}{:>11}{:>9}{:>9}{:>10}{:>10}\n", thickness,
                   map, shares.voxels, share_text(shares.occupied_share()), share_text(shares.free_share()),
                   share_text(shares.unknown_share()), share_text(shares.body_2cm.free_share()),
                   share_text(shares.body_5cm.free_share()));
}

/// Seen voxels by the thickness of what is seen in them, for the maps of one configuration.
void add_thickness(std::string& text, const Results& results, std::string_view configuration) {
    std::vector<const MapSummary*> maps;
    for (const auto& map : results.maps) {
        if (map.configuration == configuration && map.seen) maps.push_back(&map);
    }
    if (maps.empty()) return;
    fmt::format_to(std::back_inserter(text), "\n{:<20}{:<12}{:>9}{:>11}{:>9}{:>9}{:>10}{:>10}\n",
                   "seen thickness", "map", "voxels", "occupied", "free", "unknown", "body_2cm", "body_5cm");
    for (const ThicknessClass thickness : kEveryThickness) {
        for (const auto* map : maps)
            add_shares(text, name_of(thickness), map->map,
                       map->seen->by_class[static_cast<std::size_t>(thickness)]);
    }
    for (const auto* map : maps) add_shares(text, "too_coarse", map->map, map->seen->too_coarse);
}

/// One row for each bin in which a map has voxels. `bins_of`: of a map.
template <class BinsOf>
void add_free_bins(std::string& text, std::string_view title, const std::vector<const MapSummary*>& maps,
                   const BinsOf& bins_of) {
    auto out = std::back_inserter(text);
    for (std::size_t i = 0; i < kFreeBins; ++i) {
        const auto bin = [&](const MapSummary* map) { return bins_of(map->free_calibration)[i]; };
        if (std::ranges::none_of(maps, [&](const auto* map) { return bin(map).voxels > 0; })) continue;
        fmt::format_to(out, "{:<20}", fmt::format("{} {}{}", title, i, i + 1 < kFreeBins ? "" : "+"));
        for (const auto* map : maps) {
            const std::string share = share_text(bin(map).surface_share());
            fmt::format_to(out, "{:>20}", fmt::format("{} ({})", share, bin(map).voxels));
        }
        fmt::format_to(out, "\n");
    }
}

/// How often free voxels are a surface, by the evidence behind them, for the maps of one configuration.
void add_free_calibration(std::string& text, const Results& results, std::string_view configuration) {
    std::vector<const MapSummary*> maps;
    fmt::format_to(std::back_inserter(text), "\n{:<20}", "free: surface share");
    for (const auto& map : results.maps) {
        if (map.configuration != configuration) continue;
        maps.push_back(&map);
        fmt::format_to(std::back_inserter(text), "{:>20}", fmt::format("{} (voxels)", map.map));
    }
    text += "\n";
    add_free_bins(text, "images", maps, [](const FreeCalibration& free) { return free.images; });
    add_free_bins(text, "beams", maps, [](const FreeCalibration& free) { return free.beams; });
    add_free_bins(text, "both, at least", maps,
                  [](const FreeCalibration& free) { return at_least(free.sum); });
}

/// One table per configuration: its maps, and what fusion adds to the camera, paired.
void add_configurations(std::string& text, const Results& results) {
    auto out = std::back_inserter(text);
    std::vector<std::string_view> done;
    for (const auto& first : results.maps) {
        if (std::ranges::find(done, first.configuration) != done.end()) {
            continue;
        }
        done.push_back(first.configuration);
        std::vector<Column> columns;
        for (const auto& map : results.maps) {
            if (map.configuration == first.configuration) {
                columns.push_back({map.map, &map.metrics, false});
            }
        }
        const std::string paired = fmt::format("{0}/fused - {0}/depth", first.configuration);
        const auto difference = std::ranges::find(results.paired, paired, &PairedDifference::name);
        if (difference != results.paired.end()) {
            columns.push_back({"fused - depth", &difference->metrics, true});
        }
        fmt::format_to(out, "\n{}, {}", first.configuration, seeds_text(first.seeds.size()));
        add_columns(text, "metric", columns);
        add_thickness(text, results, first.configuration);
        add_free_calibration(text, results, first.configuration);
    }
}

void add_paired(std::string& text, const Results& results) {
    auto out = std::back_inserter(text);
    const std::string heading = "paired difference, seed by seed";
    std::size_t width = heading.size();
    for (const auto& difference : results.paired) {
        width = std::max(width, difference.name.size());
    }
    fmt::format_to(out, "\n{:<{}}{:>16}{:>14}{:>14}\n", heading, width, "f1", "missed", "incorrect");
    for (const auto& difference : results.paired) {
        const auto column = [&](std::string_view metric, bool is_count) {
            return summary_text(difference.metrics.find(metric)->second, is_count, true);
        };
        fmt::format_to(out, "{:<{}}{:>16}{:>14}{:>14}\n", difference.name, width, column("f1", false),
                       column("missed", true), column("incorrect", true));
    }
}

void add_times(std::string& text, const Results& results) {
    auto out = std::back_inserter(text);
    fmt::format_to(out, "\n{:<40}{:>12}{:>12}\n", "part", "wall s", "CPU s");
    for (const auto& time : results.times) {
        fmt::format_to(out, "{:<40}{:>12.2f}{:>12.2f}\n", time.part, time.wall_s, time.cpu_s);
    }
}

}  // namespace

std::string metrics_table(const Results& results) {
    std::string text;
    add_table_one(text, results);
    add_configurations(text, results);
    if (!results.paired.empty()) {
        add_paired(text, results);
    }
    if (!results.times.empty()) {
        add_times(text, results);
    }
    return text;
}

}  // namespace octoskin::evaluation
