#include "host/apps/query/query_values.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

Json link_json(const std::optional<LinkId>& link, const RobotModel& robot) {
    return link ? Json(robot.link_names()[*link]) : Json(nullptr);
}

Json evidence_json(const std::optional<PostureEvidence>& evidence, const FusedMap& map,
                   const RobotModel& robot) {
    if (!evidence) return nullptr;
    const auto& confirmation = evidence->weakest.confirmation;
    return {{"age_s", confirmation ? Json(confirmation->age_s) : Json(nullptr)},
            {"kind", confirmation ? Json(name(confirmation->kind)) : Json(nullptr)},
            {"is_stale", evidence->weakest.is_stale},
            {"link", link_json(evidence->link, robot)},
            {"voxel_m", point_json(map.centre_of(evidence->weakest.voxel))}};
}

}  // namespace

Json rounded(const std::optional<double>& metres) {
    constexpr double kPerMetre = 1e6;
    return metres ? Json(std::round(*metres * kPerMetre) / kPerMetre + 0.0) : Json(nullptr);  // avoids "-0.0"
}

Json seconds_json(const std::optional<WallTime>& time) {
    return time ? Json(std::round(1e-6 * static_cast<double>(time->ns)) / 1e3) : Json(nullptr);
}

Json point_json(const Eigen::Vector3d& point) {
    return {rounded(point.x()), rounded(point.y()), rounded(point.z())};
}

Json free_json(const std::optional<PostureFree>& free, const FusedMap& map, const RobotModel& robot) {
    if (!free) return nullptr;
    const FreeEvidence& evidence = free->weakest.evidence;
    return {{"images", evidence.images},
            {"beams", evidence.beams},
            {"link", link_json(free->link, robot)},
            {"voxel_m", point_json(map.centre_of(free->weakest.voxel))}};
}

Json leg_json(const LegAnswer& answer, const FusedMap& map, const RobotModel& robot) {
    const auto& voxel = answer.worst.voxel;
    return {{"state", name(answer.worst.state)},
            {"share", answer.share},
            {"link", link_json(answer.worst.link, robot)},
            {"voxel_m", voxel ? point_json(map.centre_of(*voxel)) : Json(nullptr)},
            {"occupied_m", rounded(answer.clearance.occupied_m)},
            {"occupied_link", link_json(answer.clearance.occupied_link, robot)},
            {"not_free_m", rounded(answer.clearance.not_free_m)},
            {"not_free_link", link_json(answer.clearance.not_free_link, robot)},
            {"evidence", evidence_json(answer.evidence, map, robot)},
            {"free_evidence", free_json(answer.free, map, robot)}};
}

}  // namespace octoskin
