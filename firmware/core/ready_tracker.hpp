// When the sensor finished a range, and when it will finish the next. A sensor's own oscillator is 6-7 % off
// the nominal and differs from part to part, so its rhythm is measured from the times at which data was seen
// to be ready.
//
// The sensor starts its ranges by a timer: ready times lie on an even grid, each within some jitter that does
// not add up. Every estimate is an interval that contains the true value as long as this holds. A poll that
// found "not ready" bounds the ready time from below, one that found "ready" from above, and the grid carries
// both bounds over to the next range. So a reading that was polled late because the bus was busy still has a
// well-known time.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/time_bracket.hpp"

namespace octoskin::node {

struct MeasuredPeriod {
    Microseconds value{0};
    Microseconds uncertainty{0};  ///< bound on the error of `value`, rounded up
};

class ReadyTracker {
  public:
    explicit ReadyTracker(const Policy& policy) noexcept;

    /// Ranging starts again, with a period within `uncertainty_permille` of `expected`.
    void restart(Microseconds expected, std::int32_t uncertainty_permille) noexcept;

    /// Ranging continues, but the ready time of the last range is not known any more.
    void forget() noexcept;

    /// The bracket of the ready time of the `ranges`-th range after the last observed one; empty before the
    /// first.
    [[nodiscard]] std::optional<TimeBracket> predict(std::uint32_t ranges) const noexcept;

    /// The `ranges`-th range after the last observed one became ready within `seen`. Returns the bracket by
    /// all that is known: `seen` and the prediction together. If they contradict each other, returns `seen`
    /// and learns the rhythm again.
    TimeBracket observe(const TimeBracket& seen, std::uint32_t ranges) noexcept;
    /// The same range was ready within `seen`, which holds whether or not the sensor kept its rhythm; that it
    /// did must not be assumed. The rhythm is learned again.
    TimeBracket relearn(const TimeBracket& seen, std::uint32_t ranges) noexcept;

    /// The best estimate of the period, measured or not.
    [[nodiscard]] Microseconds period() const noexcept;
    /// The period, once `trim_edges_min` ready times were observed since the start.
    [[nodiscard]] std::optional<MeasuredPeriod> measured_period() const noexcept;

  private:
    // Periods in 1/256 us: a rounding error of one unit is 0.25 us over the 32 ranges of a window.
    using PeriodQ8 = std::int64_t;

    [[nodiscard]] TimeBracket grid_after(std::uint32_t slots) const noexcept;
    [[nodiscard]] std::optional<TimeBracket> fit(const TimeBracket& seen, std::uint32_t slots) noexcept;
    void assume_period(Microseconds shortest, Microseconds longest,
                       std::int32_t uncertainty_permille) noexcept;
    void refine_period() noexcept;
    void open_window() noexcept;

    const Policy& policy_;
    Microseconds expected_{0};
    std::optional<TimeBracket> grid_;  ///< bracket of the last observed range's place on the grid
    TimeBracket window_start_;
    std::uint32_t window_slots_ = 0;
    std::uint32_t observed_ = 0;
    std::uint32_t slots_missed_in_row_ = 0;
    PeriodQ8 shortest_q8_ = 0;
    PeriodQ8 longest_q8_ = 0;
};

}  // namespace octoskin::node
