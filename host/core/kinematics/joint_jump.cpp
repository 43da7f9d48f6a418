#include "host/core/kinematics/joint_jump.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

namespace octoskin {

JointJump::JointJump(std::span<const JointLimits> limits, const JointJumpConfig& config)
    : limits_(limits.begin(), limits.end()), config_(config) {
    assert(!limits_.empty() && limits_.size() <= kSourceJointsMax);
    assert(std::ranges::all_of(limits_, [](const JointLimits& limit) { return limit.velocity_max > 0.0; }));
}

JointJump::SampleFit JointJump::judge(HostTime sampled, std::span<const double> position,
                                      std::uint64_t clock) {
    assert(position.size() == limits_.size());
    if (clock != clock_) forget();
    clock_ = clock;
    Point point{sampled, {}};
    std::ranges::copy(position, point.position.begin());
    if (!used_) used_ = point;
    if (sampled > used_->sampled && !is_on_used_track(point)) {
        const bool is_used_silent = sampled - used_->sampled >= config_.heard_for;
        if (!is_used_silent) {
            note_jump(point);
            return SampleFit::jumped;
        }
        adopt(point);
    }
    if (sampled > used_->sampled) used_ = point;
    return hears_two(sampled) ? SampleFit::withheld : SampleFit::fits;
}

void JointJump::forget() noexcept {
    used_.reset();
    other_.reset();
    jumped_.reset();
    jumped_twice_.reset();
    strayed_.reset();
}

double JointJump::step_max(std::size_t joint, Nanoseconds passed) const {
    const double seconds = 1e-9 * static_cast<double>((passed + config_.time_uncertainty).count());
    return config_.velocity_margin * limits_[joint].velocity_max * seconds + config_.resolution;
}

JointJump::Distance JointJump::distance(const Point& from, const Point& to) const {
    const Nanoseconds passed = std::chrono::abs(to.sampled - from.sampled);
    Distance largest;
    for (std::size_t joint = 0; joint < limits_.size(); ++joint) {
        const double moved = std::abs(limits_[joint].way(from.position.at(joint), to.position.at(joint)));
        const double excess = moved / step_max(joint, passed);
        if (excess > largest.excess) largest = {excess, joint};
    }
    return largest;
}

/// The least time, at the velocity limits, in which the arm moves between the two points.
double JointJump::seconds_between(const Point& from, const Point& to) const {
    double longest = 0.0;
    for (std::size_t joint = 0; joint < limits_.size(); ++joint) {
        const double moved = std::abs(limits_[joint].way(from.position.at(joint), to.position.at(joint)));
        longest = std::max(longest, moved / limits_[joint].velocity_max);
    }
    return longest;
}

/// While only the other track has new samples, the allowed movement since the used track's newest sample
/// grows beyond the distance between the tracks. Then the track with the shorter travel time is taken.
bool JointJump::is_on_used_track(const Point& point) const {
    if (distance(*used_, point).excess > 1.0) return false;
    const bool is_other_newer =
        other_ && other_->sampled > used_->sampled && is_recent(other_->sampled, point.sampled);
    return !is_other_newer || seconds_between(*used_, point) <= seconds_between(*other_, point);
}

bool JointJump::hears_two(HostTime now) const {
    return jumped_twice_ && is_recent(*jumped_twice_, now);
}

bool JointJump::is_recent(HostTime earlier, HostTime now) const {
    return std::chrono::abs(now - earlier) < config_.heard_for;
}

void JointJump::note_jump(const Point& point) {
    const Distance far = distance(*used_, point);
    const Nanoseconds passed = std::chrono::abs(point.sampled - used_->sampled);
    newest_ = JointJumped{.joint = far.joint,
                          .from = used_->position.at(far.joint),
                          .to = point.position.at(far.joint),
                          .step_max = step_max(far.joint, passed),
                          .passed = passed,
                          .sampled = point.sampled};
    const bool has_other = other_ && is_recent(other_->sampled, point.sampled);
    if (has_other && distance(*other_, point).excess > 1.0) strayed_ = point.sampled;
    other_ = point;
    if (jumped_ && is_recent(*jumped_, point.sampled)) jumped_twice_ = point.sampled;
    jumped_ = point.sampled;
}

/// The used track is silent: changes to the track of `point`. The jumps belonged to this track, unless some
/// strayed.
void JointJump::adopt(const Point& point) {
    used_ = point;
    other_.reset();
    jumped_ = strayed_;
    jumped_twice_ = strayed_;
}

}  // namespace octoskin
