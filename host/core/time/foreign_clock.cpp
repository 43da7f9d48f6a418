#include "host/core/time/foreign_clock.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace octoskin {

void ForeignClock::on_follow_up(const wire::FollowUp& follow_up) {
    if (!open_ || open_->sequence != follow_up.sequence) return;
    newest_ = std::exchange(open_, std::nullopt)->heard;
    told_.push_back(HostTime{static_cast<std::int64_t>(follow_up.host_time_us) * 1000} - newest_);
    if (told_.size() > kKept) told_.pop_front();
    settle();
    outliers_ += settled_ && !agrees(told_.back()) ? 1U : 0U;
}

void ForeignClock::settle() {
    std::vector<Nanoseconds> sorted(told_.begin(), told_.end());
    std::ranges::sort(sorted);
    const Nanoseconds median = sorted[sorted.size() / 2];
    const auto agreeing = std::ranges::count_if(
        told_, [&](Nanoseconds ahead) { return std::chrono::abs(ahead - median) <= kAgreement; });
    if (static_cast<std::size_t>(agreeing) >= kAgreeing) settled_ = median;
}

std::optional<Nanoseconds> ForeignClock::ahead(HostTime now) const {
    const bool is_known = settled_ && agrees(told_.back()) && now - newest_ <= kSilenceMax;
    return is_known ? settled_ : std::nullopt;
}

}  // namespace octoskin
