// Decides whether two senders use one sensor's id. One sender's readings have consecutive numbers. Single
// readings of a second sender look like them, but both cannot continue their numbers.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/ingest/rate_limit.hpp"

namespace octoskin {

/// Two kinds of evidence, by host time:
///
/// - A *contradiction*: a number that was received before with other contents, or an earlier number with a
///   later time. Which of the two readings is true is unknown. A single contradiction may be a damaged frame:
///   CRC-8 passes one in 256. After two within a second, the sensor is *disputed* until a second after the
///   last one.
/// - A *stray*: a reading that was refused for its time or number, while the accepted readings before and
///   after it have no gap. It did no harm and is only reported. More strays in a second than a quarter of the
///   sensor's own readings make the sensor disputed, because the accepted readings may be the wrong ones. A
///   damaged frame may also be a stray, but for each that CRC-8 passes, 255 are refused. A single stray is
///   therefore not reported if a frame was damaged within the last minute. Two within 2.5 s are always
///   reported.
class SenderWatch {
  public:
    static constexpr Nanoseconds kDisputeHold{1'000'000'000};
    static constexpr Nanoseconds kStrayHold{2'500'000'000};
    static constexpr Nanoseconds kDamageHold{60'000'000'000};

    /// `period`: of the sensor's ranges, as configured.
    explicit SenderWatch(Nanoseconds period);

    void on_contradiction(HostTime now);
    /// A frame of its node had a wrong checksum.
    void on_damage(HostTime now) noexcept { damaged_ = now; }
    /// A reading was refused for its time or number.
    void on_refused() noexcept { ++refused_; }
    /// A reading was accepted that is later than those before. `left_out`: count of numbers between them;
    /// empty: unknown.
    void on_taken(std::optional<unsigned> left_out, HostTime now);
    /// The clock was wrong, or the numbers restart: refused readings are no evidence.
    void forget_refused() noexcept { refused_ = 0; }

    /// True: the sensor's readings are not used.
    [[nodiscard]] bool is_disputed(HostTime now) const noexcept;
    /// True: reported to people, because the sensor is disputed or strays arrive.
    [[nodiscard]] bool is_named(HostTime now) const noexcept;

    [[nodiscard]] std::uint64_t contradictions() const noexcept { return contradictions_; }
    [[nodiscard]] std::uint64_t strays() const noexcept { return strays_; }

  private:
    void on_stray(HostTime now);

    RateLimit strays_kept_;
    std::uint64_t contradictions_ = 0;
    std::uint64_t strays_ = 0;
    unsigned refused_ = 0;  ///< since the newest accepted reading
    std::optional<HostTime> contradicted_;
    bool is_disputed_ = false;  ///< at the newest contradiction
    std::optional<HostTime> damaged_;
    std::optional<HostTime> strayed_;
    std::optional<HostTime> strayed_surely_;  ///< the newest stray that no damaged frame explains
};

}  // namespace octoskin
