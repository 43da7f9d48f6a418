#include "host/core/ingest/sent_count.hpp"

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
}

void SentCount::restart() noexcept {
    lost_before_ = lost_;
    newest_.reset();
    on_arrival();
}

bool SentCount::are_missing(HostTime now, Nanoseconds patience) const noexcept {
    return missing_since_ && now - *missing_since_ >= patience;
}

}  // namespace octoskin
