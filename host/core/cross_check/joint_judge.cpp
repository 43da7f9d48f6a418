#include "host/core/cross_check/joint_judge.hpp"

namespace octoskin {
namespace {

/// Prior standard deviation of a joint's offset: radians, or metres of a prismatic joint.
constexpr double kOffsetSigma = 0.1;

}  // namespace

void JointJudge::compare(std::uint16_t sensor, const RangeChange& change, const JointTwists& twists) {
    for (std::size_t joint = 0; joint < sensors_[sensor].size(); ++joint)
        sensors_[sensor][joint].add(Fit::Vector(change.of_joint(twists[joint])), change);
    for (auto& joints : sensors_)
        for (Fit& each : joints) each.forget();
}

void JointJudge::decide() {
    std::vector<ErrorShare<1>> shares(sensors_.size());
    evidence_ = {};
    likeliest_ = {};
    const std::size_t joints = sensors_.empty() ? 0 : sensors_.front().size();
    for (std::size_t joint = 0; joint < joints; ++joint) {
        for (std::size_t i = 0; i < sensors_.size(); ++i) shares[i] = sensors_[i][joint].without_own();
        ErrorEstimate<1> found(shares, Fit::Vector(kOffsetSigma));
        // A joint that moves no sensor gives no evidence.
        const bool says_something = found.evidence.sum > 0.0;
        const bool is_better = evidence_.sum <= 0.0 || found.evidence.evidence > evidence_.evidence;
        if (joint > 0 && !(says_something && is_better)) continue;
        evidence_ = std::move(found.evidence);
        likeliest_ = {.joint = joint, .offset = found.likeliest(0)};
    }
    const bool is_kept = error_ && evidence_.is_to_be_kept();
    if (is_kept || evidence_.is_to_be_named()) {
        error_ = likeliest_;
    } else {
        error_.reset();
    }
}

}  // namespace octoskin
