#include "host/apps/query/voxel_answer.hpp"

#include <Eigen/Core>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "host/apps/query/query_answer.hpp"
#include "host/apps/query/query_values.hpp"
#include "host/core/mapping/voxel_brick.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kVoxelWord = "voxel";

/// The same words as in the answer of a query: occupied space is occupied however old it is.
const char* state_name(const FusedMap& map, VoxelKey key) {
    switch (map.occupancy(key)) {
        case Occupancy::unknown:
            return "unknown";
        case Occupancy::occupied:
            return "occupied";
        case Occupancy::free:
            return map.is_stale(key) ? "stale" : "free";
    }
    return "";
}

Json number_or_null(float value) {
    return std::isnan(value) ? Json(nullptr) : Json(value);
}

}  // namespace

std::optional<Eigen::Vector3d> requested_point(std::string_view text) {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object() || json.size() != 1 || !json.contains("point_m")) return std::nullopt;
    const Json& list = json["point_m"];
    if (!list.is_array() || list.size() != 3) return std::nullopt;
    Eigen::Vector3d point;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!list[i].is_number()) return std::nullopt;
        point[static_cast<Eigen::Index>(i)] = list[i].get<double>();
    }
    return point.allFinite() ? std::optional(point) : std::nullopt;
}

bool is_voxel_request(const std::string& line) {
    return line.starts_with(kVoxelWord) && line.size() > kVoxelWord.size() &&
           (line[kVoxelWord.size()] == ' ' || line[kVoxelWord.size()] == '{');
}

Json answer_voxel(const std::string& line, const FusedMap& map) {
    const auto point = requested_point(std::string_view(line).substr(kVoxelWord.size()));
    if (!point)
        return query_refused({ExitCode::usage,
                              {.code = ErrorCode::bad_argument,
                               .what = "expected the point of a voxel",
                               .remedy = "ask: voxel {\"point_m\": [X, Y, Z]}, in metres, map frame"}});
    const auto key = map.key_of(*point);
    if (!key)
        return query_refused(
            {ExitCode::usage,
             {.code = ErrorCode::out_of_range, .what = "the point is outside of the octree"}});
    const VoxelState voxel = voxel_state(map.layers(), *key);
    const auto confirmation = map.confirmation(*key);
    const bool has_counts = map.layers().counts.has(brick_of(*key));
    return {{"ok", true},
            {"key", {key->x, key->y, key->z}},
            {"centre_m", point_json(map.centre_of(*key))},
            {"state", state_name(map, *key)},
            {"log_odds", number_or_null(voxel.log_odds)},
            {"hits", has_counts ? Json(voxel.hits) : Json(nullptr)},
            {"misses", has_counts ? Json(voxel.misses) : Json(nullptr)},
            {"age_s", confirmation ? Json(confirmation->age_s) : Json(nullptr)},
            {"kind", confirmation ? Json(name(confirmation->kind)) : Json(nullptr)}};
}

}  // namespace octoskin
