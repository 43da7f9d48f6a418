// Checks that the joint states under the rig's joint node come from one sender.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/ingest/joint_measurement.hpp"
#include "host/core/ingest/rate_limit.hpp"
#include "host/core/ingest/reasons.hpp"

namespace octoskin {

/// Each sender counts its samples from 0 to 7, one a period. A sample of a second sender takes a number that
/// the first sender uses shortly before or after for another time or posture, or its number does not fit the
/// numbers around it. Which sender is the true one cannot be decided. A sample is therefore used only once
/// its successor has arrived and nothing has contradicted it: a quarter of a period after the first sender's
/// own sample of that number must have arrived. After a contradiction, no sample is used until a second after
/// the last one.
class JointSenderCheck {
  public:
    /// `waits`: false if joint states come from this machine only, so that no other sender can use their node
    /// id. Each sample is then used as it arrives.
    JointSenderCheck(double rate_hz, bool waits);

    /// A sample that need not wait any longer, or the reason why it is not used.
    using Ended = std::vector<Result<JointMeasurement, JointReason>>;

    /// Takes complete samples whose time is known and whose source keeps the rig's rate, in order of arrival.
    void on_sample(std::uint8_t sequence, const JointMeasurement& joints, HostTime now, Ended& ended);
    /// The rounds of two frames of one number that contradict each other.
    enum class Rounds : std::uint8_t {
        any,   ///< unknown
        none,  ///< one of them is of no round that the number's sender has sent
        one,   ///< both contain their time, and are of one round
    };
    /// A frame differs from an earlier one of the same number. If that one's sample waits, or both are of one
    /// round, the frame is from another sender. If the sample is incomplete, the frame may also be late by
    /// most of a round, which does not happen on a healthy bus. Another sender is then assumed after more
    /// such frames within a second than a quarter of the rig's samples, or after two frames of no round: one
    /// alone may have been corrupted.
    void on_contradiction(std::uint8_t sequence, Rounds rounds, HostTime now, Ended& ended);
    /// Advances to `now`: ends samples that have waited long enough.
    void advance(HostTime now, Ended& ended);
    /// If `now` is before the arrival of the newest waiting sample, the time jumped back: ends and uses all
    /// of them.
    void settle_if_back(HostTime now, Ended& ended);
    /// Nothing more will arrive: uses all waiting samples.
    void settle(Ended& ended);

    [[nodiscard]] std::size_t waiting() const noexcept { return waiting_.size(); }
    [[nodiscard]] bool hears_two(HostTime now) const;
    /// Number of contradictions found between two senders.
    [[nodiscard]] std::uint64_t contradictions() const noexcept { return contradictions_; }

    /// Time without a contradiction after which a second sender is no longer assumed.
    static constexpr Nanoseconds kHeardFor{1'000'000'000};

  private:
    struct Sample {
        std::uint8_t sequence = 0;
        HostTime came;
        JointMeasurement joints;
    };
    [[nodiscard]] bool contradict(const Sample& a, const Sample& b) const;
    [[nodiscard]] bool may_oldest_be_used(HostTime now) const;
    void find_two(HostTime now, Ended& ended);

    Nanoseconds period_;
    bool waits_;
    std::deque<Sample> waiting_;  ///< in order of arrival; at most one round
    std::deque<Sample> recent_;   ///< samples of the last round, in order of arrival
    RateLimit late_;
    RateLimit foreign_{1};
    std::optional<HostTime> found_;  ///< time of the newest contradiction
    std::uint64_t contradictions_ = 0;
};

}  // namespace octoskin
