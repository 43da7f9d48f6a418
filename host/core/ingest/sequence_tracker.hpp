// The readings of one sensor in their order: which are new, which were here before, how many are missing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

enum class SequenceFault : std::uint8_t {
    duplicate,      ///< the same reading again
    out_of_window,  ///< more than 32 readings old, or a later number with an earlier time
    too_soon,       ///< closer to its neighbours than so many ranging windows can be
    behind,         ///< an earlier number with a later time: no clock makes one sender say that
};

/// Where a reading belongs.
struct SequencePlace {
    bool is_newest = true;   ///< false: it came late
    unsigned left_out = 0;   ///< numbers between it and the newest before it
    bool is_counted = true;  ///< false: readings of unknown time came between, or none before
};

/// Six bits of sequence number alone cannot tell 40 lost readings from one that is 24 late: the capture time
/// does. A reading that is refused takes no number: the one that has it may still come.
class SequenceTracker {
  public:
    /// For readings in the order of arrival. `spacing_min`: two readings of a sensor are never closer.
    [[nodiscard]] Result<SequencePlace, SequenceFault> place(std::uint8_t sequence, HostTime captured,
                                                             Nanoseconds spacing_min) const;
    /// The reading has its number from now on, at the place that was found.
    void take(std::uint8_t sequence, HostTime captured, const SequencePlace& place);
    /// Both: takes it if it has a place.
    [[nodiscard]] Result<SequencePlace, SequenceFault> observe(std::uint8_t sequence, HostTime captured,
                                                               Nanoseconds spacing_min);

    /// A reading came whose time nobody knows: what the next one leaves out is no gap.
    void skip() noexcept { has_skipped_ = true; }

    /// The numbers begin anew, or the times of the newest readings were wrong. Gaps found so far stay
    /// counted.
    void restart() noexcept {
        captured_ = {};
        newest_.reset();
        has_skipped_ = false;
    }

    /// Readings that never came, so far as sequence numbers tell: exact while fewer than 64 are lost at once.
    /// A late one that is still used is taken off again.
    [[nodiscard]] std::uint64_t gaps() const noexcept { return gaps_; }

  private:
    [[nodiscard]] Result<SequencePlace, SequenceFault> place_later(std::uint8_t sequence, HostTime captured,
                                                                   Nanoseconds spacing_min) const;

    /// What is known of the last 64 numbers.
    std::array<std::optional<HostTime>, wire::kSequenceCount> captured_;
    std::optional<std::uint8_t> newest_;
    std::uint64_t gaps_ = 0;
    bool has_skipped_ = false;
};

}  // namespace octoskin
