// What became of a node's readings: of the last second, and of all.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/account/account.hpp"
#include "host/core/ingest/reasons.hpp"

namespace octoskin {

/// Because of the time, the numbers, the sender or what the node seemed to tell: nothing of these is usual,
/// and no sensor can be blamed for it. Not: what comes before the clock is known, nor a sensor whose times
/// its own node calls uncertain.
[[nodiscard]] bool is_loss(ReadingReason reason) noexcept;

class NodeLosses {
  public:
    /// More than this share, and more than one, is worth a word.
    static constexpr double kShareMax = 0.05;

    /// A reading came while "now" was known; a bus that repeats one brings none.
    void on_reading(HostTime now) {
        tenth_of(now).readings += 1;
        all_.take_in();
    }
    /// One was refused, maybe of an earlier moment.
    void on_refused(HostTime now, ReadingReason reason);
    /// What became of one that was not refused; empty: it is in the map.
    void on_fate(std::optional<ReadingReason> rejected) noexcept {
        rejected ? all_.reject(*rejected) : all_.use();
    }
    /// Of all that came while "now" was known; those without a fate so far are pending.
    [[nodiscard]] AccountTable table() const {
        return tabulate("readings", all_, all_.in() - all_.used() - all_.rejected());
    }

    struct Loss {
        double share = 0.0;  ///< of the readings of the last second
        ReadingReason most = ReadingReason::duplicate;
    };
    /// Empty: no more than `kShareMax`.
    [[nodiscard]] std::optional<Loss> worth_a_word(HostTime now) const;

  private:
    static constexpr std::size_t kTenths = 10;
    static constexpr std::size_t kReasons = names_of(ReadingReason{}).size();
    /// What came within a tenth of a second.
    struct Tenth {
        std::int64_t index = -1;  ///< of the tenth, on the host's clock
        std::uint32_t readings = 0;
        std::array<std::uint32_t, kReasons> refused{};
    };
    [[nodiscard]] Tenth& tenth_of(HostTime now);

    std::array<Tenth, kTenths> tenths_{};  ///< a ring
    Account<ReadingReason> all_;
};

}  // namespace octoskin
