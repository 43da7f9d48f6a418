// Estimates "now" on the host's monotonic clock from the receive time stamps of a log or of the kernel.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/time/sync_exchange.hpp"

namespace octoskin {

struct HostClockConfig {
    /// Time stamps of successive SYNCs may disagree by this much before the wall clock counts as stepped.
    Nanoseconds step_tolerance{20'000'000};
    /// A time stamp may be this much earlier than the one before: several interfaces share a log.
    Nanoseconds back_tolerance{5'000'000};
    /// A time stamp may be this much later than the one before. The limit is longer than the silence of a
    /// healthy bus: each node sends a heartbeat every 100 ms, give or take 10. It is shorter than the error
    /// that could put a range into another turn of its time field: 262 ms, less the 100 ms between a range's
    /// window and the end of its age limit, less twice the 5 ms by which "now" may be early.
    Nanoseconds ahead_tolerance{140'000'000};
    /// This many time stamps in a row must agree on a jump beyond these tolerances. If, before that, one time
    /// stamp continues the old series, only the time stamps in between were wrong.
    unsigned jump_agreement = 4;
};

/// Why "now" is not known.
enum class HostClockFault : std::uint8_t {
    no_exchange,         ///< no SYNC with its FOLLOW_UP yet
    stamps_jumped,       ///< beyond the tolerances, and no exchange since has confirmed the offset
    exchanges_disagree,  ///< the newest exchange has another offset than those before; the next one decides
};

/// Time stamps are wall time, may step at any moment, and never place a measurement. They only select between
/// several readings of a wrapping clock (see ClockMap), and show how far the bus has advanced. The offset
/// from time stamp to monotonic time comes from each SYNC with its FOLLOW_UP.
///
/// A jump of the time stamps makes "now" unknown. "Now" is known again when time stamps continue the old
/// series. If several in a row agree on the jump, it stays unknown until an exchange confirms the known
/// offset, or until two exchanges in a row agree on another. If one time stamp runs ahead within the
/// tolerance and later ones continue the series before it, that one was wrong: the clock continues from the
/// later ones.
class HostClockEstimate {
  public:
    explicit HostClockEstimate(const HostClockConfig& config = {}) : config_(config) {}

    /// Takes the time stamps of octoskin's own frames, in the order of arrival. Time stamps before 1970 or
    /// after 2116 are limited to these years.
    void observe(WallTime stamp);
    void learn(const SyncStamp& sync);

    /// The host's time at the newest time stamp. Never decreases while no time stamp jumps or runs ahead.
    /// Empty before the first exchange, after a jump, and while in doubt.
    [[nodiscard]] std::optional<HostTime> now() const;
    /// Why `now` is empty; empty if it is known.
    [[nodiscard]] std::optional<HostClockFault> fault() const noexcept;
    /// The duration over which frames have been received, with or without a known host time. It advances from
    /// time stamp to time stamp. It does not advance over a jump, or over a silence that looks like one. The
    /// advance of a time stamp that ran ahead is taken back.
    [[nodiscard]] Nanoseconds running() const noexcept { return running_; }
    /// The newest accepted time stamp; empty before the first frame.
    [[nodiscard]] std::optional<WallTime> newest_stamp() const noexcept { return stamp_max_; }
    /// Time of the first frame. To be read as soon as `now` is known: a later jump of the time stamps makes
    /// it wrong. Empty while `now` is.
    [[nodiscard]] std::optional<HostTime> begun() const {
        const auto newest = now();
        return newest ? std::optional(*newest - running_) : std::nullopt;
    }

    /// How often several time stamps agreed on a jump back.
    [[nodiscard]] std::uint64_t steps_back() const noexcept { return steps_back_; }
    /// How often several time stamps agreed on a jump ahead; a bus that was silent for as long looks the
    /// same.
    [[nodiscard]] std::uint64_t steps_ahead() const noexcept { return steps_ahead_; }
    /// How many time stamps jumped or ran ahead without agreement of others.
    [[nodiscard]] std::uint64_t stamps_ignored() const noexcept { return stamps_ignored_; }
    /// How often two exchanges agreed on a new offset.
    [[nodiscard]] std::uint64_t relocks() const noexcept { return relocks_; }

  private:
    /// Time stamps in a row that agree with each other but not with those before.
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
    std::optional<Jump> jump_;                ///< the next time stamps decide
    std::optional<Nanoseconds> offset_;       ///< host time - time stamp
    std::optional<Nanoseconds> offset_next_;  ///< disagrees with offset_; the next exchange decides
    bool is_in_doubt_ = false;
    std::uint64_t steps_back_ = 0;
    std::uint64_t steps_ahead_ = 0;
    std::uint64_t stamps_ignored_ = 0;
    std::uint64_t relocks_ = 0;
};

}  // namespace octoskin
