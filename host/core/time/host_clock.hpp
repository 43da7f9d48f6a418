// "Now" on the host's monotonic clock, told from the receive stamps of a log or of a kernel.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/time/sync_exchange.hpp"

namespace octoskin {

struct HostClockConfig {
    /// Stamps of one SYNC and the next may disagree by this much before the wall clock counts as stepped.
    Nanoseconds step_tolerance{20'000'000};
    /// A stamp may lie this much before the one before it: several interfaces share a log.
    Nanoseconds back_tolerance{5'000'000};
    /// A stamp may lie this much after the one before it: longer than any healthy bus is silent.
    Nanoseconds ahead_tolerance{500'000'000};
    /// So many stamps in a row must agree on a jump beyond these tolerances. One before them that goes on
    /// where the others were shows that only the stamps between were wrong.
    unsigned jump_agreement = 4;
};

/// Stamps are wall time: they may step at any moment, and they never place a measurement. They only say which
/// of several readings of a wrapping clock is meant (see ClockMap) and how far the bus has come. The offset
/// from stamp to monotonic time is learnt from each SYNC and its FOLLOW_UP. A jump of the stamps makes "now"
/// unknown: until the stamps go on where they were, or, once several in a row agree on it, until an exchange
/// confirms the known offset or two in a row agree on another.
class HostClockEstimate {
  public:
    explicit HostClockEstimate(const HostClockConfig& config = {}) : config_(config) {}

    /// Takes the stamps of frames that are known to be ours, in the order of arrival. Stamps before 1970 or
    /// after 2116 count as these years.
    void observe(WallTime stamp);
    void learn(const SyncStamp& sync);

    /// At the newest stamp. Never decreases while the stamps do not step; empty before the first exchange,
    /// after a stamp that jumped, and while in doubt.
    [[nodiscard]] std::optional<HostTime> now() const;

    /// How often stamps jumped back, and agreed on it.
    [[nodiscard]] std::uint64_t steps_back() const noexcept { return steps_back_; }
    /// How often stamps jumped ahead, and agreed on it; a bus that was silent for as long looks the same.
    [[nodiscard]] std::uint64_t steps_ahead() const noexcept { return steps_ahead_; }
    /// How many stamps jumped without others that agreed.
    [[nodiscard]] std::uint64_t stamps_ignored() const noexcept { return stamps_ignored_; }
    /// How often two exchanges agreed on another offset than before.
    [[nodiscard]] std::uint64_t relocks() const noexcept { return relocks_; }

  private:
    /// Stamps in a row that agree with each other and not with those before.
    struct Jump {
        WallTime newest;
        unsigned stamps = 0;
    };

    [[nodiscard]] bool follows(WallTime before, WallTime stamp) const;
    [[nodiscard]] bool is_discredited(WallTime sync_stamp) const;
    [[nodiscard]] bool agree(Nanoseconds a, Nanoseconds b) const;

    HostClockConfig config_;
    std::optional<WallTime> stamp_max_;       ///< newest since the last step
    std::optional<Jump> jump_;                ///< the following stamps decide
    std::optional<Nanoseconds> offset_;       ///< host time - stamp
    std::optional<Nanoseconds> offset_next_;  ///< disagrees with offset_; the next exchange decides
    bool is_in_doubt_ = false;
    std::uint64_t steps_back_ = 0;
    std::uint64_t steps_ahead_ = 0;
    std::uint64_t stamps_ignored_ = 0;
    std::uint64_t relocks_ = 0;
};

}  // namespace octoskin
