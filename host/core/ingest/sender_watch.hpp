// Whether two senders speak under one sensor's name. One sender's readings have numbers that count on: a
// second one's cannot be told from them one by one, but they cannot both go on.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/ingest/rate_limit.hpp"

namespace octoskin {

/// Two kinds of evidence, by "now" on the bus:
///
/// - A *contradiction*: a number that was here with other contents, or an earlier number with a later time.
///   Which of the two is true cannot be told. One alone may be a damaged frame: CRC-8 lets one in 256 pass.
///   Of two within a second the sensor is *disputed* until a second after the last.
/// - A *stray*: a reading that was refused for its time or number between two that lack none between them.
///   It did no harm, so it is only named; more than a quarter of the sensor's own in a second make the sensor
///   disputed, as it may be the wrong ones that are used. A damaged frame may be a stray, too, but for each
///   that CRC-8 lets through 255 are refused: one alone is not named where any was within the last minute,
///   two within 2.5 s always are.
class SenderWatch {
  public:
    static constexpr Nanoseconds kDisputeHold{1'000'000'000};
    static constexpr Nanoseconds kStrayHold{2'500'000'000};
    static constexpr Nanoseconds kDamageHold{60'000'000'000};

    /// `period`: of the sensor's ranges, as configured.
    explicit SenderWatch(Nanoseconds period);

    void on_contradiction(HostTime now);
    /// A frame of its node did not fit its checksum.
    void on_damage(HostTime now) noexcept { damaged_ = now; }
    /// A reading was refused for its time or number.
    void on_refused() noexcept { ++refused_; }
    /// One was taken, later than those before. `left_out`: numbers between them; empty: cannot be told.
    void on_taken(std::optional<unsigned> left_out, HostTime now);
    /// The clock was wrong, or the numbers begin anew: what was refused tells nothing.
    void forget_refused() noexcept { refused_ = 0; }

    /// Its readings are to stay out.
    [[nodiscard]] bool is_disputed(HostTime now) const noexcept;
    /// A person is to know: it is disputed, or strays come.
    [[nodiscard]] bool is_named(HostTime now) const noexcept;

    [[nodiscard]] std::uint64_t contradictions() const noexcept { return contradictions_; }
    [[nodiscard]] std::uint64_t strays() const noexcept { return strays_; }

  private:
    void on_stray(HostTime now);

    RateLimit strays_kept_;
    std::uint64_t contradictions_ = 0;
    std::uint64_t strays_ = 0;
    unsigned refused_ = 0;  ///< since the newest that was taken
    std::optional<HostTime> contradicted_;
    bool is_disputed_ = false;  ///< at the newest of them
    std::optional<HostTime> damaged_;
    std::optional<HostTime> strayed_;
    std::optional<HostTime> strayed_surely_;  ///< and no damage explains it
};

}  // namespace octoskin
