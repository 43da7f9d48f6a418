#include "host/core/kinematics/joint_history.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octoskin {

JointHistory::JointHistory(std::span<const JointLimits> limits, const JointHistoryConfig& config)
    : limits_(limits.begin(), limits.end()), config_(config), ring_(config.capacity) {
    assert(!limits_.empty() && limits_.size() <= kSourceJointsMax);
    assert(config_.capacity >= 2);
}

Status<JointRejection> JointHistory::add(HostTime sampled, std::span<const double> position) {
    if (position.size() != limits_.size()) return unexpected(JointRejection::wrong_count);
    if (!std::all_of(position.begin(), position.end(), [](double q) { return std::isfinite(q); })) {
        return unexpected(JointRejection::not_finite);
    }
    for (std::size_t i = 0; i < position.size(); ++i) {
        if (!limits_[i].hold(position[i], config_.limit_tolerance)) {
            return unexpected(JointRejection::outside_limits);
        }
    }
    if (size_ > 0 && sampled <= sample(size_ - 1).sampled) return unexpected(JointRejection::out_of_order);

    if (size_ == ring_.size()) {
        oldest_ = (oldest_ + 1) % ring_.size();
        --size_;
    }
    Sample& slot = ring_[(oldest_ + size_) % ring_.size()];
    slot.sampled = sampled;
    std::copy(position.begin(), position.end(), slot.values.begin());
    ++size_;
    return Done{};
}

Result<JointPosition, JointLookup> JointHistory::at(HostTime instant) const {
    const std::size_t after = first_not_before(instant);
    if (after == size_) return unexpected(JointLookup::not_yet);
    if (sample(after).sampled == instant) return interpolate(sample(after), sample(after), instant);
    if (after == 0) return unexpected(JointLookup::before_first);

    const Sample& left = sample(after - 1);
    const Sample& right = sample(after);
    const Nanoseconds nearest = std::min(instant - left.sampled, right.sampled - instant);
    if (nearest > config_.nearest_max || right.sampled - left.sampled > config_.bracket_max) {
        return unexpected(JointLookup::gap);
    }
    return interpolate(left, right, instant);
}

JointGap JointHistory::gap_about(HostTime instant) const {
    const std::size_t after = first_not_before(instant);
    assert(after > 0 && after < size_);
    const HostTime from = sample(after - 1).sampled;
    return {sample(after).sampled - from, instant, from};
}

const JointHistory::Sample& JointHistory::sample(std::size_t age_rank) const noexcept {
    return ring_[(oldest_ + age_rank) % ring_.size()];
}

/// The number of samples older than `instant`, by bisection.
std::size_t JointHistory::first_not_before(HostTime instant) const noexcept {
    std::size_t low = 0;
    std::size_t high = size_;
    while (low < high) {
        const std::size_t middle = low + (high - low) / 2;
        if (sample(middle).sampled < instant) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

JointPosition JointHistory::interpolate(const Sample& before, const Sample& after, HostTime instant) const {
    JointPosition position;
    position.count = limits_.size();
    const auto width = static_cast<double>((after.sampled - before.sampled).count());
    const double share = width > 0.0 ? static_cast<double>((instant - before.sampled).count()) / width : 0.0;
    for (std::size_t i = 0; i < position.count; ++i) {
        position.values[i] = before.values[i] + share * limits_[i].way(before.values[i], after.values[i]);
    }
    return position;
}

}  // namespace octoskin
