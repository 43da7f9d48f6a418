#include "firmware/core/poll_plan.hpp"

#include <algorithm>

namespace octoskin::node {

namespace {

// A one-byte read with its index: 48 bits; half as much again for a bus that runs at 283 of its 400 kHz.
constexpr std::int64_t kPollBits = 48;
constexpr Microseconds kLoopDelay{20};

// START, address and two bytes of index, on a bus that is never faster than configured.
constexpr std::int64_t kIndexBits = 28;

// Slow sensors are polled in proportion: 128 polls a period are precise enough.
constexpr std::int64_t kPollsPerPeriod = 128;

}  // namespace

PollPlan::PollPlan(std::uint32_t i2c_hz, const Policy& policy) noexcept
    : policy_(policy),
      poll_duration_(kPollBits * 1'500'000 / i2c_hz),
      index_duration_(kIndexBits * 1'000'000 / i2c_hz) {}

NodeTime PollPlan::first_poll(const TimeBracket& predicted) const noexcept {
    return predicted.earliest - poll_duration_ - kLoopDelay;
}

NodeTime PollPlan::poll_in_middle(const TimeBracket& predicted) const noexcept {
    return predicted.middle() - index_duration_;
}

NodeTime PollPlan::poll_after_hint(const TimeBracket& predicted) const noexcept {
    return predicted.latest + policy_.repoll_min;
}

NodeTime PollPlan::first_poll_after_start(NodeTime started, Microseconds timing_budget) const noexcept {
    return started + timing_budget * 9 / 10;
}

NodeTime PollPlan::blind_poll(NodeTime from, Microseconds period, NodeTime now) const noexcept {
    const Microseconds since = elapsed(from, now);
    if (since.count() < 0) return from;
    const Microseconds gap = longest_gap(period);
    return from + gap * (since / gap + 1);
}

NodeTime PollPlan::repoll(const TimeBracket& predicted, Microseconds period, NodeTime now) const noexcept {
    // Closer together around the time at which it must be, further apart the longer it is overdue.
    const Microseconds distance = elapsed(now, predicted.latest);
    const Microseconds gap = distance.count() >= 0 ? distance / 2 : -distance;
    return now + std::clamp(gap, policy_.repoll_min, longest_gap(period));
}

Microseconds PollPlan::longest_gap(Microseconds period) const noexcept {
    return std::max(policy_.repoll_max, period / kPollsPerPeriod);
}

NodeTime PollPlan::not_ready_until(NodeTime began) const noexcept {
    return began + index_duration_;
}

}  // namespace octoskin::node
