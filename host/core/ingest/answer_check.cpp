#include "host/core/ingest/answer_check.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>

namespace octoskin {
namespace {

bool are_one(std::span<const SyncSample> answers) {
    return std::ranges::all_of(answers, [&](const SyncSample& answer) {
        return std::chrono::abs(elapsed(answers.front().heard, answer.heard)) <= SyncExchange::kOneInstant;
    });
}

}  // namespace

std::optional<SampleEffect> AnswerCheck::take(std::span<const SyncSample> answers, ClockMap& clock) {
    assert(!answers.empty());
    const HostTime host = answers.front().host;
    const bool is_contested = answers.size() > 1;
    if (!taken_ || taken_->host != host) {
        taken_ = Taken{host, clock};
        if (!are_contested_) uncontested_.reset();
        are_contested_ = false;
    }
    if (!is_contested) {
        return clock.add(answers.front());
    }
    are_contested_ = true;
    if (!uncontested_) uncontested_ = taken_->before;
    if (!are_one(answers)) {
        ++contradictions_;
        contradicted_ = host;
    }
    clock = taken_->before;
    const auto own = own_of(answers);
    return own ? std::optional(clock.add(*own)) : std::nullopt;
}

/// If all answers may come from one sender: the first that fits the clock.
std::optional<SyncSample> AnswerCheck::own_of(std::span<const SyncSample> answers) const {
    const auto fits = [this](const SyncSample& answer) { return uncontested_->fits(answer); };
    const auto found = std::ranges::find_if(answers, fits);
    const bool is_one = are_one(answers) || std::ranges::count_if(answers, fits) == 1;
    return found != answers.end() && is_one ? std::optional(*found) : std::nullopt;
}

bool AnswerCheck::hears_two(HostTime now) const noexcept {
    return contradicted_ && std::chrono::abs(now - *contradicted_) < kTold;
}

}  // namespace octoskin
