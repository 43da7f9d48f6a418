// The clock of another host that sends SYNC, for one that only listens: how far it is ahead of this
// machine's.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// Each exchange tells once how far the other clock is ahead. No single one is believed: a SYNC may be
/// stamped late here, a FOLLOW_UP may be wrong. The median of the last kKept is taken once kAgreeing of them
/// are within kAgreement of it; while the newest is not, the other clock may just have been set, and nothing
/// is told until the next ones decide.
class ForeignClock {
  public:
    static constexpr std::size_t kKept = 5;
    static constexpr std::size_t kAgreeing = 3;
    /// Two crystals of +-100 ppm drift 0.8 ms apart over five exchanges; the rest is jitter of stamps.
    static constexpr Nanoseconds kAgreement{2'000'000};
    /// After so long without an exchange the crystals may be 1 ms apart: nothing is told.
    static constexpr Nanoseconds kSilenceMax{5'000'000'000};

    /// A SYNC of another host was on the bus, its end at `heard` on this machine's clock.
    void on_sync(std::uint8_t sequence, HostTime heard) noexcept { open_ = {sequence, heard}; }
    /// One that does not belong to the newest SYNC, or is the second that does, tells nothing.
    void on_follow_up(const wire::FollowUp& follow_up);

    /// Its time less this machine's, from the median exchange: the crystals' drift since then is at most
    /// 0.4 ms. Empty while unknown
    /// or in doubt.
    [[nodiscard]] std::optional<Nanoseconds> ahead(HostTime now) const;
    /// Exchanges that disagreed with what was settled. Those of a clock that was set are among them: the
    /// first ones, until enough agree.
    [[nodiscard]] std::uint64_t outliers() const noexcept { return outliers_; }

  private:
    struct Open {
        std::uint8_t sequence = 0;
        HostTime heard;
    };
    [[nodiscard]] bool agrees(Nanoseconds ahead) const {
        return settled_ && std::chrono::abs(ahead - *settled_) <= kAgreement;
    }
    void settle();

    std::optional<Open> open_;
    std::deque<Nanoseconds> told_;  ///< the last kKept
    std::optional<Nanoseconds> settled_;
    HostTime newest_;  ///< when the newest exchange was heard here
    std::uint64_t outliers_ = 0;
};

}  // namespace octoskin
