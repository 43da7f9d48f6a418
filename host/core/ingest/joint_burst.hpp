// Joint samples without a time that were held up on their way.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

/// A sample without a time counts as taken when it comes. Where a pipe or a network held samples up they come
/// in a burst behind a gap, the oldest first, and only the newest of them says where the arm is now.
class JointBurst {
  public:
    /// Behind a shorter gap there is no burst: 20 ms are common, and move no arm far.
    static constexpr Nanoseconds kGapMin{50'000'000};
    /// No sample waits for longer: its readings wait for it.
    static constexpr Nanoseconds kWaitMax{20'000'000};

    /// Of samples that come `rate_hz` times a second, the rig's rate, 1 or more.
    explicit JointBurst(double rate_hz) { expect(rate_hz); }

    /// Of samples that come at another rate from now on.
    void expect(double rate_hz) {
        const double period_ns = 1e9 / rate_hz;
        gap_ = std::max(kGapMin, Nanoseconds{std::llround(1.5 * period_ns)});
        lasts_ = std::min(kWaitMax, Nanoseconds{std::llround(0.75 * period_ns)});
    }

    enum class Turn : std::uint8_t {
        use,
        drop,  ///< a newer one of its burst has come
        wait,  ///< a newer one of its burst may come yet
    };
    /// Of the oldest sample that waits, which came at `came`; the one behind it came at `next`. All that came
    /// before `now` is known. To be asked of each sample in turn, again where it waits.
    [[nodiscard]] Turn turn_of(WallTime came, std::optional<WallTime> next, WallTime now) {
        const bool is_behind_gap = !used_ || came.ns - used_->ns > gap_.count();
        if (!is_behind_gap) return use(came);
        if (!begun_) begun_ = came;
        if (next && is_of_burst(*next)) return Turn::drop;
        return next || !is_of_burst(now) ? use(came) : Turn::wait;
    }
    /// Of the oldest of samples that wait, which are not none.
    template <class Samples>
    [[nodiscard]] Turn turn_of_oldest(const Samples& waiting, WallTime now) {
        const auto& oldest = waiting.front();
        if (oldest.has_own_time) return use(oldest.came);
        return turn_of(oldest.came, waiting.size() > 1 ? std::optional(waiting[1].came) : std::nullopt, now);
    }
    /// A sample with a time, which is right however late it comes.
    Turn use(WallTime came) {
        used_ = came;
        begun_.reset();
        return Turn::use;
    }

  private:
    /// A clock that was set back ends it.
    [[nodiscard]] bool is_of_burst(WallTime time) const {
        return time >= *begun_ && time.ns - begun_->ns < lasts_.count();
    }

    Nanoseconds gap_{0};             ///< a burst comes behind a longer one; a stream at its rate has none
    Nanoseconds lasts_{0};           ///< what comes within it of a burst's first sample is of the burst
    std::optional<WallTime> used_;   ///< when the sample came that was used last
    std::optional<WallTime> begun_;  ///< when the first of the burst came that is not over
};

}  // namespace octoskin
