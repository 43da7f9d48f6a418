// Keeps a sensor's ranges at their place within the period while it ranges. The period can be set only to a
// step of its register (0.05-0.17 % at 50-15 ms), and ST allows no change while the sensor ranges (UM2356).
// So each sensor drifts ("walks") away from its phase. Once it has drifted too far it is restarted on the far
// side of its phase, so that it drifts through the whole tolerance. No start holds a sensor whose oscillator
// does not keep its rate: it is restarted ever more rarely, until a start helps again.
//
// How a sensor drifts is estimated over its runs, since one of 16 periods gives the drift only to 6 us.
// Starts are in vain for a sensor that drifts by more than a step per period, or not as in the runs before.
// After the fourth such start in a row it is restarted every 32 periods, then ever more rarely, up to every
// 1,024; more often again as starts help.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/time_bracket.hpp"

namespace octoskin::node {

class PhaseHold {
  public:
    explicit PhaseHold(const Policy& policy) noexcept : policy_(policy) {}

    struct Start {
        TimeBracket at;       ///< from the begin of the start until its end
        Microseconds off{0};  ///< from the sensor's phase to the begin of the start
        Microseconds period{0};
        Nanoseconds step{0};      ///< of the register that sets the period
        bool is_trimmed = false;  ///< to one of those steps
    };
    void restart(const Start& start) noexcept;
    /// A range was ready within `ready`; a time that is too uncertain is ignored. How long after a start the
    /// first range comes is a property of the part, and not counted.
    void observe(const TimeBracket& ready) noexcept;

    /// Whether it has drifted too far, at a rate that a trim can correct, and is to be restarted.
    [[nodiscard]] bool is_lost() const noexcept;
    /// By how much a period is too long, estimated from this run and earlier ones.
    [[nodiscard]] Nanoseconds walk() const noexcept;
    /// From its next start on, which changes its period, the sensor will drift by `walk` per period.
    void expect_walk(Nanoseconds walk) noexcept;
    /// Its period will change by an unknown amount.
    void forget_walk() noexcept {
        expected_walk_ = Nanoseconds{0};
        walk_weight_ = 0;
    }
    /// How long after its phase to start a sensor that will then drift by `walk` per period.
    [[nodiscard]] Microseconds start_off(Nanoseconds walk) const noexcept;

  private:
    [[nodiscard]] bool is_worth_waiting(const TimeBracket& ready) const noexcept;
    void begin(Microseconds first_after) noexcept;
    [[nodiscard]] bool is_distinguished(Microseconds since_last) const noexcept;
    void go_on(Microseconds since_last) noexcept;
    [[nodiscard]] bool is_near(Microseconds off, Microseconds other) const noexcept;
    void count_from(Microseconds off) noexcept;
    void judge_start() noexcept;
    void count_in_vain() noexcept;
    [[nodiscard]] bool is_out() const noexcept;
    [[nodiscard]] std::int64_t patience() const noexcept;
    [[nodiscard]] Microseconds nearest_to_zero(Microseconds off) const noexcept;

    const Policy& policy_;
    Start start_;
    Microseconds off_at_first_{0};  ///< distance from its phase where the drift is counted from: its start
    Microseconds off_{0};           ///< how far after its phase the newest range was
    Microseconds smoothed_off_{0};  ///< the same, smoothed by the drift and the earlier ranges
    Nanoseconds expected_walk_{0};  ///< of this run, by the runs before it
    std::int64_t walk_weight_ = 0;  ///< of those runs; 0: nothing is expected
    std::int64_t periods_ = 0;      ///< from `off_at_first_` to the newest range
    std::optional<NodeTime> last_;  ///< ready time of the newest range of this run
    Microseconds first_after_{0};   ///< mean time from a start to the first ready time
    std::int64_t firsts_ = 0;       ///< number of times in that mean, limited
    bool is_judged_ = false;        ///< this run: whether its start helped is decided
    bool is_in_vain_ = false;       ///< this run: its start, or the expectation, was in vain
    int starts_in_vain_ = 0;        ///< minus those that helped
};

}  // namespace octoskin::node
