#include "host/core/cross_check/pose_judge.hpp"

#include <algorithm>

namespace octoskin {
namespace {

/// An explanation leads if it explains more by this margin, without the strongest single sensor. An error of
/// the camera has seven unknowns, a joint's error one, and fits part of every deviation. The camera must
/// therefore also lead by a fraction of all that it explains.
constexpr double kLead = 3.0;
constexpr double kLeadOfCamera = 0.25;
/// A shorter error or lead may come from one view of one object.
constexpr Nanoseconds kShortest{3'000'000'000};

/// By how much more one error explains than another, without the strongest single sensor.
double lead(const ErrorEvidence& of, const ErrorEvidence& to) {
    double sum = 0.0;
    double most = 0.0;
    for (std::size_t i = 0; i < of.said.size(); ++i) {
        const double more = of.said[i] - to.said[i];
        sum += more;
        most = std::max(most, more);
    }
    return sum - most;
}

}  // namespace

void PoseJudge::compare(std::uint16_t sensor, const RangeChange& change, const JointTwists& twists) {
    camera_.compare(sensor, change);
    joints_.compare(sensor, change, twists);
}

PoseJudge::Leader PoseJudge::leader() const {
    const ErrorEvidence& of_camera = camera_.evidence();
    const ErrorEvidence& of_joint = joints_.evidence();
    if (lead(of_joint, of_camera) >= kLead) return Leader::joint;
    const double enough = std::max(kLead, kLeadOfCamera * of_camera.evidence);
    return lead(of_camera, of_joint) >= enough ? Leader::camera : Leader::none;
}

void PoseJudge::decide(HostTime now) {
    camera_.decide();
    joints_.decide();
    const bool is_error = camera_.error() || joints_.error();
    const Leader leader = is_error ? this->leader() : Leader::none;
    if (leader != leader_ || now < leads_since_) leads_since_ = now;
    leader_ = leader;
    if (!is_error || now < errs_since_) errs_since_ = now;
    fault_.reset();
    if (!is_error || now - errs_since_ < kShortest) return;
    const bool is_alone = leader != Leader::none && now - leads_since_ >= kShortest;
    PoseFault fault;
    if (!is_alone || leader == Leader::camera) fault.camera = camera_.likeliest();
    // If no sensor supports any joint's error, there is nothing to compare.
    const bool is_any_joint = joints_.evidence().explained > 0;
    if (is_any_joint && (!is_alone || leader == Leader::joint)) fault.joint = joints_.likeliest();
    fault.explained = std::max(fault.camera ? camera_.evidence().explained : 0,
                               fault.joint ? joints_.evidence().explained : 0);
    fault_ = fault;
}

}  // namespace octoskin
