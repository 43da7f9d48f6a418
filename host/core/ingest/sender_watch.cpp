#include "host/core/ingest/sender_watch.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace octoskin {
namespace {

/// The host time may jump: a time in the future counts as equally long ago.
bool is_within(const std::optional<HostTime>& then, HostTime now, Nanoseconds span) noexcept {
    return then && std::chrono::abs(now - *then) < span;
}

std::size_t strays_max(Nanoseconds period) {
    constexpr Nanoseconds kSecond{1'000'000'000};
    constexpr std::int64_t kAtLeast = 6;  // also for a slow sensor, five a second are only reported
    const std::int64_t readings_per_s = kSecond / std::max(period, Nanoseconds{1'000});
    return static_cast<std::size_t>(std::max(kAtLeast, readings_per_s / 4));
}

}  // namespace

SenderWatch::SenderWatch(Nanoseconds period) : strays_kept_(strays_max(period)) {}

void SenderWatch::on_contradiction(HostTime now) {
    ++contradictions_;
    is_disputed_ = is_within(contradicted_, now, kDisputeHold);
    contradicted_ = now;
}

void SenderWatch::on_taken(std::optional<unsigned> left_out, HostTime now) {
    for (unsigned i = left_out.value_or(refused_); i < refused_; ++i) on_stray(now);
    refused_ = 0;
}

void SenderWatch::on_stray(HostTime now) {
    ++strays_;
    const bool may_be_damage = is_within(damaged_, now, kDamageHold);
    if (!may_be_damage || is_within(strayed_, now, kStrayHold)) strayed_surely_ = now;
    strayed_ = now;
    if (strays_kept_.keeps_with_event(now)) return;
    is_disputed_ = true;
    contradicted_ = now;
}

bool SenderWatch::is_disputed(HostTime now) const noexcept {
    return is_disputed_ && is_within(contradicted_, now, kDisputeHold);
}

bool SenderWatch::is_named(HostTime now) const noexcept {
    return is_disputed(now) || is_within(strayed_surely_, now, kStrayHold);
}

}  // namespace octoskin
