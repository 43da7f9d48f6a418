#include "host/core/kinematics/self_hit.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {

Result<RobotBody, RobotModelFault> RobotBody::build(std::span<const LinkCapsule> capsules,
                                                    const RobotModel& model) {
    RobotBody body;
    for (const LinkCapsule& capsule : capsules) {
        const auto link = model.find_link(capsule.link);
        if (!link) return unexpected(RobotModelFault{RobotModelError::unreachable, capsule.link});
        body.capsules_.push_back({capsule.p_link_a, capsule.p_link_b, capsule.radius_m, *link});
    }
    return body;
}

void RobotBody::pose(std::span<const Eigen::Isometry3d> T_base_link, std::vector<PosedCapsule>& posed) const {
    posed.clear();
    for (const PosedCapsule& capsule : capsules_) {
        const Eigen::Isometry3d& T = T_base_link[capsule.link];
        posed.push_back({T * capsule.p_a, T * capsule.p_b, capsule.radius_m, capsule.link});
    }
}

void RobotBody::pose(const RobotModel& model, std::span<const Eigen::Isometry3d> T_base_link,
                     JointSet unknown, std::vector<PosedCapsule>& posed) const {
    pose(T_base_link, posed);
    std::optional<LinkId> looked_up;  // capsules of a link follow each other
    bool is_unknown = false;
    RobotModel::Whereabouts link;
    for (std::size_t i = 0; i < capsules_.size(); ++i) {
        const PosedCapsule& capsule = capsules_[i];
        if (looked_up != capsule.link) {
            looked_up = capsule.link;
            is_unknown = (model.joints_above(capsule.link) & unknown) != 0;
            if (is_unknown) link = model.whereabouts(capsule.link, T_base_link, unknown);
        }
        if (!is_unknown) continue;
        const double reach_m = std::max(capsule.p_a.norm(), capsule.p_b.norm()) + capsule.radius_m;
        posed[i] = {link.centre, link.centre, link.radius_m + reach_m, capsule.link};
    }
}

std::optional<double> predict_self_hit(std::span<const PosedCapsule> capsules, const Eigen::Vector3d& origin,
                                       const Eigen::Vector3d& direction,
                                       std::span<const LinkId> ignored) noexcept {
    std::optional<double> nearest;
    for (const PosedCapsule& capsule : capsules) {
        if (std::find(ignored.begin(), ignored.end(), capsule.link) != ignored.end()) continue;
        const auto range_m = ray_entry(capsule, origin, direction);
        if (range_m && (!nearest || *range_m < *nearest)) nearest = range_m;
    }
    return nearest;
}

namespace {

/// False only if the bounding sphere of the capsule lies outside the cone.
bool may_meet(const PosedCapsule& capsule, const Eigen::Vector3d& origin, const Eigen::Vector3d& axis,
              double half_angle_rad) {
    const Eigen::Vector3d to_middle = 0.5 * (capsule.p_a + capsule.p_b) - origin;
    const double radius = 0.5 * (capsule.p_b - capsule.p_a).norm() + capsule.radius_m;
    const double along = to_middle.dot(axis);
    const double aside = (to_middle - along * axis).norm();
    // Behind the origin the nearest point of a cone is its tip.
    return aside * std::cos(half_angle_rad) - along * std::sin(half_angle_rad) <= radius && along >= -radius;
}

}  // namespace

std::optional<double> predict_self_hit(std::span<const PosedCapsule> capsules, const Eigen::Vector3d& origin,
                                       std::span<const Eigen::Vector3d> directions, double half_angle_rad,
                                       std::span<const LinkId> ignored) noexcept {
    std::optional<double> nearest;
    for (const PosedCapsule& capsule : capsules) {
        if (!may_meet(capsule, origin, directions.front(), half_angle_rad)) continue;
        for (const Eigen::Vector3d& direction : directions) {
            const auto range_m = predict_self_hit({&capsule, 1}, origin, direction, ignored);
            if (range_m && (!nearest || *range_m < *nearest)) nearest = range_m;
        }
    }
    return nearest;
}

}  // namespace octoskin
