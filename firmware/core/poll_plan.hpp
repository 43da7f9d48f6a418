// When to ask a sensor whether its data is ready. A poll in the middle of where the ready time must lie tells
// most, whatever it says. One that comes just too early bounds the ready time from below where little is
// known, and is the proof that a sensor still keeps its rhythm. One poll is 48 bits on the bus.
#pragma once

#include <cstdint>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/time_bracket.hpp"

namespace octoskin::node {

class PollPlan {
  public:
    PollPlan(std::uint32_t i2c_hz, const Policy& policy) noexcept;

    /// The first poll for data that should become ready within `predicted`.
    [[nodiscard]] NodeTime first_poll(const TimeBracket& predicted) const noexcept;
    /// The first poll where it need not come too early: it looks in the middle of `predicted`, or where that
    /// is wide at the first of up to four places.
    [[nodiscard]] NodeTime poll_within(const TimeBracket& predicted, Microseconds period) const noexcept;
    /// The first poll, and likely the only one, where a line tells when data is ready: after the line, should
    /// it not.
    [[nodiscard]] NodeTime poll_after_hint(const TimeBracket& predicted) const noexcept;
    /// The first poll after a start that can find data: nothing can be ready before the timing budget is used
    /// up.
    [[nodiscard]] NodeTime first_poll_after_start(NodeTime started,
                                                  Microseconds timing_budget) const noexcept;
    /// The poll after the one of `asked`, from its begin to its end, for the first data of a run, which is
    /// there no sooner than `from` and most likely becomes ready within `expected`, where one poll follows
    /// the other.
    [[nodiscard]] NodeTime poll_after_start(NodeTime from, const TimeBracket& expected, Microseconds period,
                                            const TimeBracket& asked) const noexcept;
    /// The next poll after `now` while nothing is known, for data that is there no sooner than `from`.
    [[nodiscard]] NodeTime blind_poll(NodeTime from, Microseconds period, NodeTime now) const noexcept;
    /// The next poll when the one that ended at `now` found nothing. Data that is overdue is asked for ever
    /// more rarely, so that a sensor that has none does not take the bus from the others.
    [[nodiscard]] NodeTime repoll(const TimeBracket& predicted, Microseconds period,
                                  NodeTime now) const noexcept;
    /// Until when, at least, data was not ready if the poll begun at `began` found none: the sensor cannot
    /// have looked before it was told at which register.
    [[nodiscard]] NodeTime not_ready_until(NodeTime began) const noexcept;
    /// When, at the latest, data was ready if the poll that ended at `ended` found it: the sensor cannot have
    /// looked after it began to answer.
    [[nodiscard]] NodeTime ready_by(NodeTime ended) const noexcept;

  private:
    [[nodiscard]] Microseconds shortest_gap(Microseconds period) const noexcept;
    [[nodiscard]] Microseconds spacing(Microseconds period) const noexcept;
    [[nodiscard]] Microseconds longest_gap(Microseconds period) const noexcept;

    const Policy& policy_;
    Microseconds poll_duration_;
    Microseconds index_duration_;
    Microseconds answer_duration_;
};

}  // namespace octoskin::node
