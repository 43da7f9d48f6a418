// Joins the four frames of one sequence number to one joint sample.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/core/ingest/joint_pace.hpp"
#include "host/core/ingest/joint_rounds.hpp"
#include "host/core/ingest/reasons.hpp"

namespace octoskin {

/// A complete sample, not yet placed in time.
struct JointReading {
    std::uint8_t sequence = 0;
    std::array<double, wire::kJointsPerSample> position_rad{};
    wire::TimeResidue sampled;
    HostTime begun;  ///< arrival of its first frame
    /// its frames arrived in the order in which they are sent; the frame with the time is last
    bool is_in_order = true;
    bool has_pace = false;  ///< its source is not faster than the rig's rate (JointPace)
};

/// The sequence number has three bits and wraps within 80 ms at 100 Hz. A sample that is incomplete after
/// half a round is given up. Three cases can still mix frames of two rounds:
///
/// - A frame that is nearly a whole round late meets frames of the next round. It then arrived before that
///   sample was taken, which `JointReading::begun` shows.
/// - A sample whose first frames are lost meets the first frame of the next round. That frame arrived one
///   round after the sample was taken, and behind later frames: `JointReading::is_in_order`.
/// - A source faster than the rig's rate mixes frames of several rounds: `JointReading::has_pace`.
///
/// A sample that follows a contradiction within one sample may contain frames of both versions and is given
/// up as well.
class JointAssembler {
  public:
    explicit JointAssembler(double rate_hz);

    struct Outcome {
        bool opened = false;       ///< the frame was the first of a sample
        bool is_repeated = false;  ///< the sample already has this frame, with the same contents
        /// The sample already has this frame, with other contents: one of the two is from another round or
        /// from another sender.
        bool is_contradiction = false;
        /// Contradiction; both contain the sampling time, less than half a round apart: both are of one
        /// round.
        bool is_of_one_round = false;
        /// Contradiction; every frame of the round before arrived in time: this frame is of no round of the
        /// number's sender, but from another sender.
        bool is_of_no_round = false;
        std::optional<JointReading> complete;
        std::vector<JointReason> given_up;  ///< one for each sample that ended incomplete
    };
    /// Takes frames in order of arrival.
    [[nodiscard]] Outcome on_frame(const wire::JointState& frame, HostTime now);

    /// Time after which a sequence number repeats, at the rig's rate.
    [[nodiscard]] Nanoseconds round() const noexcept { return 2 * patience_; }
    /// Samples that have begun and are not complete.
    [[nodiscard]] std::uint64_t pending() const;

  private:
    static constexpr std::uint8_t kParts = 4;
    struct Sample {
        HostTime opened;
        bool is_complete = false;  ///< kept, so that a repeated frame does not begin it again
        /// follows a sample that contradicted itself: it may contain frames of both
        bool is_contested = false;
        std::uint8_t newest_part = 0;
        bool is_in_order = true;
        std::array<std::optional<wire::JointState>, kParts> parts;
    };
    void give_up_stale(HostTime now, Outcome& outcome);
    void begin_round(std::uint8_t sequence, Outcome& outcome);
    [[nodiscard]] bool are_of_one_round(const wire::JointState& a, const wire::JointState& b) const;

    Nanoseconds patience_;
    JointPace pace_;
    JointRounds rounds_;
    std::uint8_t newest_ = 0;  ///< sequence number of the newest sample begun
    std::array<std::optional<Sample>, wire::kJointSequenceCount> samples_;
};

}  // namespace octoskin
