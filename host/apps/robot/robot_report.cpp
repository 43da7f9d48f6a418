#include "host/apps/robot/robot_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "host/core/text/printable.hpp"

namespace octoskin {
namespace {

using nlohmann::ordered_json;

/// A link that moves and has no body.
bool is_missing(const LinkBody& link) {
    return link.is_moving && link.source == BodySource::nothing;
}

std::string limits_of(const rig::ShapedJoint& joint) {
    if (!joint.lower || !joint.upper) return "";
    return fmt::format(" from {:g} to {:g} {}", *joint.lower, *joint.upper,
                       joint.kind == "prismatic" ? "m" : "rad");
}

std::string source_text(const LinkBody& link) {
    if (link.source == BodySource::visual)
        return fmt::format("from its <visual> ({}), for want of a <collision>", link.shapes);
    return "from " + link.shapes;
}

std::string fit_text(const BodyFit& fit) {
    const FitMeasures& measures = fit.measures;
    const std::string many = fit.capsules.size() > kCapsulesFew ? " (more than 8)" : "";
    const std::string ratio =
        measures.excess_ratio
            ? fmt::format(", {:.2f} of the hull's volume outside of it", *measures.excess_ratio)
            : "";
    return fmt::format(
        "{} capsule{}{} cover all within {:g} mm{}; beyond the mesh 95 % up to {:.0f} mm, at most {:.0f} mm",
        fit.capsules.size(), fit.capsules.size() == 1 ? "" : "s", many, 1e3 * kCoveredWithin_m, ratio,
        1e3 * measures.protrusion_p95_m, 1e3 * measures.protrusion_max_m);
}

ordered_json or_null(const std::optional<double>& value) {
    return value ? ordered_json(*value) : ordered_json();
}

}  // namespace

std::string robot_text(const RobotFit& robot) {
    std::string text = fmt::format("{} links at or below {}, {} moving joints\n", robot.links.size(),
                                   printable(robot.shapes.base_link), robot.shapes.joints.size());
    for (const rig::ShapedJoint& joint : robot.shapes.joints)
        text += fmt::format("  joint {}: {}{}\n", printable(joint.name), joint.kind, limits_of(joint));
    for (const LinkBody& link : robot.links) {
        const std::string name =
            fmt::format("  link {}{}: ", printable(link.link), link.is_moving ? "" : " (fixed)");
        if (link.source == BodySource::nothing) {
            if (is_missing(link)) text += name + "no body: it has no shape, and counts as a frame\n";
            continue;
        }
        text += name + source_text(link);
        if (link.fit) text += ": " + fit_text(*link.fit);
        text += "\n";
        for (const std::string& file : link.files) text += fmt::format("    {}\n", printable(file));
    }
    return text;
}

ordered_json robot_json(const RobotFit& robot) {
    ordered_json json{{"base_link", printable(robot.shapes.base_link)},
                      {"joints", ordered_json::array()},
                      {"links", ordered_json::array()},
                      {"missing", ordered_json::array()}};
    for (const rig::ShapedJoint& joint : robot.shapes.joints) {
        json["joints"].push_back({{"name", printable(joint.name)},
                                  {"kind", joint.kind},
                                  {"lower", or_null(joint.lower)},
                                  {"upper", or_null(joint.upper)}});
    }
    for (const LinkBody& link : robot.links) {
        if (is_missing(link)) json["missing"].push_back(printable(link.link));
        ordered_json files = ordered_json::array();
        for (const std::string& file : link.files) files.push_back(printable(file));
        ordered_json entry{{"name", printable(link.link)},
                           {"moves", link.is_moving},
                           {"body", name_of(link.source)},
                           {"shapes", link.shapes},
                           {"kept", link.kept},
                           {"files", std::move(files)},
                           {"triangles", link.triangles},
                           {"capsules", link.fit ? link.fit->capsules.size() : 0}};
        const FitMeasures measures = link.fit ? link.fit->measures : FitMeasures{};
        const auto measured = [&](double value) { return link.fit ? ordered_json(value) : ordered_json(); };
        entry["covered_within_m"] = measured(kCoveredWithin_m);
        entry["excess_ratio"] = or_null(measures.excess_ratio);
        entry["protrusion_p95_m"] = measured(measures.protrusion_p95_m);
        entry["protrusion_p99_m"] = measured(measures.protrusion_p99_m);
        entry["protrusion_max_m"] = measured(measures.protrusion_max_m);
        json["links"].push_back(std::move(entry));
    }
    return json;
}

}  // namespace octoskin
