// Joint samples without a time that were held up on their way.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

/// A sample without a time counts as taken when it comes. Where a pipe or a network held samples up they come
/// in a burst behind a gap, the oldest first, and only the newest of them says where the arm is now.
class JointBurst {
  public:
    /// Behind so long a gap the first samples may be a burst: 20 ms are common, and move no arm far.
    static constexpr Nanoseconds kGap{50'000'000};

    /// `lasts`: what comes within that time of a burst's first sample is of the burst.
    explicit JointBurst(Nanoseconds lasts) : lasts_(lasts) {}

    /// Of samples that come at another rate from now on.
    void expect(Nanoseconds lasts) { lasts_ = lasts; }

    enum class Turn : std::uint8_t {
        use,
        drop,  ///< a newer one of its burst has come
        wait,  ///< a newer one of its burst may come yet
    };
    /// Of the oldest sample that waits, which came at `came`; the one behind it came at `next`. All that came
    /// before `now` is known. To be asked of each sample in turn, again where it waits.
    [[nodiscard]] Turn turn_of(WallTime came, std::optional<WallTime> next, WallTime now) {
        const bool is_behind_gap = !used_ || came.ns - used_->ns > kGap.count();
        if (!is_behind_gap) return use(came);
        if (!begun_) begun_ = came;
        if (next && is_of_burst(*next)) return Turn::drop;
        return next || !is_of_burst(now) ? use(came) : Turn::wait;
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

    Nanoseconds lasts_;
    std::optional<WallTime> used_;   ///< when the sample came that was used last
    std::optional<WallTime> begun_;  ///< when the first of the burst came that is not over
};

}  // namespace octoskin
