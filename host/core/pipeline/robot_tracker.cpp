#include "host/core/pipeline/robot_tracker.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace octoskin {

Result<RobotTracker, RobotModelFault> RobotTracker::build(const HostRig& rig, RobotModel robot,
                                                          const JointHistoryConfig& config) {
    Result<RobotBody, RobotModelFault> body = RobotBody::build(rig.body, robot);
    if (!body) {
        return unexpected(body.error());
    }
    return RobotTracker(std::move(robot), std::move(body).value(), config);
}

RobotTracker::RobotTracker(RobotModel robot, RobotBody body, const JointHistoryConfig& config)
    : robot_(std::move(robot)), body_(std::move(body)), joints_(robot_.limits(), config) {
    pose_.T_base_link.resize(robot_.link_count());
}

Status<JointReason> RobotTracker::add(const JointMeasurement& joints) {
    const auto position = std::span(joints.position_rad).first(robot_.joint_count());
    const auto added = joints_.add(joints.sampled, position);
    if (added) {
        return Done{};
    }
    return unexpected(added.error() == JointRejection::out_of_order ? JointReason::out_of_order
                                                                    : JointReason::out_of_limits);
}

const RobotPose* RobotTracker::at(HostTime instant) {
    const auto position = joints_.at(instant);
    if (!position) {
        if (position.error() == JointLookup::gap) note_gap(joints_.gap_about(instant));
        return nullptr;
    }
    robot_.forward(position->span(), pose_.T_base_link);
    body_.pose(pose_.T_base_link, pose_.body_base);
    return &pose_;
}

void RobotTracker::note_gap(const JointGap& gap) {
    constexpr Nanoseconds kRow{3'000'000'000};
    if (!newest_gap_ || gap.from - newest_gap_->from > kRow) gaps_in_a_row_ = 0;
    if (!newest_gap_ || gap.from != newest_gap_->from) ++gaps_in_a_row_;
    newest_gap_ = gap;
}

void RobotTracker::for_each_sample(const std::function<void(const JointMeasurement&)>& visit) const {
    joints_.for_each([&visit](HostTime sampled, std::span<const double> position) {
        JointMeasurement joints{sampled, {}};
        std::ranges::copy(position, joints.position_rad.begin());
        visit(joints);
    });
}

}  // namespace octoskin
