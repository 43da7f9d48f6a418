// Results of a node's readings: over the last second, and in total.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/counters/input_counters.hpp"
#include "host/core/ingest/reasons.hpp"

namespace octoskin {

/// True for rejections because of the time, the sequence numbers, the sender or what the node seemed to
/// report. None of these is usual, and no sensor causes them. False for readings before the clock is known,
/// and for a sensor whose capture times its own node reports as uncertain.
[[nodiscard]] bool is_loss(ReadingReason reason) noexcept;

class NodeLosses {
  public:
    /// A larger share than this, and more than one reading, is worth reporting.
    static constexpr double kShareMax = 0.05;

    /// A reading arrived while the host time was known. A repeated frame does not count.
    void on_reading(HostTime now) {
        tenth_of(now).readings += 1;
        all_.count_in();
    }
    /// A reading was rejected, perhaps one that arrived earlier.
    void on_refused(HostTime now, ReadingReason reason);
    /// Result of a reading that was not rejected; empty: it is in the map.
    void on_fate(std::optional<ReadingReason> rejected) noexcept {
        rejected ? all_.reject(*rejected) : all_.use();
    }
    /// Counters of all readings that arrived while the host time was known; those without a result are
    /// pending.
    [[nodiscard]] CounterTable table() const {
        return tabulate("readings", all_, all_.in() - all_.used() - all_.rejected());
    }

    struct Loss {
        double share = 0.0;  ///< of the readings of the last second
        ReadingReason most = ReadingReason::duplicate;
    };
    /// Empty if no more than `kShareMax` is lost.
    [[nodiscard]] std::optional<Loss> worth_a_word(HostTime now) const;

  private:
    static constexpr std::size_t kTenths = 10;
    static constexpr std::size_t kReasons = names_of(ReadingReason{}).size();
    /// What arrived within a tenth of a second.
    struct Tenth {
        std::int64_t index = -1;  ///< number of the tenth on the host's clock
        std::uint32_t readings = 0;
        std::array<std::uint32_t, kReasons> refused{};
    };
    [[nodiscard]] Tenth& tenth_of(HostTime now);

    std::array<Tenth, kTenths> tenths_{};  ///< ring buffer
    InputCounters<ReadingReason> all_;
};

}  // namespace octoskin
