#include "host/core/query/path_query.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octoskin {
namespace {

std::size_t postures_of(std::span<const double> from, std::span<const double> to, double step) {
    assert(from.size() == to.size() && step > 0.0);
    double longest = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]));
    // Rounding must not make one more of a way that is a whole number of steps.
    constexpr double kRounding = 1e-9;
    constexpr double kMost = 1e15;  // more would not fit a number; nobody asks about so many
    return static_cast<std::size_t>(std::clamp(std::ceil(longest / step - kRounding), 1.0, kMost));
}

bool is_blocked(const LegAnswer& answer, double reach_m) {
    return answer.worst.state == PostureState::occupied &&
           (!(reach_m > 0.0) || (answer.clearance.occupied_m && answer.clearance.not_free_m));
}

/// False if a capsule is refused.
bool take_posture(const FusedMap& map, std::span<const PosedCapsule> capsules, double share,
                  const LegConfig& config, LegAnswer& answer) {
    const auto worst = worst_of(map, capsules);
    if (!worst) return false;
    if (worst->state > answer.worst.state) {
        answer.worst = *worst;
        answer.share = share;
    }
    answer.evidence = weakest_of(map, capsules, answer.evidence);
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

Leg::Leg(std::span<const double> from, std::span<const double> to, double step)
    : from_(from.begin(), from.end()), to_(to.begin(), to.end()), postures_(postures_of(from, to, step)) {}

void Leg::position(std::size_t index, std::span<double> position) const noexcept {
    const double part = share(index);
    for (std::size_t i = 0; i < to_.size(); ++i) position[i] = from_[i] + part * (to_[i] - from_[i]);
    if (index + 1 == postures_) std::ranges::copy(to_, position.begin());
}

Result<LegAnswer, PostureFault> ask(const RobotQuery& robot, const FusedMap& map, const Leg& leg,
                                    const LegConfig& config) {
    LegAnswer answer;
    std::vector<double> position(robot.robot().joint_count());
    for (std::size_t i = 0; i < leg.postures() && !is_blocked(answer, config.reach_m); ++i) {
        if (config.is_ending && config.is_ending()) break;
        leg.position(i, position);
        const auto capsules = robot.pose(position);
        if (!capsules) return unexpected(capsules.error());
        if (!take_posture(map, *capsules, leg.share(i), config, answer))
            return unexpected(PostureFault{PostureError::too_far, 0});
    }
    return answer;
}

}  // namespace octoskin
