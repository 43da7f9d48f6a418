// When to poll a sensor for data. A poll in the middle of the bracket of the ready time gives the most
// information, whatever the answer. A poll just too early bounds the ready time from below while little is
// known, and proves that the sensor still keeps its rhythm. One poll takes 48 bits on the bus.
//
// In a bracket wider than a third of a millisecond, up to four polls follow each other. Before the first
// range, polls lie on an even grid that begins with the sensor's phase: 1 ms apart, and 0.17 ms where the
// first range is expected. The time of the first range is then known to 0.15 ms if one sensor has the bus to
// itself, and to 1 ms if nine start at once. The time of the fourth is known as well as that of any later
// one.
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
    /// The first poll if the sensor's rhythm needs no proof: in the middle of `predicted` or, if that is
    /// wide, at the first of up to four places.
    [[nodiscard]] NodeTime poll_within(const TimeBracket& predicted, Microseconds period) const noexcept;
    /// The poll in case the data-ready line fails: just after the data must be ready, so that a working line
    /// announces it first.
    [[nodiscard]] NodeTime poll_after_hint(const TimeBracket& predicted) const noexcept;
    /// The first poll after a start that can find data: none is ready before the timing budget has passed.
    [[nodiscard]] NodeTime first_poll_after_start(NodeTime started,
                                                  Microseconds timing_budget) const noexcept;
    /// The next poll for the first data of a run. `asked`: begin and end of the poll before. The data is
    /// not ready before `from` and most likely becomes ready within `expected`, where polls follow each other
    /// closely.
    [[nodiscard]] NodeTime poll_after_start(NodeTime from, const TimeBracket& expected, Microseconds period,
                                            const TimeBracket& asked) const noexcept;
    /// The next poll after `now` while the ready time is unknown. No data is ready before `from`.
    [[nodiscard]] NodeTime blind_poll(NodeTime from, Microseconds period, NodeTime now) const noexcept;
    /// The next poll after one that ended at `now` and found no data. Overdue data is polled for at growing
    /// intervals, so that a sensor without data does not take the bus from the others.
    [[nodiscard]] NodeTime repoll(const TimeBracket& predicted, Microseconds period,
                                  NodeTime now) const noexcept;
    /// The time until which data was certainly not ready if the poll that began at `began` found none: the
    /// sensor cannot have answered before it received the register's index.
    [[nodiscard]] NodeTime not_ready_until(NodeTime began) const noexcept;
    /// The latest time at which data became ready if the poll that ended at `ended` found it: the sensor
    /// cannot have read its state after it began to answer.
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
