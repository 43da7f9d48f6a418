#include "host/core/query/path_query.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace octoskin {
namespace {

/// Upper limit of a point's movement in one part of a leg, in voxel edges.
constexpr double kMotionEdges = 0.5;

double longest_of(std::span<const double> from, std::span<const double> to) {
    double longest = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]));
    return longest;
}

/// Of all joints, also of those that mimic others.
double movement_of(const RobotQuery& robot, std::span<const double> from, std::span<const double> to) {
    const std::span<const double> movements = robot.robot().movements();
    double sum = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) sum += movements[i] * std::abs(to[i] - from[i]);
    return sum;
}

/// The first continuous joint for which two ways lead from one position to the other: planners wrap it, and
/// the shorter way is taken elsewhere.
std::optional<PostureFault> ambiguous_turn_of(const RobotQuery& robot, std::span<const double> from,
                                              std::span<const double> to) {
    const std::span<const JointLimits> limits = robot.robot().limits();
    for (std::size_t i = 0; i < from.size(); ++i)
        if (std::isinf(limits[i].min) && std::abs(to[i] - from[i]) > std::numbers::pi)
            return PostureFault{PostureError::ambiguous_turn, i};
    return std::nullopt;
}

/// Interpolates from `from`, at share 0, to `to`.
void go_to(double share, std::span<const double> from, std::span<const double> to,
           std::span<double> position) {
    for (std::size_t i = 0; i < to.size(); ++i) position[i] = from[i] + share * (to[i] - from[i]);
}

double farther_of(const PosedCapsule& a, const PosedCapsule& b) {
    return std::max((a.p_a - b.p_a).norm(), (a.p_b - b.p_b).norm());
}

/// Upper bound of the acceleration of any point of a capsule's axis, in m per way squared, for a way
/// travelled at constant joint speed. Joint i turns the velocity that a joint j further out gives a point.
/// That velocity is at most |dq_j| times the lever (dq_j of a follower: its multiplier times that of its
/// joint), and the lever is at most lever_m(); for a prismatic joint
/// it is |dq_j|, lever 1. The sum over all pairs of joints is the square of the total joint movement, times
/// the longer lever.
double acceleration_of(const RobotQuery& robot, std::span<const double> from, std::span<const double> to) {
    std::vector<double> farthest(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) farthest[i] = std::max(std::abs(from[i]), std::abs(to[i]));
    const double moved = movement_of(robot, from, to);
    return moved * moved * std::max(robot.lever_m(farthest), 1.0);
}

/// Upper bound of the speed of any point of each capsule's axis, in m per way. Between two samples the mean
/// speed is their distance; the speed differs from the mean by at most the acceleration over half the time. A
/// point between the ends of an axis is no faster than the faster end.
std::vector<double> speeds_of(const RobotQuery& robot, std::span<const double> from,
                              std::span<const double> to) {
    constexpr double kLook = 0.05;  // of all joints together: costs less than a tenth of the speed of an arm
    constexpr double kLooksMax = 500.0;
    const double looks = std::clamp(std::ceil(movement_of(robot, from, to) / kLook), 1.0, kLooksMax);
    std::vector<double> speeds(robot.capsule_count(), 0.0);
    std::vector<double> position(from.begin(), from.end());
    auto before = robot.posed(position);
    for (double look = 1.0; look <= looks; look += 1.0) {
        go_to(look / looks, from, to, position);
        auto now = robot.posed(position);
        for (std::size_t i = 0; i < speeds.size(); ++i)
            speeds[i] = std::max(speeds[i], farther_of(before[i], now[i]) * looks);
        before = std::move(now);
    }
    const double change = acceleration_of(robot, from, to) * 0.5 / looks;
    for (double& speed : speeds) speed += change;
    return speeds;
}

std::size_t parts_of(double longest, double step, double fastest, double motion_max_m) {
    // Rounding must not add a part to a way of a whole number of steps.
    constexpr double kRounding = 1e-9;
    constexpr double kMost = 1e15;  // the limit of a number; far more than any query needs
    const double parts = std::max(std::ceil(longest / step - kRounding), std::ceil(fastest / motion_max_m));
    return static_cast<std::size_t>(std::clamp(parts, 1.0, kMost));
}

bool is_blocked(const LegAnswer& answer, double reach_m) {
    return answer.worst.state == PostureState::occupied &&
           (!(reach_m > 0.0) || (answer.clearance.occupied_m && answer.clearance.not_free_m));
}

/// Returns false if a capsule is refused.
bool take_posture(const RobotQuery& robot, const FusedMap& map, std::span<const PosedCapsule> capsules,
                  double share, const LegConfig& config, LegAnswer& answer) {
    const auto worst = worst_of(robot, map, capsules, config.demand);
    if (!worst) return false;
    if (worst->state > answer.worst.state) {
        answer.worst = *worst;
        answer.share = share;
    }
    answer.evidence = weakest_of(map, capsules, answer.evidence);
    answer.free = weakest_free_of(map, config.demand.units, capsules, answer.free);
    ++answer.postures;
    if (!(config.reach_m > 0.0)) return true;
    const auto clearance = config.field != nullptr
                               ? clearance_of(*config.field, capsules, config.reach_m, answer.clearance)
                               : clearance_of(map, capsules, config.reach_m, answer.clearance);
    if (!clearance) return false;
    answer.clearance = *clearance;
    return true;
}

}  // namespace

Leg::Leg(const RobotQuery& robot, const FusedMap& map, std::span<const double> from,
         std::span<const double> to, double step)
    : from_(from.begin(), from.end()),
      to_(to.begin(), to.end()),
      fault_(ambiguous_turn_of(robot, from, to)),
      margins_m_(robot.capsule_count(), 0.0) {
    assert(from.size() == robot.robot().joint_count() && to.size() == from.size() && step > 0.0);
    const double longest = longest_of(from, to);
    if (!(longest > 0.0) || fault_) return;
    margins_m_ = speeds_of(robot, from, to);
    // A robot whose moving links are all unknown has no capsule.
    const double fastest = margins_m_.empty() ? 0.0 : std::ranges::max(margins_m_);
    parts_ = parts_of(longest, step, fastest, kMotionEdges * map.resolution_m());
    for (double& margin_m : margins_m_) margin_m *= 0.5 / static_cast<double>(parts_);
}

void Leg::position(std::size_t index, std::span<double> position) const noexcept {
    if (index < parts_) return go_to(share(index), from_, to_, position);
    std::ranges::copy(to_, position.begin());
}

Result<std::vector<PosedCapsule>, PostureFault> Leg::pose(const RobotQuery& robot, std::size_t index) const {
    assert(robot.capsule_count() == margins_m_.size());
    if (fault_) return unexpected(*fault_);
    std::vector<double> at(to_.size());
    position(index, at);
    auto capsules = robot.pose(at);
    if (!capsules || index >= parts_) return capsules;
    for (std::size_t i = 0; i < margins_m_.size(); ++i) (*capsules)[i].radius_m += margins_m_[i];
    return capsules;
}

Result<LegAnswer, PostureFault> ask(const RobotQuery& robot, const FusedMap& map, const Leg& leg,
                                    const LegConfig& config) {
    LegAnswer answer;
    for (std::size_t i = 0; i < leg.postures() && !is_blocked(answer, config.reach_m); ++i) {
        if (config.is_ending && config.is_ending()) break;
        const auto capsules = leg.pose(robot, i);
        if (!capsules) return unexpected(capsules.error());
        if (!take_posture(robot, map, *capsules, leg.share(i), config, answer))
            return unexpected(PostureFault{PostureError::too_far, 0});
    }
    return answer;
}

}  // namespace octoskin
