// Selects which of several answers to one SYNC is the node's own.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"
#include "host/core/time/clock_map.hpp"
#include "host/core/time/sync_exchange.hpp"

namespace octoskin {

/// A node answers each SYNC once. Two answers under its id that contain different times mean that a second
/// sender tries to set the node's clock, and with it the time of every reading. Used is the one answer that
/// continues the clock as it was when it was last uncontested. Comparing with that clock prevents a second
/// sender from shifting it in small steps. If no answer fits, or more than one, none is used. The effect of
/// an earlier answer to the same SYNC is undone. No reading can have been placed by it: an exchange applies
/// only to what arrives ClockMapConfig::settling later.
class AnswerCheck {
  public:
    /// `answers`: all answers to one SYNC so far, at least one, in order of arrival. Call again for each
    /// further answer. Returns the effect of the used answer on the clock; empty if none is used.
    std::optional<SampleEffect> take(std::span<const SyncSample> answers, ClockMap& clock);
    /// The node restarted: its earlier clock does not come back.
    void forget() noexcept {
        taken_.reset();
        uncontested_.reset();
    }

    /// True if two answers contradicted each other within the last kTold.
    [[nodiscard]] bool hears_two(HostTime now) const noexcept;
    /// Number of answers that contradicted earlier ones.
    [[nodiscard]] std::uint64_t contradictions() const noexcept { return contradictions_; }

    /// Longer than two exchanges, so that a fault at each exchange is reported without interruption.
    static constexpr Nanoseconds kTold{2'500'000'000};

  private:
    struct Taken {
        HostTime host;  ///< time of the SYNC on the host's clock
        ClockMap before;
    };
    [[nodiscard]] std::optional<SyncSample> own_of(std::span<const SyncSample> answers) const;

    std::optional<Taken> taken_;
    std::optional<ClockMap> uncontested_;  ///< the clock before the SYNCs had two answers each
    bool are_contested_ = false;           ///< about the answers to the newest SYNC
    std::optional<HostTime> contradicted_;
    std::uint64_t contradictions_ = 0;
};

}  // namespace octoskin
