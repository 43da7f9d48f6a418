// Estimates the clock of another host that sends SYNC, for a host that only listens: its lead over this
// machine's clock.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// Each exchange gives one measurement of the other clock's lead. A single measurement is not used: a SYNC
/// may get a late time stamp here, and a FOLLOW_UP may be wrong. The median of the last kKept measurements is
/// used once kAgreeing of them are within kAgreement of it. If the newest one is not, the other clock may
/// have been set; there is no result until the next ones decide.
class ForeignClock {
  public:
    static constexpr std::size_t kKept = 5;
    static constexpr std::size_t kAgreeing = 3;
    /// Two crystals of +-100 ppm drift apart by 0.8 ms over five exchanges; the rest is jitter of time
    /// stamps.
    static constexpr Nanoseconds kAgreement{2'000'000};
    /// After this long without an exchange the crystals may be 1 ms apart: there is no result.
    static constexpr Nanoseconds kSilenceMax{5'000'000'000};

    /// A SYNC of another host was on the bus. Its end was at `heard` on this machine's clock.
    void on_sync(std::uint8_t sequence, HostTime heard) noexcept { open_ = {sequence, heard}; }
    /// Ignores a FOLLOW_UP that does not belong to the newest SYNC, and a second one for the same SYNC.
    void on_follow_up(const wire::FollowUp& follow_up);

    /// The other clock's time less this machine's, from the median exchange. The crystals' drift since then
    /// is at most 0.4 ms. Empty while unknown or in doubt.
    [[nodiscard]] std::optional<Nanoseconds> ahead(HostTime now) const;
    /// Number of exchanges that disagreed with the settled value. After the other clock was set this includes
    /// the first exchanges, until enough of them agree.
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
    std::deque<Nanoseconds> reported_;  ///< the last kKept measurements
    std::optional<Nanoseconds> settled_;
    HostTime newest_;  ///< time of the newest exchange on this machine's clock
    std::uint64_t outliers_ = 0;
};

}  // namespace octoskin
