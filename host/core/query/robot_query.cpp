#include "host/core/query/robot_query.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace octoskin {
namespace {

constexpr double kPaddingMax_m = 1.0;
constexpr double kLimitTolerance = 0.005;

/// True if a joint moves the point: with its followers, in a posture.
bool is_moved(const Eigen::Vector3d& p_base, std::span<const JointTwist> twists) {
    constexpr double kStill_m = 1e-9;  // per unit of the joint
    return std::ranges::any_of(twists, [&p_base](const JointTwist& twist) {
        return (twist.turn.cross(p_base) + twist.shift).norm() > kStill_m;
    });
}

/// True for each capsule that a joint moves. A capsule about the axis of the only joint that turns it does
/// not move. In a posture in which no joint is at a special position.
std::vector<bool> moved_by_joints(const RobotModel& robot, const RobotBody& body) {
    std::vector<double> position(robot.joint_count(), 0.0);
    for (std::size_t i = 0; i < position.size(); ++i) position[i] = 0.1 + 0.07 * static_cast<double>(i);
    std::vector<Eigen::Isometry3d> T_base_link(robot.link_count());
    robot.forward(position, T_base_link);
    std::vector<PosedCapsule> posed;
    body.pose(T_base_link, posed);
    std::vector<JointTwist> twists(robot.joint_count());
    std::vector<bool> moved;
    for (const PosedCapsule& capsule : posed) {
        robot.twists(capsule.link, T_base_link, twists);
        moved.push_back(is_moved(capsule.p_a, twists) || is_moved(capsule.p_b, twists));
    }
    return moved;
}

/// The links without a body that the rig does not list; a fault if the robot has no such link.
Result<std::vector<LinkId>, RobotQueryFault> unknown_links_of(const HostRig& rig, const RobotModel& robot) {
    std::vector<LinkId> links;
    for (const LinkWithoutBody& without : rig.links_without_body) {
        const auto link = robot.find_link(without.link);
        if (!link) return unexpected(RobotQueryFault{RobotQueryError::unknown_link, without.link});
        if (!without.is_listed) links.push_back(*link);
    }
    return links;
}

bool is_worse(const CapsuleAnswer& answer, double depth_m, const PostureAnswer& worst, double deepest_m) {
    const auto state = answer.state == Occupancy::occupied ? PostureState::occupied : PostureState::unknown;
    if (state != worst.state) return state > worst.state;
    return depth_m > deepest_m;
}

void take_nearest(const std::optional<double>& found_m, LinkId link, std::optional<double>& nearest_m,
                  std::optional<LinkId>& nearest_link) {
    if (!found_m || (nearest_m && *nearest_m <= *found_m)) return;
    nearest_m = found_m;
    nearest_link = link;
}

/// Distances beyond those found so far are not searched.
template <class ClearanceOf>
Result<PostureClearance, RefusedCapsule> least_clearance(std::span<const PosedCapsule> capsules,
                                                         PostureClearance least, const ClearanceOf& of) {
    for (std::size_t i = 0; i < capsules.size(); ++i) {
        const auto found = of(capsules[i], [&](double reach_m) {
            return ClearanceReach{std::min(reach_m, least.occupied_m.value_or(reach_m)),
                                  std::min(reach_m, least.not_free_m.value_or(reach_m))};
        });
        if (!found) return unexpected(RefusedCapsule{i, found.error()});
        take_nearest(found->occupied_m, capsules[i].link, least.occupied_m, least.occupied_link);
        take_nearest(found->not_free_m, capsules[i].link, least.not_free_m, least.not_free_link);
    }
    return least;
}

}  // namespace

std::string_view name(PostureState state) noexcept {
    constexpr std::array<std::string_view, 4> kNames{"free", "stale", "unknown", "occupied"};
    return kNames.at(static_cast<std::size_t>(state));
}

Result<RobotQuery, RobotQueryFault> RobotQuery::build(const HostRig& rig, const RobotModel& robot,
                                                      const RobotQueryConfig& config) {
    if (!(config.padding_m >= 0.0 && config.padding_m <= kPaddingMax_m))
        return unexpected(RobotQueryFault{RobotQueryError::bad_padding, {}});
    for (const std::string& link : config.links_ignored) {
        if (!robot.find_link(link)) return unexpected(RobotQueryFault{RobotQueryError::unknown_link, link});
    }
    const std::vector<LinkCapsule>& of_rig = config.is_of_certain_body ? rig.certain_body : rig.body;
    const auto whole = RobotBody::build(of_rig, robot);
    if (!whole) return unexpected(RobotQueryFault{RobotQueryError::unknown_link, whole.error().element});
    const std::vector<bool> moved = moved_by_joints(robot, *whole);
    std::vector<LinkCapsule> asked;
    for (std::size_t i = 0; i < of_rig.size(); ++i) {
        const LinkCapsule& capsule = of_rig[i];
        if (config.ignores_unmoved && !moved[i]) continue;
        if (std::ranges::find(config.links_ignored, capsule.link) == config.links_ignored.end())
            asked.push_back(capsule);
    }
    auto unknown = unknown_links_of(rig, robot);
    if (!unknown) return unexpected(unknown.error());
    if (asked.empty() && unknown->empty()) return unexpected(RobotQueryFault{RobotQueryError::no_body, {}});
    auto body = RobotBody::build(asked, robot);
    if (!body) return unexpected(RobotQueryFault{RobotQueryError::unknown_link, body.error().element});
    return RobotQuery(robot, std::move(body).value(), std::move(unknown).value(), rig.T_map_base,
                      asked.size(), config.padding_m);
}

RobotQuery::RobotQuery(const RobotModel& robot, RobotBody body, std::vector<LinkId> unknown_links,
                       const Eigen::Isometry3d& T_map_base, std::size_t capsules, double padding_m)
    : robot_(robot),
      body_(std::move(body)),
      unknown_links_(std::move(unknown_links)),
      T_map_base_(T_map_base),
      capsules_(capsules),
      padding_m_(padding_m) {}

std::optional<PostureFault> RobotQuery::fault_of(std::span<const double> position) const noexcept {
    const auto limits = robot_.limits();
    if (position.size() != limits.size())
        return PostureFault{PostureError::wrong_count, std::min(position.size(), limits.size())};
    for (std::size_t i = 0; i < position.size(); ++i) {
        if (!std::isfinite(position[i])) return PostureFault{PostureError::not_finite, i};
        if (!limits[i].hold(position[i], kLimitTolerance))
            return PostureFault{PostureError::outside_limits, i};
    }
    return std::nullopt;
}

Result<std::vector<PosedCapsule>, PostureFault> RobotQuery::pose(std::span<const double> position) const {
    if (const auto fault = fault_of(position)) return unexpected(*fault);
    return posed(position);
}

std::vector<PosedCapsule> RobotQuery::posed(std::span<const double> position) const {
    std::vector<Eigen::Isometry3d> T_base_link(robot_.link_count());
    robot_.forward(position, T_base_link);
    std::vector<PosedCapsule> posed;
    body_.pose(T_base_link, posed);
    for (PosedCapsule& capsule : posed) {
        capsule.p_a = T_map_base_ * capsule.p_a;
        capsule.p_b = T_map_base_ * capsule.p_b;
        capsule.radius_m += padding_m_;
    }
    return posed;
}

std::vector<LinkId> RobotQuery::links() const {
    const std::vector<Eigen::Isometry3d> anywhere(robot_.link_count(), Eigen::Isometry3d::Identity());
    std::vector<PosedCapsule> posed;
    body_.pose(anywhere, posed);
    std::vector<LinkId> links;
    for (const PosedCapsule& capsule : posed) links.push_back(capsule.link);
    std::ranges::sort(links);
    links.erase(std::unique(links.begin(), links.end()), links.end());
    return links;
}

double RobotQuery::lever_m(std::span<const double> farthest) const {
    // The distance of an end from its link's origin is the same in all postures.
    const std::vector<double> zero(robot_.joint_count(), 0.0);
    std::vector<Eigen::Isometry3d> T_base_link(robot_.link_count());
    robot_.forward(zero, T_base_link);
    std::vector<PosedCapsule> posed;
    body_.pose(T_base_link, posed);
    const std::vector<double> levers_m = robot_.levers_m(farthest);
    double lever_m = 0.0;
    for (const PosedCapsule& capsule : posed) {
        const Eigen::Vector3d p_base_link = T_base_link[capsule.link].translation();
        lever_m = std::max({lever_m, levers_m[capsule.link] + (capsule.p_a - p_base_link).norm(),
                            levers_m[capsule.link] + (capsule.p_b - p_base_link).norm()});
    }
    return lever_m;
}

Result<PostureAnswer, RefusedCapsule> worst_of(const RobotQuery& robot, const FusedMap& map,
                                               std::span<const PosedCapsule> capsules,
                                               const FreeDemand& demand) noexcept {
    PostureAnswer worst;
    double deepest_m = 0.0;
    for (std::size_t i = 0; i < capsules.size(); ++i) {
        const auto answer = worst_in(map, capsules[i]);
        if (!answer) return unexpected(RefusedCapsule{i, answer.error()});
        if (answer->state == Occupancy::free) continue;
        const double depth_m = capsules[i].radius_m - answer->distance_m;
        if (!is_worse(*answer, depth_m, worst, deepest_m)) continue;
        deepest_m = depth_m;
        worst = {answer->state == Occupancy::occupied ? PostureState::occupied : PostureState::unknown,
                 capsules[i].link, answer->voxel};
    }
    if (worst.state != PostureState::free) return worst;
    if (!robot.unknown_links().empty())
        return PostureAnswer{PostureState::unknown, robot.unknown_links().front(), std::nullopt};
    if (demand.sum_min > 0.0) {
        const auto free = weakest_free_of(map, demand.units, capsules);
        if (free && !demand.is_met_by(free->weakest.evidence))
            return PostureAnswer{PostureState::unknown, free->link, free->weakest.voxel};
    }
    const auto evidence = weakest_of(map, capsules);
    if (evidence && evidence->weakest.is_stale)
        worst = {PostureState::stale, evidence->link, evidence->weakest.voxel};
    return worst;
}

std::optional<PostureFree> weakest_free_of(const FusedMap& map, const MissUnits& units,
                                           std::span<const PosedCapsule> capsules,
                                           std::optional<PostureFree> than) noexcept {
    for (const PosedCapsule& capsule : capsules) {
        const auto before = than ? std::optional(than->weakest) : std::nullopt;
        const auto found = weakest_free_in(map, units, capsule, before);
        if (found && (!before || found->voxel != before->voxel)) than = PostureFree{*found, capsule.link};
    }
    return than;
}

std::optional<PostureEvidence> weakest_of(const FusedMap& map, std::span<const PosedCapsule> capsules,
                                          std::optional<PostureEvidence> than) noexcept {
    for (const PosedCapsule& capsule : capsules) {
        const auto before = than ? std::optional(than->weakest) : std::nullopt;
        const auto found = weakest_in(map, capsule, before);
        if (found && (!before || found->stamp < before->stamp)) than = PostureEvidence{*found, capsule.link};
    }
    return than;
}

Result<PostureClearance, RefusedCapsule> clearance_of(const FusedMap& map,
                                                      std::span<const PosedCapsule> capsules, double reach_m,
                                                      const PostureClearance& than) noexcept {
    return least_clearance(capsules, than, [&](const PosedCapsule& capsule, const auto& within) {
        return clearance(map, capsule, within(reach_m));
    });
}

Result<PostureClearance, RefusedCapsule> clearance_of(const DistanceField& field,
                                                      std::span<const PosedCapsule> capsules, double reach_m,
                                                      const PostureClearance& than) noexcept {
    return least_clearance(capsules, than, [&](const PosedCapsule& capsule, const auto& within) {
        return field.clearance(capsule, within(reach_m));
    });
}

Result<PostureClearance, RefusedCapsule> clearance_of(const DistanceField& field,
                                                      std::span<const PosedCapsule> capsules) noexcept {
    return least_clearance(capsules, {}, [&](const PosedCapsule& capsule, const auto& within) {
        return field.clearance(capsule, within(std::max(0.0, field.axis_reach_m() - capsule.radius_m)));
    });
}

}  // namespace octoskin
