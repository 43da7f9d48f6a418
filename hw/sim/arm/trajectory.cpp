#include "hw/sim/arm/trajectory.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace octoskin::sim {
namespace {

constexpr const char* kMoveCircle = "move the circle or the start posture";

}  // namespace

Eigen::Isometry3d CircleMotion::T_base_link(std::uint32_t tick) const {
    const double angle = 2.0 * std::numbers::pi * tick / ticks_per_revolution;
    Eigen::Isometry3d T_base_link = Eigen::Isometry3d::Identity();
    T_base_link.linear() = R_base_link;
    T_base_link.translation() =
        p_base_centre + radius_m * (std::cos(angle) * towards_start + std::sin(angle) * towards_quarter);
    return T_base_link;
}

Result<Trajectory, Error> Trajectory::circle(const Arm& arm, const CircleMotion& motion, SimTime start) {
    assert(motion.ticks() > 0 && motion.tick_rate_hz > 0.0);
    const auto failure = [](const char* key, Error error) {
        error.key = key;
        return unexpected(std::move(error));
    };
    if (!arm.has_link(motion.link)) {
        std::string links;
        for (const std::string& link : arm.links()) links.append(links.empty() ? "" : ", ").append(link);
        return failure("motion.circle.link",
                       {ErrorCode::unknown_name, "expected a link of the robot, which has " + links,
                        "'" + motion.link + "'", "give --scenario a file for this robot"});
    }
    if (static_cast<std::size_t>(motion.start_position.size()) != arm.joint_count()) {
        return failure("motion.circle.start_position_rad", {ErrorCode::mismatch,
                                                            "expected one number for each of the robot's " +
                                                                std::to_string(arm.joint_count()) + " joints",
                                                            std::to_string(motion.start_position.size())});
    }
    Trajectory trajectory(start, motion.tick_rate_hz);
    Eigen::VectorXd position = motion.start_position;
    for (std::uint32_t tick = 0; tick <= motion.ticks(); ++tick) {
        const auto solved = arm.inverse(motion.link, motion.T_base_link(tick), position);
        if (!solved) {
            return failure(
                "motion.circle",
                {.code = ErrorCode::out_of_range,
                 .what = "'" + motion.link + "' does not reach its place at tick " + std::to_string(tick),
                 .remedy = kMoveCircle});
        }
        position = *solved;
        if (const auto joint = arm.joint_outside_limits(position)) {
            return failure(
                "motion.circle",
                {ErrorCode::out_of_range,
                 "expected joint '" + joint->joint + "' at tick " + std::to_string(tick) + " from " +
                     std::to_string(joint->lower) + " to " + std::to_string(joint->upper),
                 std::to_string(joint->position), kMoveCircle});
        }
        trajectory.ticks_.push_back(position);
    }
    return trajectory;
}

Eigen::VectorXd Trajectory::at(SimTime time) const {
    const double ticks = static_cast<double>(time.us - start_.us) * 1e-6 * tick_rate_hz_;
    if (ticks <= 0.0) {
        return ticks_.front();
    }
    if (ticks >= static_cast<double>(ticks_.size() - 1)) {
        return ticks_.back();
    }
    const auto before = static_cast<std::size_t>(ticks);
    const double part = ticks - static_cast<double>(before);
    return ticks_[before] + part * (ticks_[before + 1] - ticks_[before]);
}

SimTime Trajectory::end() const noexcept {
    const double seconds = static_cast<double>(ticks_.size() - 1) / tick_rate_hz_;
    return {start_.us + static_cast<std::int64_t>(std::llround(seconds * 1e6))};
}

}  // namespace octoskin::sim
