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
    /// A stamp may lie this much after the one before it. More than a healthy bus is silent: each node sends
    /// a heartbeat every 100 ms, give or take 10. Less than what could put a range into another turn of its
    /// time field, whatever else goes wrong: 262 ms, less the 100 ms between a range's window and the end of
    /// its age limit, less twice the 5 ms by which "now" may be early.
    Nanoseconds ahead_tolerance{140'000'000};
    /// So many stamps in a row must agree on a jump beyond these tolerances. One before them that goes on
    /// where the others were shows that only the stamps between were wrong.
    unsigned jump_agreement = 4;
};

/// Why "now" is not known.
enum class HostClockFault : std::uint8_t {
    no_exchange,         ///< no SYNC with its FOLLOW_UP yet
    stamps_jumped,       ///< beyond the tolerances, and no exchange since has confirmed the offset
    exchanges_disagree,  ///< the newest tells another offset than those before; the next one decides
};

/// Stamps are wall time: they may step at any moment, and they never place a measurement. They only say which
/// of several readings of a wrapping clock is meant (see ClockMap) and how far the bus has come. The offset
/// from stamp to monotonic time is learnt from each SYNC and its FOLLOW_UP. A jump of the stamps makes "now"
/// unknown: until the stamps go on where they were, or, once several in a row agree on it, until an exchange
/// confirms the known offset or two in a row agree on another. One stamp that ran ahead within the tolerance,
/// and is followed by others that go on where those before it were, was wrong itself: the clock goes on
/// there.
class HostClockEstimate {
  public:
    explicit HostClockEstimate(const HostClockConfig& config = {}) : config_(config) {}

    /// Takes the stamps of frames that are known to be ours, in the order of arrival. Stamps before 1970 or
    /// after 2116 count as these years.
    void observe(WallTime stamp);
    void learn(const SyncStamp& sync);

    /// At the newest stamp. Never decreases while no stamp jumps or runs ahead; empty before the first
    /// exchange, after a stamp that jumped, and while in doubt.
    [[nodiscard]] std::optional<HostTime> now() const;
    /// Why there is no `now`; empty if there is.
    [[nodiscard]] std::optional<HostClockFault> fault() const noexcept;
    /// For how long frames were received by now, whether or not anybody tells the time: goes on from stamp to
    /// stamp, and stands still over a jump, and over a silence that looks like one. What a stamp that ran
    /// ahead added is taken back.
    [[nodiscard]] Nanoseconds running() const noexcept { return running_; }
    /// The newest stamp that is believed; empty before the first frame.
    [[nodiscard]] std::optional<WallTime> newest_stamp() const noexcept { return stamp_max_; }
    /// When the first frame was received, for who asks as soon as `now` is known: by a later jump of the
    /// stamps it is off. Empty while `now` is.
    [[nodiscard]] std::optional<HostTime> begun() const {
        const auto newest = now();
        return newest ? std::optional(*newest - running_) : std::nullopt;
    }

    /// How often stamps jumped back, and agreed on it.
    [[nodiscard]] std::uint64_t steps_back() const noexcept { return steps_back_; }
    /// How often stamps jumped ahead, and agreed on it; a bus that was silent for as long looks the same.
    [[nodiscard]] std::uint64_t steps_ahead() const noexcept { return steps_ahead_; }
    /// How many stamps jumped, or ran ahead, without others that agreed.
    [[nodiscard]] std::uint64_t stamps_ignored() const noexcept { return stamps_ignored_; }
    /// How often two exchanges agreed on another offset than before.
    [[nodiscard]] std::uint64_t relocks() const noexcept { return relocks_; }

  private:
    /// Stamps in a row that agree with each other and not with those before.
    struct Jump {
        WallTime first;
        WallTime newest;
        unsigned stamps = 0;
    };

    [[nodiscard]] bool follows(WallTime before, WallTime stamp) const;
    void accept(WallTime stamp);
    void settle_jump();
    [[nodiscard]] bool is_discredited(WallTime sync_stamp) const;
    [[nodiscard]] bool agree(Nanoseconds a, Nanoseconds b) const;

    HostClockConfig config_;
    std::optional<WallTime> stamp_max_;     ///< newest since the last step
    std::optional<WallTime> stamp_before_;  ///< the newest before stamp_max_; empty after a jump
    Nanoseconds running_{0};
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
