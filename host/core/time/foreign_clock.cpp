#include "host/core/time/foreign_clock.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace octoskin {

void ForeignClock::on_follow_up(const wire::FollowUp& follow_up) {
    if (!open_ || open_->sequence != follow_up.sequence) return;
    newest_ = std::exchange(open_, std::nullopt)->heard;
    reported_.push_back(HostTime{static_cast<std::int64_t>(follow_up.host_time_us) * 1000} - newest_);
    if (reported_.size() > kKept) reported_.pop_front();
    settle();
    outliers_ += settled_ && !agrees(reported_.back()) ? 1U : 0U;
}

void ForeignClock::settle() {
    std::vector<Nanoseconds> sorted(reported_.begin(), reported_.end());
    std::ranges::sort(sorted);
    const Nanoseconds median = sorted[sorted.size() / 2];
    const auto agreeing = std::ranges::count_if(
        reported_, [&](Nanoseconds ahead) { return std::chrono::abs(ahead - median) <= kAgreement; });
    if (static_cast<std::size_t>(agreeing) >= kAgreeing) settled_ = median;
}

std::optional<Nanoseconds> ForeignClock::ahead(HostTime now) const {
    const bool is_known = settled_ && agrees(reported_.back()) && now - newest_ <= kSilenceMax;
    return is_known ? settled_ : std::nullopt;
}

}  // namespace octoskin
