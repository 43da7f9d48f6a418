// Whether the joint states under the rig's joint node come from one sender.
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

/// Each sender counts its samples from 0 to 7, one a period. What a second one sends takes a number that the
/// first one uses a moment later, for another time or posture, or it is out of step with the numbers about
/// it. Which of the two is true cannot be decided, so that a sample is used only once its successor is here
/// and nothing has contradicted it: a quarter of a period after the first sender's own sample of that number
/// must have come. From the first contradiction on no sample is used until a second after the last one.
class JointSenderCheck {
  public:
    /// `waits`: false where joint states come from this machine alone, and nobody else can send under their
    /// node: then each is used as it comes.
    JointSenderCheck(double rate_hz, bool waits);

    /// A sample that need not wait any longer, or why it is not used.
    using Ended = std::vector<Result<JointMeasurement, JointReason>>;

    /// A whole sample whose time is known and whose source keeps the rig's rate, in the order of arrival.
    void on_sample(std::uint8_t sequence, const JointMeasurement& joints, HostTime now, Ended& ended);
    /// Of which rounds two frames of one number are that contradict each other.
    enum class Rounds : std::uint8_t {
        any,   ///< nobody knows
        none,  ///< one of them is of no round that the number's sender has sent
        one,   ///< both tell their time
    };
    /// A frame came that differs from one of the same number. If that one's sample waits, or both are of one
    /// round, it is of another sender. If it is not whole, the frame may as well be late by most of a round,
    /// as no sound bus has it: more of them within a second than a quarter of the rig's samples are of
    /// another sender, and two of those that are of no round: one may have been altered on its way.
    void on_contradiction(std::uint8_t sequence, Rounds rounds, HostTime now, Ended& ended);
    /// It is `now`: what has waited long enough has ended.
    void advance(HostTime now, Ended& ended);
    /// It is `now`: if that is before what waits came, the time went back, and what waits is used.
    void settle_if_back(HostTime now, Ended& ended);
    /// Nothing more will come: what waits is used.
    void settle(Ended& ended);

    [[nodiscard]] std::size_t waiting() const noexcept { return waiting_.size(); }
    [[nodiscard]] bool hears_two(HostTime now) const;
    /// How often two senders were found to contradict each other.
    [[nodiscard]] std::uint64_t contradictions() const noexcept { return contradictions_; }

    /// A sender that was silent for so long is heard no more.
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
    std::deque<Sample> waiting_;  ///< in the order of arrival; a round at most
    std::deque<Sample> recent_;   ///< of the last round, in the order of arrival
    RateLimit late_;
    RateLimit foreign_{1};
    std::optional<HostTime> found_;  ///< the newest contradiction
    std::uint64_t contradictions_ = 0;
};

}  // namespace octoskin
