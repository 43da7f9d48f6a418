#include "host/core/ingest/sent_count.hpp"

#include <algorithm>

namespace octoskin {
namespace {

std::uint64_t beyond(std::uint64_t sent, std::uint64_t received) {
    return sent > received ? sent - received : 0;
}

}  // namespace

void SentCount::on_arrival() noexcept {
    missing_ = 0;
    missing_since_.reset();
}

void SentCount::on_health(std::uint16_t sent, std::uint64_t received, std::optional<HostTime> now) {
    if (!newest_) {
        sent_ = 0;
        newest_ = sent;
        received_first_ = received;
        received_newest_ = received;
    }
    const auto step = static_cast<std::uint16_t>(sent - *newest_);
    if (step > std::uint16_t{0xFFFF} - kBackMax) return;
    newest_ = sent;
    sent_ += step;
    lost_ = lost_before_ + beyond(sent_, received - received_first_);
    missing_ += beyond(step, beyond(received, received_newest_));
    received_newest_ = received;
    if (missing_ > kOnTheWay && !missing_since_) missing_since_ = now;
    newest_at_ = now;
    if (now) set_mark({*now, sent_, received});
}

/// Steps of about a second: a node that is queried, or whose sensor changes, sends additional messages.
void SentCount::set_mark(const Mark& mark) noexcept {
    constexpr Nanoseconds kStep{900'000'000};
    if (marks_count_ > 0) {
        const Mark& newest = marks_[marks_count_ - 1];
        if (mark.at - newest.at < kStep || mark.sent - newest.sent < kStepSent) return;
    }
    if (marks_count_ == marks_.size()) {
        std::rotate(marks_.begin(), marks_.begin() + 1, marks_.end());
        --marks_count_;
    }
    marks_[marks_count_++] = mark;
}

std::optional<SentCount::Loss> SentCount::newest_loss(HostTime now, std::size_t steps) const noexcept {
    constexpr Nanoseconds kStale{3'000'000'000};
    if (marks_count_ <= steps || !newest_at_ || now - *newest_at_ >= kStale) return std::nullopt;
    const Mark& newest = marks_[marks_count_ - 1];
    const Mark& oldest = marks_[marks_count_ - 1 - steps];
    const std::uint64_t sent = newest.sent - oldest.sent;
    return Loss{beyond(sent, newest.received - oldest.received), sent, newest.at - oldest.at};
}

void SentCount::restart() noexcept {
    lost_before_ = lost_;
    newest_.reset();
    on_arrival();
    forget_steps();
}

bool SentCount::are_missing(HostTime now, Nanoseconds patience) const noexcept {
    return missing_since_ && now - *missing_since_ >= patience;
}

}  // namespace octoskin
