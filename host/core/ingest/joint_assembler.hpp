// Four frames of one sequence number make one joint sample.
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

/// A whole sample, not yet placed in time.
struct JointReading {
    std::uint8_t sequence = 0;
    std::array<double, wire::kJointsPerSample> position_rad{};
    wire::TimeResidue sampled;
    HostTime begun;           ///< arrival of its first frame
    bool is_in_order = true;  ///< its frames came as they are sent, that with the time last
    bool has_pace = false;    ///< its source is not quicker than the rig says (JointPace)
};

/// The sequence has three bits only, and comes round within 80 ms at 100 Hz: a sample that is not complete
/// within half a round is given up. A frame that is nearly a whole round late can still meet those of the
/// next round; it then came before that sample was taken, which `JointReading::begun` shows. One whose first
/// frames are lost can meet the first frame of the next round instead, which then came a round after it was
/// taken, and behind later ones: `JointReading::is_in_order`. Of a source that
/// is quicker than the rig says, frames of several rounds may meet: `JointReading::has_pace`. What follows a
/// contradiction within one sample may have frames of both of its versions, and is given up as well.
class JointAssembler {
  public:
    explicit JointAssembler(double rate_hz);

    struct Outcome {
        bool opened = false;       ///< the frame was the first of a sample
        bool is_repeated = false;  ///< the sample has this frame already, with the same content
        /// The sample has this frame already, with another content: one of them is of another round, or of
        /// another sender.
        bool is_contradiction = false;
        /// And both tell when the sample was taken, less than half a round apart: they are of one round.
        bool is_of_one_round = false;
        /// Or each frame of the round before was here in its time: it is of none, but another sender's.
        bool is_of_no_round = false;
        std::optional<JointReading> complete;
        std::vector<JointReason> given_up;  ///< one for each sample that ended without being complete
    };
    /// Takes frames in the order of arrival.
    [[nodiscard]] Outcome on_frame(const wire::JointState& frame, HostTime now);

    /// A sequence number comes again so long after, at the rig's rate.
    [[nodiscard]] Nanoseconds round() const noexcept { return 2 * patience_; }
    /// Samples begun and not complete.
    [[nodiscard]] std::uint64_t pending() const;

  private:
    static constexpr std::uint8_t kParts = 4;
    struct Sample {
        HostTime opened;
        bool is_complete = false;   ///< kept, so that a repeated frame does not open it again
        bool is_contested = false;  ///< follows one that contradicted itself: it may have frames of both
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
