// Handles joint samples without a time of their own that were delayed in transport.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

/// A sample without a time counts as taken when it arrives. Samples that a pipe or a network delayed arrive
/// in a burst after a gap, the oldest first. Only the newest of them gives the arm's present position.
class JointBurst {
  public:
    /// A shorter gap is no sign of a burst: gaps of 20 ms are common, and no arm moves far in one.
    static constexpr Nanoseconds kGapMin{50'000'000};
    /// No sample waits longer, because readings wait for the sample.
    static constexpr Nanoseconds kWaitMax{20'000'000};

    /// `rate_hz`: the rig's rate of joint samples, at least 1.
    explicit JointBurst(double rate_hz) { expect(rate_hz); }

    /// Changes the expected rate from now on.
    void expect(double rate_hz) {
        const double period_ns = 1e9 / rate_hz;
        gap_ = std::max(kGapMin, Nanoseconds{std::llround(1.5 * period_ns)});
        lasts_ = std::min(kWaitMax, Nanoseconds{std::llround(0.75 * period_ns)});
    }

    enum class Turn : std::uint8_t {
        use,
        drop,  ///< a newer sample of its burst has arrived
        wait,  ///< a newer sample of its burst may still arrive
    };
    /// Decision for the oldest waiting sample, which arrived at `came`; the next one arrived at `next`.
    /// Everything that arrived before `now` is known. Call for each sample in turn, and again for one that
    /// waits.
    [[nodiscard]] Turn turn_of(WallTime came, std::optional<WallTime> next, WallTime now) {
        const bool is_behind_gap = !used_ || came.ns - used_->ns > gap_.count();
        if (!is_behind_gap) return use(came);
        if (!begun_) begun_ = came;
        if (next && is_of_burst(*next)) return Turn::drop;
        return next || !is_of_burst(now) ? use(came) : Turn::wait;
    }
    /// The same for the oldest of `waiting`, which is not empty.
    template <class Samples>
    [[nodiscard]] Turn turn_of_oldest(const Samples& waiting, WallTime now) {
        const auto& oldest = waiting.front();
        if (oldest.has_own_time) return use(oldest.came);
        return turn_of(oldest.came, waiting.size() > 1 ? std::optional(waiting[1].came) : std::nullopt, now);
    }
    /// A sample with its own time is correct however late it arrives.
    Turn use(WallTime came) {
        used_ = came;
        begun_.reset();
        return Turn::use;
    }

  private:
    /// A clock that was set back ends the burst.
    [[nodiscard]] bool is_of_burst(WallTime time) const {
        return time >= *begun_ && time.ns - begun_->ns < lasts_.count();
    }

    Nanoseconds gap_{0};    ///< a burst follows a longer gap; a stream at its rate has no such gap
    Nanoseconds lasts_{0};  ///< what arrives within this time of a burst's first sample belongs to the burst
    std::optional<WallTime> used_;   ///< arrival of the last sample that was used
    std::optional<WallTime> begun_;  ///< arrival of the first sample of the current burst
};

}  // namespace octoskin
