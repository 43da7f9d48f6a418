#include "firmware/core/poll_plan.hpp"

#include <algorithm>

namespace octoskin::node {

namespace {

// A one-byte read with its index: 48 bits, plus a quarter for a bus that runs at 320 of its 400 kHz. On a bus
// with edges so slow that it runs at 283 kHz, polls follow each other without a gap.
constexpr std::int64_t kPollBits = 48;
constexpr Microseconds kLoopDelay{20};

// START, address and two bytes of index, on a bus that is never faster than configured.
constexpr std::int64_t kIndexBits = 28;

// The byte, its acknowledge and STOP, likewise.
constexpr std::int64_t kAnswerBits = 10;

// Slow sensors are polled in proportion: 128 polls per period find the data, and a bracket of 1/2048 of the
// period is precise enough.
constexpr std::int64_t kLongestGapsPerPeriod = 128;
constexpr std::int64_t kShortestGapsPerPeriod = 2048;

/// Counted from `from`, not from the last poll, so that the duration of a poll has no influence.
NodeTime next_on_grid(NodeTime from, Microseconds gap, NodeTime now) noexcept {
    const Microseconds since = elapsed(from, now);
    if (since.count() < 0) return from;
    return from + gap * (since / gap + 1);
}

/// If a place of the grid passed during the poll of `asked`, the last such place is taken at once, however
/// late it is: the next one would be later still, and the gap up to twice as wide.
NodeTime next_or_missed(NodeTime from, Microseconds gap, const TimeBracket& asked) noexcept {
    const NodeTime next = next_on_grid(from, gap, asked.latest);
    const bool is_last_missed = next != from && !is_reached(next - gap, asked.earliest);
    return is_last_missed ? next - gap : next;
}

}  // namespace

PollPlan::PollPlan(std::uint32_t i2c_hz, const Policy& policy) noexcept
    : policy_(policy),
      poll_duration_(kPollBits * 1'250'000 / i2c_hz),
      index_duration_(kIndexBits * 1'000'000 / i2c_hz),
      answer_duration_(kAnswerBits * 1'000'000 / i2c_hz) {}

NodeTime PollPlan::first_poll(const TimeBracket& predicted) const noexcept {
    return predicted.earliest - poll_duration_ - kLoopDelay;
}

NodeTime PollPlan::poll_within(const TimeBracket& predicted, Microseconds period) const noexcept {
    const Microseconds width = predicted.width();
    // No poll comes before it that might have taken longer than usual.
    const Microseconds first = spacing(period) * 4 / 5;
    const Microseconds into = std::max(width / 4, std::min(width / 2, first));
    return predicted.earliest + into - index_duration_;
}

NodeTime PollPlan::poll_after_hint(const TimeBracket& predicted) const noexcept {
    return predicted.latest + policy_.repoll_min;
}

NodeTime PollPlan::first_poll_after_start(NodeTime started, Microseconds timing_budget) const noexcept {
    return started + timing_budget * 9 / 10;
}

NodeTime PollPlan::poll_after_start(NodeTime from, const TimeBracket& expected, Microseconds period,
                                    const TimeBracket& asked) const noexcept {
    const NodeTime now = asked.latest;
    if (!is_reached(expected.earliest, now))
        return earlier_of(blind_poll(from, period, now), expected.earliest);
    if (is_reached(expected.latest, now)) return blind_poll(expected.latest, period, now);
    return next_or_missed(expected.earliest, spacing(period), asked);
}

NodeTime PollPlan::blind_poll(NodeTime from, Microseconds period, NodeTime now) const noexcept {
    return next_on_grid(from, longest_gap(period), now);
}

NodeTime PollPlan::repoll(const TimeBracket& predicted, Microseconds period, NodeTime now) const noexcept {
    // Polls are closer together around the expected time, and further apart the longer the data is overdue.
    const Microseconds distance = elapsed(now, predicted.latest);
    const bool is_overdue = distance.count() < 0;
    return now + (is_overdue ? std::clamp(-distance, policy_.repoll_min, longest_gap(period))
                             : std::clamp(distance / 2, policy_.repoll_min, shortest_gap(period)));
}

/// Where ranges differ in length, the end of a range gives the place of its measuring window no better than
/// that.
Microseconds PollPlan::shortest_gap(Microseconds period) const noexcept {
    return std::max({policy_.repoll_min, period / kShortestGapsPerPeriod, policy_.length_spread() / 4});
}

/// The shortest distance between two polls.
Microseconds PollPlan::spacing(Microseconds period) const noexcept {
    return poll_duration_ + shortest_gap(period);
}

Microseconds PollPlan::longest_gap(Microseconds period) const noexcept {
    return std::max(policy_.repoll_max, period / kLongestGapsPerPeriod);
}

NodeTime PollPlan::not_ready_until(NodeTime began) const noexcept {
    return began + index_duration_;
}

NodeTime PollPlan::ready_by(NodeTime ended) const noexcept {
    return ended - answer_duration_;
}

}  // namespace octoskin::node
