// Which of several answers to one SYNC is the node's own.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"
#include "host/core/time/clock_map.hpp"
#include "host/core/time/sync_exchange.hpp"

namespace octoskin {

/// A node answers each SYNC once. Where two answers under its id tell different times, another sender wants
/// to set its clock, and with it the place of all that it measures. The one is used that goes on where the
/// clock was when it was last not contested, so that nobody leads it away by little and little; where that is
/// none or more than one, none is. What the first one did to the clock until then is undone: no reading can
/// have been placed by it, as an exchange counts only for what comes ClockMapConfig::settling later.
class AnswerCheck {
  public:
    /// `answers` to one SYNC, at least one, in the order of arrival; again with each one more. What the one
    /// that is used did to the clock; empty: none is used.
    std::optional<SampleVerdict> take(std::span<const SyncSample> answers, ClockMap& clock);
    /// The node started anew: its clock of before does not come back.
    void forget() noexcept {
        taken_.reset();
        uncontested_.reset();
    }

    /// Two answers contradicted each other within the last kTold.
    [[nodiscard]] bool hears_two(HostTime now) const noexcept;
    /// Answers that contradicted those before them.
    [[nodiscard]] std::uint64_t contradictions() const noexcept { return contradictions_; }

    /// Over two exchanges, so that a problem at each of them goes on.
    static constexpr Nanoseconds kTold{2'500'000'000};

  private:
    struct Taken {
        HostTime host;  ///< the SYNC, on the host's clock
        ClockMap before;
    };
    [[nodiscard]] std::optional<SyncSample> own_of(std::span<const SyncSample> answers) const;

    std::optional<Taken> taken_;
    std::optional<ClockMap> uncontested_;  ///< the clock, before there were two answers to each SYNC
    bool are_contested_ = false;           ///< the answers to the newest SYNC
    std::optional<HostTime> contradicted_;
    std::uint64_t contradictions_ = 0;
};

}  // namespace octoskin
