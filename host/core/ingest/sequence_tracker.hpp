// Tracks the order of one sensor's readings: which are new, which are repeats, how many are missing.
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
    too_soon,       ///< closer to its neighbours than that many ranging windows allow
    behind,  ///< an earlier number with a later time, which one sender never sends, whatever its clock does
};

/// The place of a reading in the sequence.
struct SequencePlace {
    bool is_newest = true;   ///< false: it arrived late
    unsigned left_out = 0;   ///< numbers between it and the newest reading before it
    bool is_counted = true;  ///< false: readings of unknown time came between, or there is none before it
};

/// Six bits of sequence number alone do not distinguish 40 lost readings from one that is 24 late. The
/// capture time does. A refused reading takes no number: the true reading of that number may still arrive.
class SequenceTracker {
  public:
    /// Takes readings in order of arrival. `spacing_min`: the smallest distance of two readings of the
    /// sensor.
    [[nodiscard]] Result<SequencePlace, SequenceFault> place(std::uint8_t sequence, HostTime captured,
                                                             Nanoseconds spacing_min) const;
    /// The reading has its number from now on, at the place that was found.
    void take(std::uint8_t sequence, HostTime captured, const SequencePlace& place);
    /// Calls `place`, and `take` if there is a place.
    [[nodiscard]] Result<SequencePlace, SequenceFault> observe(std::uint8_t sequence, HostTime captured,
                                                               Nanoseconds spacing_min);

    /// A reading of unknown time arrived: the numbers that the next one leaves out are not counted as a gap.
    void skip() noexcept { has_skipped_ = true; }

    /// The numbers restart, or the times of the newest readings were wrong. Gaps that were counted stay
    /// counted.
    void restart() noexcept {
        captured_ = {};
        newest_.reset();
        has_skipped_ = false;
    }

    /// Readings that never arrived, by sequence numbers: exact while fewer than 64 are lost at once. A late
    /// reading that is still used is subtracted.
    [[nodiscard]] std::uint64_t gaps() const noexcept { return gaps_; }

  private:
    [[nodiscard]] Result<SequencePlace, SequenceFault> place_later(std::uint8_t sequence, HostTime captured,
                                                                   Nanoseconds spacing_min) const;

    /// Capture times under the last 64 numbers, where known.
    std::array<std::optional<HostTime>, wire::kSequenceCount> captured_;
    std::optional<std::uint8_t> newest_;
    std::uint64_t gaps_ = 0;
    bool has_skipped_ = false;
};

}  // namespace octoskin
