#include "host/core/ingest/answer_check.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>

namespace octoskin {

std::optional<SampleVerdict> AnswerCheck::take(std::span<const SyncSample> answers, ClockMap& clock) {
    assert(!answers.empty());
    const HostTime host = answers.front().host;
    if (!taken_ || taken_->host != host) {
        taken_ = Taken{host, clock};
    }
    if (answers.size() == 1) {
        return clock.add(answers.front());
    }
    ++contradictions_;
    contradicted_ = host;
    clock = taken_->before;
    const auto fits = [&clock](const SyncSample& answer) { return clock.fits(answer); };
    if (std::ranges::count_if(answers, fits) != 1) {
        return std::nullopt;
    }
    return clock.add(*std::ranges::find_if(answers, fits));
}

bool AnswerCheck::hears_two(HostTime now) const noexcept {
    return contradicted_ && std::chrono::abs(now - *contradicted_) < kTold;
}

}  // namespace octoskin
