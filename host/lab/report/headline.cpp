#include <fmt/format.h>

#include "host/lab/report/sections.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

using evaluation::MapSummary;
using evaluation::Summary;

struct Contest {
    const MapSummary& depth;
    const MapSummary& fused;
    evaluation::PairedDifference difference;

    [[nodiscard]] bool has(std::string_view metric) const {
        return depth.at(metric).mean && fused.at(metric).mean;
    }
};

/// "paired: +0.062 ± 0.019, better in 5 of 5 seeds"
std::string paired_note(const Summary& paired, Style style, bool is_more_better) {
    int better = 0;
    int all = 0;
    for (const auto& value : paired.per_seed) {
        better += value && (is_more_better ? *value > 0.0 : *value < 0.0) ? 1 : 0;
        all += value ? 1 : 0;
    }
    if (all < 2) {
        return summary_text(paired, style);
    }
    return fmt::format("{}, better in {} of {} seeds", summary_text(paired, style), better, all);
}

std::string tile(std::string_view what, const std::string& from, const std::string& to,
                 const std::string& note) {
    return fmt::format(
        "<div class=\"tile\"><div class=\"what\">{}</div><div class=\"big\"><span class=\"from\">{} "
        "→</span> {}</div><div class=\"note\">{}</div></div>\n",
        what, from, to, note);
}

std::string share_tile(const Contest& contest, std::string_view metric, std::string_view what) {
    if (!contest.has(metric)) {
        return {};
    }
    return tile(what, percent_text(*contest.depth.at(metric).mean),
                percent_text(*contest.fused.at(metric).mean),
                paired_note(contest.difference.metrics.find(metric)->second, {.is_difference = true}, true));
}

std::string fewer_is_better_tile(const Contest& contest, std::string_view metric, std::string_view what) {
    const double before = *contest.depth.at(metric).mean;
    const double after = *contest.fused.at(metric).mean;
    const auto& paired = contest.difference.metrics.find(metric)->second;
    std::string note = paired_note(paired, {.is_count = true, .is_difference = true}, false);
    if (before > 0.0) {
        note = signed_text(percent_text(after / before - 1.0)) + "; " + note;
    }
    return tile(what, count_text(before), count_text(after), note);
}

std::string f1_tile(const Contest& contest) {
    if (!contest.has("f1")) {
        return {};
    }
    return tile("F1 against the true surfaces", ratio_text(*contest.depth.at("f1").mean),
                ratio_text(*contest.fused.at("f1").mean),
                paired_note(contest.difference.metrics.find("f1")->second, {.is_difference = true}, true));
}

constexpr std::string_view kLeadText =
    R"(Of the surfaces that the external camera cannot see, its own map contains {}; with the range sensors on the arm, the
fused map contains {}.)";
constexpr std::string_view kLeadTextOfSeveral =
    R"(Of the surfaces that no external camera can see, the cameras’ own map contains {}; with the range sensors on the arm,
the fused map contains {}.)";

std::string lead_sentence(const Contest& contest, const ReportInput& input) {
    if (!contest.has("occluded_recall")) {
        return {};
    }
    std::string text = fmt::format(fmt::runtime(input.cameras > 1 ? kLeadTextOfSeveral : kLeadText),
                                   percent_text(*contest.depth.at("occluded_recall").mean),
                                   percent_text(*contest.fused.at("occluded_recall").mean));
    if (contest.has("object_recall")) {
        text += fmt::format(
            " Of what it cannot see of the objects that the scenario names as hidden ({}): {} and {}.",
            hidden_objects_text(input), percent_text(*contest.depth.at("object_recall").mean),
            percent_text(*contest.fused.at("object_recall").mean));
    }
    if (contest.has("precision")) {
        text += fmt::format(" Of all that the fused map calls occupied, {} truly is.",
                            percent_text(*contest.fused.at("precision").mean));
    }
    return text;
}

std::string plain_tile(std::string_view what, const std::string& value) {
    return fmt::format("<div class=\"tile\"><div class=\"what\">{}</div><div class=\"big\">{}</div></div>\n",
                       what, value);
}

/// For a rig without a camera: there is no map to compare with.
std::string ranges_headline(const MapSummary& map, const ReportInput& input) {
    const auto share = [&](std::string_view metric, std::string_view what) {
        const auto& mean = map.at(metric).mean;
        return mean ? plain_tile(what, percent_text(*mean)) : std::string();
    };
    std::string html =
        "<p class=\"lead\">What the range sensors on the arm found; this rig has no camera.</p>\n";
    html += "<div class=\"tiles\">\n" + share("recall", "Surfaces that the map contains");
    html += share("object_recall", "The same, on " + hidden_objects_text(input) + " only");
    html += share("precision", "Of what it calls occupied, truly surface");
    html +=
        plain_tile("Missed: occupied voxels that the map does not know", count_text(*map.at("missed").mean));
    html += plain_tile("Lost: occupied voxels that the map calls free", count_text(*map.at("lost").mean));
    return html + "</div>\n";
}

std::string origin_line(std::string_view what, std::string_view configuration, std::size_t seeds,
                        std::string_view spread) {
    const std::string over = seeds == 1 ? "one seed" : fmt::format("mean of {} seeds{}", seeds, spread);
    return fmt::format("<p class=\"soft\">{}, configuration <code>{}</code>, {}.</p>\n", what,
                       escaped(configuration), over);
}

}  // namespace

std::string hidden_objects_text(const ReportInput& input) {
    std::string text;
    for (const auto& object : input.hidden_objects) {
        text += (text.empty() ? "" : ", ") + escaped(object);
    }
    return text;
}

std::string headline_section(const ReportInput& input) {
    std::string html = fmt::format("<header>\n<h1>{}</h1>\n", escaped(input.title));
    const auto* depth = find_map(input.results.maps, input.main_configuration, "depth");
    const auto* fused = find_map(input.results.maps, input.main_configuration, "fused");
    if (depth != nullptr && fused != nullptr) {
        const Contest contest{*depth, *fused, paired_difference(*fused, *depth)};
        const std::string lead = lead_sentence(contest, input);
        html += lead.empty() ? "" : fmt::format("<p class=\"lead\">{}</p>\n", lead);
        html += "<div class=\"tiles\">\n";
        html += share_tile(contest, "occluded_recall",
                           input.cameras > 1 ? "Surfaces out of the cameras’ sight that the map contains"
                                             : "Surfaces out of the camera’s sight that the map contains");
        html += share_tile(contest, "object_recall", "The same, on the objects named as hidden");
        html += fewer_is_better_tile(contest, "missed", "Missed: occupied voxels that the map does not know");
        html += fewer_is_better_tile(contest, "lost", "Lost: occupied voxels that the map calls free");
        html += f1_tile(contest) + "</div>\n";
        html += origin_line(cameras_title(input) + " alone → fused", input.main_configuration,
                            fused->seeds.size(),
                            "; differences are paired seed by seed, ± one standard deviation");
    } else if (const auto* ranges = find_map(input.results.maps, input.main_configuration, "proximity")) {
        html += ranges_headline(*ranges, input);
        html += origin_line("Range sensors only", input.main_configuration, ranges->seeds.size(), "");
    }
    return html + "</header>\n";
}

}  // namespace octoskin::report
