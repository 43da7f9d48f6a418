#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "host/apps/query/query_answer.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

std::string point(const Json& json) {
    return fmt::format("({:.3f}, {:.3f}, {:.3f}) m", json.at(0).get<double>(), json.at(1).get<double>(),
                       json.at(2).get<double>());
}

/// `bound`: a qualifier of the distance if some links are unknown, which may be nearer.
std::string clearance(const Json& leg, const std::string& kind, const std::string& what,
                      const std::string& bound) {
    const Json& gap = leg.at(kind + "_m");
    if (gap.is_null()) return {};
    return fmt::format("  nearest {} voxel: {}{:.3f} m from {}\n", what, bound, gap.get<double>(),
                       leg.at(kind + "_link").get<std::string>());
}

std::string listed(const Json& names) {
    std::string text;
    for (const Json& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
    return text;
}

bool has(const Json& names, const Json& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Links that could not be checked, because they have no body; empty if all have one.
std::string links_text(const Json& answer) {
    const Json& unknown = answer.at("links_unknown");
    Json on_purpose = Json::array();
    for (const Json& link : answer.at("links_without_body"))
        if (!has(unknown, link)) on_purpose.push_back(link);
    std::string text;
    if (!unknown.empty())
        text += fmt::format(
            "not checked: {}: without a body, so that nothing is called free (give {} capsules, or list {} "
            "in robot.links_without_body of the rig)\n",
            listed(unknown), unknown.size() == 1 ? "it" : "them", unknown.size() == 1 ? "it" : "them");
    if (!on_purpose.empty())
        text += fmt::format("not checked: {}: without a body, as listed in the rig\n", listed(on_purpose));
    for (const auto& [link, lender] : answer.at("links_with_borrowed_body").items())
        text += fmt::format("checked with the body of {}, to which it is fixed: {}\n",
                            lender.get<std::string>(), link);
    return text;
}

/// Empty for a map without ages.
std::string evidence(const Json& leg) {
    const Json& evidence = leg.at("evidence");
    if (evidence.is_null()) return {};
    if (evidence.at("age_s").is_null())
        return fmt::format("  weakest evidence: of unknown age, at {}\n", point(evidence.at("voxel_m")));
    const auto kind = evidence.at("kind").get<std::string>();
    return fmt::format(
        "  weakest evidence: {} s old, {}, at {}{}\n", evidence.at("age_s").get<std::uint32_t>(),
        kind == "none" ? "the arm's own space" : "of a " + kind + (kind == "range" ? " sensor" : ""),
        point(evidence.at("voxel_m")), evidence.at("is_stale").get<bool>() ? ": stale" : "");
}

/// Empty if nothing free is touched.
std::string free_evidence(const Json& way, std::string_view indent) {
    const Json& free = way.at("free_evidence");
    if (free.is_null()) return {};
    return fmt::format("{}free by at least: {:.1f} images and {:.1f} beams, at {}\n", indent,
                       free.at("images").get<double>(), free.at("beams").get<double>(),
                       point(free.at("voxel_m")));
}

std::string leg_text(const Json& answer, std::size_t index) {
    const Json& leg = answer.at("legs").at(index);
    const Json& unknown_links = answer.at("links_unknown");
    const bool is_path = answer.at("legs").size() > 1;
    const std::size_t number = index + 1;
    const std::string bound = unknown_links.empty() ? "" : "at most ";
    std::string text = is_path ? fmt::format("{:>4}  ", number) : std::string();
    text += leg.at("state").get<std::string>();
    const bool is_link_unknown = has(unknown_links, leg.at("link"));
    if (is_path && number > 1 && leg.at("state") != "free" && !is_link_unknown)
        text += fmt::format(" from {:.0f} % of the way", 100.0 * leg.at("share").get<double>());
    if (!leg.at("link").is_null()) text += ": " + leg.at("link").get<std::string>();
    if (is_link_unknown) text += " has no body";
    if (!leg.at("voxel_m").is_null()) text += " at " + point(leg.at("voxel_m"));
    return text + "\n" + clearance(leg, "occupied", "occupied", bound) +
           clearance(leg, "not_free", "not free", bound) + evidence(leg) + free_evidence(leg, "  ");
}

std::string postures_text(const Json& answer) {
    const Json& legs = answer.at("legs");
    (void)legs.at(0);  // throws: an answer is about at least one posture
    std::string text;
    for (std::size_t i = 0; i < legs.size(); ++i) text += leg_text(answer, i);
    if (legs.size() > 1)
        text += fmt::format("the path is {}: {} configurations, {} postures\n",
                            answer.at("state").get<std::string>(), legs.size(),
                            answer.at("postures").get<std::size_t>());
    return text + links_text(answer);
}

std::string view_text(const Json& view) {
    if (view.is_null()) return "       no view found\n";
    std::string joints;
    for (const Json& joint : view.at("joints"))
        joints += fmt::format("{}{:.3f}", joints.empty() ? "" : ",", joint.get<double>());
    return fmt::format("       {} sees it from {:.2f} m at {}, which is {}; the straight way there is {}\n{}",
                       view.at("sensor").get<std::string>(), view.at("range_m").get<double>(), joints,
                       view.at("state").get<std::string>(),
                       view.at("way").is_null() ? "not known" : view.at("way").get<std::string>(),
                       free_evidence(view, "       "));
}

/// In a unit in which the amount is not zero.
std::string unknown_share(double unknown_m3, double region_m3) {
    constexpr double kSmall_m3 = 0.1;
    if (region_m3 >= kSmall_m3) return fmt::format("{:.3f} of {:.3f} m3", unknown_m3, region_m3);
    return fmt::format("{:.3f} of {:.3f} l", 1000.0 * unknown_m3, 1000.0 * region_m3);
}

std::string pockets_text(const Json& answer) {
    std::string text = fmt::format(
        "{} unknown, {} pockets with free space beside them\n",
        unknown_share(answer.at("unknown_m3").get<double>(), answer.at("region_m3").get<double>()),
        answer.at("pockets_found").get<std::size_t>());
    const Json& why_not_tried = answer.at("views_not_tried");
    std::size_t number = 0;
    for (const Json& pocket : answer.at("pockets")) {
        text += fmt::format("{:>4}  {:.2f} l about {}, open at {}\n", ++number,
                            1000.0 * pocket.at("volume_m3").get<double>(), point(pocket.at("centre_m")),
                            point(pocket.at("border_m")));
        if (why_not_tried.is_null()) text += view_text(pocket.at("view"));
    }
    if (number > 0 && !why_not_tried.is_null())
        text += fmt::format("no view was tried: {}\n", why_not_tried.get<std::string>());
    return text + links_text(answer);
}

}  // namespace

std::string query_text(const Json& answer) {
    return answer.contains("pockets") ? pockets_text(answer) : postures_text(answer);
}

}  // namespace octoskin
