// From a frame on the bus to measurements in host time: the gate that everything passes. It keeps who is on
// the bus, how their clocks run, and the order of their readings; it counts nothing and places nothing.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/messages.hpp"
#include "host/core/ingest/answer_check.hpp"
#include "host/core/ingest/clock_question.hpp"
#include "host/core/ingest/joint_assembler.hpp"
#include "host/core/ingest/joint_measurement.hpp"
#include "host/core/ingest/joint_sender_check.hpp"
#include "host/core/ingest/node_losses.hpp"
#include "host/core/ingest/node_registry.hpp"
#include "host/core/ingest/range_gate.hpp"
#include "host/core/ingest/reading_hold.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/ingest/self_report_check.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/core/time/clock_map.hpp"
#include "host/core/time/host_clock.hpp"
#include "host/core/time/sync_exchange.hpp"

namespace octoskin {

struct IntakeConfig {
    ClockMapConfig clock;
    HostClockConfig host_clock;
    bool uses_no_return = false;  ///< beams without return may clear space
    /// A joint sample that arrives later than this after it was sampled is not used. Less than what a
    /// stepping wall clock needs to make a range's time field ambiguous: host/core/time/README.md.
    Nanoseconds joint_age_max{50'000'000};
    /// Joint states come from this machine and from nowhere else: who sends them is checked before they
    /// become frames.
    bool has_local_joints = false;
};

/// What one frame brought: either a reason why it was not used, or any of the rest.
struct FrameOutcome {
    std::optional<FrameReason> rejected;
    /// One for each reading in the frame that need not wait.
    std::vector<Result<RangeMeasurement, ReadingReason>> readings;
    std::uint64_t readings_held = 0;               ///< those that do: CanIntake::take_due
    std::vector<ReadingReason> readings_given_up;  ///< of those that waited
    std::uint64_t joint_samples_begun = 0;
    std::vector<Result<JointMeasurement, JointReason>> joint_samples;  ///< those that this frame ended
    /// Those that waited when "now" went back, or was told anew: their times are of before.
    std::vector<Result<JointMeasurement, JointReason>> joint_samples_of_before;
    std::optional<wire::Mark> mark;
};

class CanIntake {
  public:
    explicit CanIntake(const HostRig& rig, const IntakeConfig& config = {});

    /// Frames in the order of arrival. `stamp`: when it was received. About 1 us.
    [[nodiscard]] FrameOutcome on_frame(const wire::CanFrame& frame, WallTime stamp);

    /// Readings that waited whether a second sender would contradict them, and are good now.
    [[nodiscard]] std::vector<RangeMeasurement> take_due(HostTime now) { return held_.take_due(now); }
    /// All that wait: no frame comes that could contradict them.
    [[nodiscard]] std::vector<RangeMeasurement> take_held() { return held_.take_all(); }
    [[nodiscard]] std::size_t readings_held() const noexcept { return held_.size(); }

    /// A node's readings have times that cannot be: an exchange would tell whether its clock goes on. False
    /// again after it.
    [[nodiscard]] bool wants_exchange() const;
    /// Of a node of the rig: what it loses at `now`, if that is worth a word.
    [[nodiscard]] std::optional<NodeLosses::Loss> losses(wire::NodeId node, HostTime now) const {
        return losses_.at(node).worth_a_word(now);
    }

    /// What became in the map of a reading that was accepted here; empty: it was used.
    void on_fate_in_map(const BeamSource& source, std::optional<ReadingReason> rejected) {
        ranges_.on_fate_in_map(source.node_id, source.sensor, rejected);
        losses_.at(source.node_id).on_fate(rejected);
    }
    /// One that was accepted here is rejected on its way into the map; no sensor is to blame.
    void on_lost(wire::NodeId node, ReadingReason reason) { losses_.at(node).on_fate(reason); }
    /// Of all readings of a node of the rig; what waits is pending.
    [[nodiscard]] AccountTable reading_table(wire::NodeId node) const { return losses_.at(node).table(); }

    /// The host's clock at the newest stamp; empty while unknown.
    [[nodiscard]] std::optional<HostTime> now() const { return host_clock_.now(); }
    /// Joint samples begun and not ended.
    [[nodiscard]] std::uint64_t joint_samples_pending() const {
        return joints_.pending() + joint_senders_.waiting();
    }
    /// No frame comes for now, and it is `now`: whole samples that need not wait any longer.
    [[nodiscard]] JointSenderCheck::Ended joints_due(HostTime now) {
        JointSenderCheck::Ended ended;
        joint_senders_.advance(now, ended);
        return ended;
    }
    /// Whole samples that wait, as if nothing more would come.
    [[nodiscard]] JointSenderCheck::Ended settle_joints() {
        JointSenderCheck::Ended ended;
        joint_senders_.settle(ended);
        return ended;
    }
    [[nodiscard]] const JointSenderCheck& joint_senders() const noexcept { return joint_senders_; }

    [[nodiscard]] const NodeRegistry& nodes() const noexcept { return nodes_; }
    [[nodiscard]] const RangeGate& ranges() const noexcept { return ranges_; }
    [[nodiscard]] const HostClockEstimate& host_clock() const noexcept { return host_clock_; }
    /// Of a node of the rig.
    [[nodiscard]] const ClockMap& clock(wire::NodeId node) const { return clocks_.at(node); }
    /// Likewise: what it answered to SYNC.
    [[nodiscard]] const AnswerCheck& answers(wire::NodeId node) const { return answers_.at(node); }

    /// Likewise: what it told about itself.
    [[nodiscard]] const SelfReportCheck& self_reports(wire::NodeId node) const {
        return self_reports_.at(node);
    }

  private:
    // One for each message. What they return goes into FrameOutcome::rejected.
    using Rejection = std::optional<FrameReason>;
    Rejection on(wire::NodeId node, const wire::Range& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::RangeFd& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::RangeAux& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::Heartbeat& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::NodeInfo& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::SensorHealth& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::SyncReport& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::JointState& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId host, const wire::Sync& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId host, const wire::FollowUp& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId host, const wire::Mark& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::Command& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::Reflex& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::BlackBox& message, FrameOutcome& outcome);
    Rejection on(wire::NodeId node, const wire::Calibration& message, FrameOutcome& outcome);

    /// In host time, if the node is usable and its clock known.
    [[nodiscard]] Result<MappedTime, ReadingReason> capture_time(wire::NodeId node,
                                                                 const wire::TimeResidue& capture) const;
    void accept(wire::NodeId node, const wire::RangeReading& reading, FrameOutcome& outcome);
    void note_fate(wire::NodeId node, const wire::RangeReading& reading,
                   const Result<RangeMeasurement, ReadingReason>& measurement);
    /// Of those that wait: what this reading shows to be nobody's.
    void give_up_held(wire::NodeId node, const wire::RangeReading& reading, ReadingReason reason,
                      FrameOutcome& outcome);
    [[nodiscard]] Result<RangeMeasurement, ReadingReason> measure(wire::NodeId node,
                                                                  const wire::RangeReading& reading);
    [[nodiscard]] Result<JointMeasurement, JointReason> place(const JointReading& reading,
                                                              HostTime now) const;
    void add_exchange(wire::NodeId node);
    void note_damage(const wire::CanFrame& frame, wire::DecodeError error);
    void end_joint_samples(FrameOutcome& outcome);
    void note_time();
    void begin_time();
    /// "Now", once the stamps have not jumped for a second: before, what was held back may still come.
    [[nodiscard]] std::optional<HostTime> steady_now() const;

    IntakeConfig config_;
    wire::NodeId joint_source_;
    HostClockEstimate host_clock_;
    SyncExchange exchange_;
    std::map<wire::NodeId, ClockMap> clocks_;
    std::map<wire::NodeId, AnswerCheck> answers_;           ///< of the same nodes
    std::map<wire::NodeId, ClockQuestion> questions_;       ///< of the same nodes
    std::map<wire::NodeId, NodeLosses> losses_;             ///< likewise
    std::map<wire::NodeId, SelfReportCheck> self_reports_;  ///< likewise
    ReadingHold held_;
    NodeRegistry nodes_;
    RangeGate ranges_;
    JointAssembler joints_;
    JointSenderCheck joint_senders_;
    std::uint64_t relocks_ = 0;            ///< of the host's clock, at the newest frame
    WallTime stamp_;                       ///< of the frame at hand
    std::uint64_t jumps_ = 0;              ///< of the stamps, so far
    bool is_time_known_ = false;           ///< "now", at the newest frame
    std::optional<HostTime> known_since_;  ///< "now" after the last of them
};

}  // namespace octoskin
