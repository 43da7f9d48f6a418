// Keeps a sensor's ranges where the rig put them within the period, for as long as it ranges. The period is
// known to a step of its register (0.05-0.17 % at 50-15 ms), and ST allows no change while the sensor ranges
// (UM2356): so each sensor walks off, and is started anew once it has walked too far, on the far side of its
// phase, so that it walks through all that is allowed. One whose oscillator does not keep its rate is not
// held by any start: it is started anew ever more rarely, until one helps again.
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
        TimeBracket at;       ///< from when it was begun until it was done
        Microseconds off{0};  ///< how long after the sensor's phase it was begun
        Microseconds period{0};
        Nanoseconds step{0};      ///< of the register that sets it
        bool is_trimmed = false;  ///< to one of those
    };
    void restart(const Start& start) noexcept;
    /// A range was ready within `ready`; too vague a time tells nothing. How long after a start the first
    /// one comes is the part's own, and not counted.
    void observe(const TimeBracket& ready) noexcept;

    /// Whether it has walked too far, at a rate that a trim can mend, and is to be started anew.
    [[nodiscard]] bool is_lost() const noexcept;
    /// By how much a period is longer than it should be: by this run and those before it.
    [[nodiscard]] Nanoseconds walk() const noexcept;
    /// From its next start on, which changes its period, it will walk by so much.
    void expect_walk(Nanoseconds walk) noexcept;
    /// Its period will be changed by what nobody knows.
    void forget_walk() noexcept {
        expected_walk_ = Nanoseconds{0};
        walk_weight_ = 0;
    }
    /// How long after its phase to start a sensor that will then walk by so much a period.
    [[nodiscard]] Microseconds start_off(Nanoseconds walk) const noexcept;

  private:
    [[nodiscard]] bool is_worth_waiting(const TimeBracket& ready) const noexcept;
    void begin(Microseconds first_after) noexcept;
    [[nodiscard]] bool is_told_from_others(Microseconds since_last) const noexcept;
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
    Microseconds off_at_first_{0};  ///< off its phase, where its walk is counted from: its start
    Microseconds off_{0};           ///< how far after its phase the newest range was
    Microseconds smoothed_off_{0};  ///< likewise, by its walk and the ranges before
    Nanoseconds expected_walk_{0};  ///< of this run, by those before it
    std::int64_t walk_weight_ = 0;  ///< of those; 0: nothing is expected
    std::int64_t periods_ = 0;      ///< from there to the newest range
    std::optional<NodeTime> last_;  ///< when that was ready; of this run
    Microseconds first_after_{0};   ///< a start, the first range is ready: the mean
    std::int64_t firsts_ = 0;       ///< so many of them; no more than count
    bool is_judged_ = false;        ///< this run: whether its start helped
    bool is_in_vain_ = false;       ///< this run: its start, or what was expected of it
    int starts_in_vain_ = 0;        ///< more than helped
};

}  // namespace octoskin::node
