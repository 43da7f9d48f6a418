#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "host/apps/explain/explanation.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;
using Share = std::pair<BeamSource, SourceShare>;

const char* name(Occupancy occupancy) {
    if (occupancy == Occupancy::occupied) return "occupied";
    return occupancy == Occupancy::free ? "free" : "unknown";
}

double seconds_of(const Explanation& explanation, HostTime time) {
    return std::chrono::duration<double>(time - explanation.begin.value_or(HostTime{})).count();
}

std::string name_of(const Explanation& explanation, const BeamSource& source) {
    const auto found = explanation.names.find(source);
    if (found != explanation.names.end()) return found->second;
    return fmt::format("node {} sensor {} zone {}", source.node_id, source.sensor, source.zone);
}

/// The sources with the largest change come first.
std::vector<Share> by_weight(const Explanation& explanation) {
    const auto& all = explanation.trace.shares();
    std::vector<Share> shares(all.begin(), all.end());
    std::ranges::stable_sort(shares, [](const Share& a, const Share& b) {
        return std::abs(a.second.change) > std::abs(b.second.change);
    });
    return shares;
}

std::string plural(std::uint64_t count, const char* one, const char* many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string about_camera(const Explanation& explanation, const std::string& camera,
                         const BeamSource& source) {
    const auto found = explanation.trace.shares().find(source);
    if (found == explanation.trace.shares().end()) return camera + " never saw it";
    const SourceShare& share = found->second;
    const std::string occupied = plural(share.hits, "frame", "frames");
    const std::string free = plural(share.misses, "frame", "frames");
    // Frames are counted even if the voxel is at a clamp, where a frame changes nothing.
    if (share.misses == 0) return fmt::format("{} saw it occupied in {}, and never free", camera, occupied);
    if (share.hits == 0) return fmt::format("{} saw it free in {}, and never occupied", camera, free);
    return fmt::format("{} saw it occupied in {} and free in {}", camera, occupied, free);
}

/// After another part of a sentence, what the cameras saw, apart from the one `besides`.
std::string about_cameras(const Explanation& explanation, const BeamSource* besides = nullptr) {
    if (explanation.cameras.empty()) {
        const BeamSource only = source_of_camera(0);
        if (besides != nullptr && *besides == only) return {};
        return "; " + about_camera(explanation, "the camera", only);
    }
    std::string text;
    for (std::size_t i = 0; i < explanation.cameras.size(); ++i) {
        const BeamSource source = source_of_camera(i);
        if (besides != nullptr && *besides == source) continue;
        text += "; " + about_camera(explanation, name_of(explanation, source), source);
    }
    return text;
}

/// The source with the largest change towards the final state.
std::optional<Share> main_cause(const Explanation& explanation) {
    const bool is_up = explanation.occupancy == Occupancy::occupied;
    std::optional<Share> cause;
    for (const Share& share : by_weight(explanation)) {
        const double kept = share.second.kept;
        if (!(is_up ? kept > 0.0 : kept < 0.0)) continue;
        if (!cause || std::abs(kept) > std::abs(cause->second.kept)) cause = share;
    }
    return cause;
}

/// The state before the recording contributed more towards the final state than any source.
bool is_mainly_of_before(const Explanation& explanation, const std::optional<Share>& cause) {
    if (explanation.trace.forgotten().times > 0) return false;
    const double before = static_cast<double>(explanation.trace.begin().value_or(0.0F));
    const bool is_up = explanation.occupancy == Occupancy::occupied;
    return (is_up ? before > 0.0 : before < 0.0) &&
           (!cause || std::abs(before) > std::abs(cause->second.kept));
}

std::string when(const Explanation& explanation, const Forgotten& forgotten) {
    if (!forgotten.last) return "while the map waited for its first measurement";
    return fmt::format("at {:.3f} s", seconds_of(explanation, *forgotten.last));
}

std::string when(const Explanation& explanation, const SourceShare& share) {
    const double first_s = seconds_of(explanation, share.first);
    if (share.first == share.last) return fmt::format("at {:.3f} s", first_s);
    return fmt::format("between {:.3f} and {:.3f} s", first_s, seconds_of(explanation, share.last));
}

std::string table_of_shares(const Explanation& explanation) {
    std::string text = fmt::format("  {:<24} {:>6} {:>7} {:>9}  {:>9} {:>9}\n", "source", "hits", "misses",
                                   "log-odds", "first s", "last s");
    if (const auto before = explanation.trace.begin()) {
        fmt::format_to(std::back_inserter(text), "  {:<24} {:>6} {:>7} {:>+9.4f}\n", "before the recording",
                       "-", "-", static_cast<double>(*before));
    }
    for (const auto& [source, share] : by_weight(explanation)) {
        fmt::format_to(std::back_inserter(text), "  {:<24} {:>6} {:>7} {:>+9.4f}  {:>9.3f} {:>9.3f}\n",
                       name_of(explanation, source), share.hits, share.misses, share.change,
                       seconds_of(explanation, share.first), seconds_of(explanation, share.last));
    }
    if (const Forgotten& forgotten = explanation.trace.forgotten(); forgotten.times > 0) {
        const std::string last =
            forgotten.last ? fmt::format("{:.3f}", seconds_of(explanation, *forgotten.last)) : "-";
        fmt::format_to(std::back_inserter(text), "  {:<24} {:>6} {:>7} {:>+9.4f}  {:>9} {:>9}\n",
                       "expired or retracted", "-", "-", forgotten.change, "", last);
    }
    return text;
}

std::string line_of(const Explanation& explanation, const Contribution& contribution) {
    const std::string range = contribution.range_m ? fmt::format("{:.3f}", *contribution.range_m) : "-";
    const Eigen::Vector3d& p = contribution.p_map_sensor;
    const std::string from = is_camera(contribution.source)
                                 ? fmt::format("frame {}", contribution.frame)
                                 : fmt::format("{:.3f} {:.3f} {:.3f}", p.x(), p.y(), p.z());
    return fmt::format("  {:>9.3f}  {:<24} {:>8} {:<24} {:>+9.4f} {:>+9.4f} {:>9.4f}\n",
                       seconds_of(explanation, contribution.captured),
                       name_of(explanation, contribution.source), range, from,
                       static_cast<double>(contribution.term), contribution.change(),
                       static_cast<double>(contribution.after));
}

Json to_json(const Eigen::Vector3d& vector) {
    return {vector.x(), vector.y(), vector.z()};
}

Json json_of(const std::optional<float>& log_odds) {
    return log_odds ? Json(static_cast<double>(*log_odds)) : Json(nullptr);
}

Json json_of(const Explanation& explanation, const Forgotten& forgotten) {
    return {{"times", forgotten.times},
            {"change", forgotten.change},
            {"last_s", forgotten.last ? Json(seconds_of(explanation, *forgotten.last)) : Json(nullptr)}};
}

Json json_of(const Explanation& explanation, const BeamSource& source) {
    if (is_camera(source)) {
        Json json{{"name", "camera"}};
        if (source.sensor < explanation.cameras.size()) json["camera"] = explanation.cameras[source.sensor];
        return json;
    }
    return {{"name", name_of(explanation, source)},
            {"node", source.node_id},
            {"sensor", source.sensor},
            {"zone", source.zone}};
}

Json json_of(const Explanation& explanation, const Contribution& contribution) {
    Json json{{"source", json_of(explanation, contribution.source)},
              {"time_s", seconds_of(explanation, contribution.captured)},
              {"captured_ns", contribution.captured.ns},
              {"term", static_cast<double>(contribution.term)},
              {"change", contribution.change()},
              {"log_odds", static_cast<double>(contribution.after)}};
    if (is_camera(contribution.source)) {
        json["frame"] = contribution.frame;
    } else {
        json["range_m"] = contribution.range_m ? Json(*contribution.range_m) : Json(nullptr);
        json["sensor_m"] = to_json(contribution.p_map_sensor);
        json["direction"] = to_json(contribution.direction_map);
    }
    return json;
}

}  // namespace

std::string conclusion_of(const Explanation& explanation) {
    if (explanation.no_room > 0) {
        return fmt::format(
            "unknown: the map was full and had no room for {} to it; raise map.memory_max_mib in the mapping "
            "file",
            plural(explanation.no_room, "contribution", "contributions"));
    }
    if (explanation.trace.count() == 0 && !explanation.trace.begin())
        return "unknown: no reading and no depth frame ever reached it";
    if (const Forgotten& forgotten = explanation.trace.forgotten(); forgotten.is_last) {
        return fmt::format("{}, expired {}: no sensor had confirmed it for age.unknown_after_s{}",
                           name(explanation.occupancy), when(explanation, forgotten),
                           about_cameras(explanation));
    }
    const auto cause = main_cause(explanation);
    if (is_mainly_of_before(explanation, cause) && explanation.trace.count() > 0) {
        return fmt::format("{}, mainly from the map before the recording{}", name(explanation.occupancy),
                           about_cameras(explanation));
    }
    if (!cause) {
        const bool is_of_begin = explanation.trace.begin() && explanation.trace.forgotten().times == 0;
        const char* why = is_of_begin ? "unchanged since the beginning of the recording"
                                      : "by contributions that cancel each other";
        return fmt::format("{}, {}{}", name(explanation.occupancy), why, about_cameras(explanation));
    }
    const auto& [source, share] = *cause;
    const bool is_only_camera = is_camera(source) && explanation.cameras.empty();
    const std::string kind = is_only_camera ? "the " : is_camera(source) ? "" : "sensor ";
    const bool is_up = explanation.occupancy == Occupancy::occupied;
    return fmt::format("{}, mainly by {}{} {}, {}{}", name(explanation.occupancy), kind,
                       name_of(explanation, source), when(explanation, share),
                       is_up ? plural(share.hits, "hit", "hits") : plural(share.misses, "miss", "misses"),
                       about_cameras(explanation, &source));
}

std::string to_text(const Explanation& explanation) {
    const VoxelTrace& trace = explanation.trace;
    const Eigen::Vector3d& centre = explanation.centre;
    std::string text =
        fmt::format("voxel about {:.3f} {:.3f} {:.3f} m, edge {} m: {}", centre.x(), centre.y(), centre.z(),
                    explanation.resolution_m, name(explanation.occupancy));
    if (trace.log_odds()) text += fmt::format(", log-odds {:.4f}", static_cast<double>(*trace.log_odds()));
    text += '\n';
    if (trace.count() > 0 || trace.begin()) {
        text += table_of_shares(explanation);
        if (!trace.newest().empty()) {
            text += fmt::format("the newest {} of {}:\n", trace.newest().size(), trace.count());
            text += fmt::format("  {:>9}  {:<24} {:>8} {:<24} {:>9} {:>9} {:>9}\n", "time s", "source",
                                "range m", "sensor at, m", "term", "change", "log-odds");
        }
        for (const Contribution& contribution : trace.newest()) text += line_of(explanation, contribution);
    }
    return text + conclusion_of(explanation) + '\n';
}

Json to_json(const Explanation& explanation) {
    Json shares = Json::array();
    for (const auto& [source, share] : by_weight(explanation)) {
        shares.push_back({{"source", json_of(explanation, source)},
                          {"hits", share.hits},
                          {"misses", share.misses},
                          {"change", share.change},
                          {"first_s", seconds_of(explanation, share.first)},
                          {"last_s", seconds_of(explanation, share.last)}});
    }
    Json contributions = Json::array();
    for (const Contribution& contribution : explanation.trace.newest())
        contributions.push_back(json_of(explanation, contribution));
    return {{"point_m", to_json(explanation.p_map)},
            {"centre_m", to_json(explanation.centre)},
            {"resolution_m", explanation.resolution_m},
            {"occupancy", name(explanation.occupancy)},
            {"log_odds_at_begin", json_of(explanation.trace.begin())},
            {"log_odds", json_of(explanation.trace.log_odds())},
            {"forgotten", json_of(explanation, explanation.trace.forgotten())},
            {"contributions_without_room", explanation.no_room},
            {"contributions_in_all", explanation.trace.count()},
            {"sources", std::move(shares)},
            {"contributions", std::move(contributions)},
            {"conclusion", conclusion_of(explanation)}};
}

}  // namespace octoskin
