#include "host/core/pipeline/joint_gate.hpp"

namespace octoskin {

JointGate::JointGate(std::span<const JointLimits> limits, double tolerance)
    : limits_(limits.begin(), limits.end()), tolerance_(tolerance), jump_(limits) {}

Status<JointReason> JointGate::check(const JointMeasurement& joints) {
    const auto position = std::span(joints.position_rad).first(limits_.size());
    for (std::size_t i = 0; i < limits_.size(); ++i) {
        if (limits_[i].hold(position[i], tolerance_)) continue;
        beyond_ = {i, position[i], limits_[i], joints.sampled};
        return unexpected(JointReason::out_of_limits);
    }
    switch (jump_.judge(joints.sampled, position, joints.relocks)) {
        case JointJump::SampleFit::jumped:
            return unexpected(JointReason::joint_jump);
        case JointJump::SampleFit::withheld:
            return unexpected(JointReason::second_sender);
        case JointJump::SampleFit::fits:
            break;
    }
    return Done{};
}

}  // namespace octoskin
