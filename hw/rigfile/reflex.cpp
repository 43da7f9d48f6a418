#include "hw/rigfile/reflex.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hw/rigfile/joined.hpp"

namespace octoskin::rig {
namespace {

struct Reach {
    const char* mode;
    double max_m;
};
/// Greatest range in the dark, white target: datasheet DS12385 rev 7, table 4.
Reach reach_of(DistanceMode mode) {
    if (mode == DistanceMode::short_range) return {"short", 1.36};
    if (mode == DistanceMode::medium_range) return {"medium", 2.9};
    return {"long", 3.6};
}

std::string line_of(std::uint16_t limit_mm, const std::vector<std::string>& sensors) {
    return limit_mm == 0 ? fmt::format("no REFLEX from {}", joined(sensors))
                         : fmt::format("REFLEX below {} m from {}", limit_mm / 1000.0, joined(sensors));
}

}  // namespace

std::vector<std::string> reflex_lines(const Node& node) {
    std::vector<std::pair<std::uint16_t, std::vector<std::string>>> groups;
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        const std::uint16_t limit_mm = node.config.sensors[i].reflex_below_mm;
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [limit_mm](const auto& known) { return known.first == limit_mm; });
        if (group == groups.end()) group = groups.insert(groups.end(), {limit_mm, {}});
        group->second.push_back(node.sensors[i].name);
    }
    if (groups.size() == 1 && groups.front().first == 0) return {"no REFLEX: no sensor has a reflex_below_m"};
    std::stable_partition(groups.begin(), groups.end(), [](const auto& group) { return group.first > 0; });
    std::vector<std::string> lines;
    lines.reserve(groups.size());
    for (const auto& [limit_mm, sensors] : groups) lines.push_back(line_of(limit_mm, sensors));
    return lines;
}

std::vector<std::string> reflex_warnings(const Rig& rig) {
    std::vector<std::string> warnings;
    for (const Node& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            const SensorConfig& config = node.config.sensors[i];
            if (config.reflex_below_mm == 0) continue;
            const double limit_m = config.reflex_below_mm / 1000.0;
            const Reach reach = reach_of(config.distance_mode);
            const std::string who = fmt::format("node '{}' sensor '{}': reflex_below_m {}", node.name,
                                                node.sensors[i].name, limit_m);
            if (limit_m > reach.max_m) {
                warnings.push_back(
                    fmt::format("{} is more than mode {} can measure, about {} m: an object "
                                "farther away sends no REFLEX",
                                who, reach.mode, reach.max_m));
            }
            if (limit_m < rig.range_limits.min_m) {
                warnings.push_back(
                    fmt::format("{} is below range_limits.min_m, {}: only ranges that the map "
                                "does not trust send REFLEX",
                                who, rig.range_limits.min_m));
            }
        }
    }
    return warnings;
}

}  // namespace octoskin::rig
