// Converts CAN frames to measurements in host time. Every frame passes here. Keeps the state of the nodes,
// their clocks and the order of their readings. Does not count inputs and does not compute positions.
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
    /// A joint sample that arrives later than this after its sampling time is not used. Smaller than the
    /// steps of the wall clock that make a range's time field ambiguous: host/core/time/README.md.
    Nanoseconds joint_age_max{50'000'000};
};

/// Result of one frame: either the reason why it was not used, or any of the other fields.
struct FrameOutcome {
    std::optional<FrameReason> rejected;
    /// One for each reading in the frame that is not held.
    std::vector<Result<RangeMeasurement, ReadingReason>> readings;
    std::uint64_t readings_held = 0;               ///< readings that are held: CanIntake::take_due
    std::vector<ReadingReason> readings_given_up;  ///< rejected after they were held
    std::uint64_t joint_samples_begun = 0;
    /// Samples that this frame completed or ended.
    std::vector<Result<JointMeasurement, JointReason>> joint_samples;
    /// Samples that were waiting when the host time jumped back or was relocked: their times refer to the
    /// time before the jump.
    std::vector<Result<JointMeasurement, JointReason>> joint_samples_of_before;
    std::optional<wire::Mark> mark;
};

class CanIntake {
  public:
    explicit CanIntake(const HostRig& rig, const IntakeConfig& config = {});

    /// Takes frames in order of arrival. `stamp`: time of reception. About 1 us.
    [[nodiscard]] FrameOutcome on_frame(const wire::CanFrame& frame, WallTime stamp);

    /// Readings that were held in case a second sender contradicts them, and are now due.
    [[nodiscard]] std::vector<RangeMeasurement> take_due(HostTime now) { return held_.take_due(now); }
    /// All held readings, when no further frame can contradict them.
    [[nodiscard]] std::vector<RangeMeasurement> take_held() { return held_.take_all(); }
    [[nodiscard]] std::size_t readings_held() const noexcept { return held_.size(); }

    /// True while a node's readings have impossible times: a SYNC exchange would show whether its clock
    /// continues. False again after such an exchange.
    [[nodiscard]] bool wants_exchange() const;
    /// The readings that a node of the rig loses at `now`; empty if they are too few to report.
    [[nodiscard]] std::optional<NodeLosses::Loss> losses(wire::NodeId node, HostTime now) const {
        return losses_.at(node).worth_a_word(now);
    }

    /// Result in the map of a reading that was accepted here; empty: it was used.
    void on_fate_in_map(const BeamSource& source, std::optional<ReadingReason> rejected) {
        ranges_.on_fate_in_map(source.node_id, source.sensor, rejected);
        losses_.at(source.node_id).on_fate(rejected);
    }
    /// An accepted reading was rejected on its way into the map, through no fault of its sensor.
    void on_lost(wire::NodeId node, ReadingReason reason) { losses_.at(node).on_fate(reason); }
    /// Counters of all readings of a node of the rig; held readings are pending.
    [[nodiscard]] CounterTable reading_table(wire::NodeId node) const { return losses_.at(node).table(); }

    /// Host time at the newest time stamp; empty while unknown.
    [[nodiscard]] std::optional<HostTime> now() const { return host_clock_.now(); }
    /// Joint samples that have begun and not ended.
    [[nodiscard]] std::uint64_t joint_samples_pending() const;
    /// No frame arrives at present and the time is `now`: returns complete samples that need not wait longer.
    [[nodiscard]] JointSenderCheck::Ended joints_due(HostTime now);
    /// Returns all waiting complete samples, as if nothing more would arrive.
    [[nodiscard]] JointSenderCheck::Ended settle_joints();
    /// The senders under the node id of a source: its index in HostRig::joint_sources.
    [[nodiscard]] const JointSenderCheck& joint_senders(std::size_t source) const {
        return joint_sources_.at(source).senders;
    }

    [[nodiscard]] const NodeRegistry& nodes() const noexcept { return nodes_; }
    [[nodiscard]] const RangeGate& ranges() const noexcept { return ranges_; }
    [[nodiscard]] const HostClockEstimate& host_clock() const noexcept { return host_clock_; }
    /// For a node of the rig.
    [[nodiscard]] const ClockMap& clock(wire::NodeId node) const { return clocks_.at(node); }
    /// For a node of the rig: its answers to SYNC.
    [[nodiscard]] const AnswerCheck& answers(wire::NodeId node) const { return answers_.at(node); }

    /// For a node of the rig: what it reported about itself.
    [[nodiscard]] const SelfReportCheck& self_reports(wire::NodeId node) const {
        return self_reports_.at(node);
    }

  private:
    // One overload for each message type. The result goes into FrameOutcome::rejected.
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

    /// The capture time in host time, if the node is usable and its clock is known.
    [[nodiscard]] Result<MappedTime, ReadingReason> capture_time(wire::NodeId node,
                                                                 const wire::TimeResidue& capture) const;
    void accept(wire::NodeId node, const wire::RangeReading& reading, FrameOutcome& outcome);
    void note_fate(wire::NodeId node, const wire::RangeReading& reading,
                   const Result<RangeMeasurement, ReadingReason>& measurement);
    /// Rejects the held readings that this reading contradicts.
    void give_up_held(wire::NodeId node, const wire::RangeReading& reading, ReadingReason reason,
                      FrameOutcome& outcome);
    [[nodiscard]] Result<RangeMeasurement, ReadingReason> measure(wire::NodeId node,
                                                                  const wire::RangeReading& reading);
    struct JointIntake {
        wire::NodeId node = 0;
        std::size_t joint_count = 0;  ///< in the rig
        JointAssembler assembler;
        JointSenderCheck senders;
    };
    [[nodiscard]] Result<JointMeasurement, JointReason> place(std::size_t source, const JointReading& reading,
                                                              HostTime now) const;
    void add_exchange(wire::NodeId node);
    void note_damage(const wire::CanFrame& frame, wire::DecodeError error);
    void end_joint_samples(FrameOutcome& outcome);
    void note_time();
    void begin_time();
    /// The host time, once the time stamps have not jumped for a second: until then, delayed frames may
    /// arrive.
    [[nodiscard]] std::optional<HostTime> steady_now() const;

    IntakeConfig config_;
    HostClockEstimate host_clock_;
    SyncExchange exchange_;
    std::map<wire::NodeId, ClockMap> clocks_;
    std::map<wire::NodeId, AnswerCheck> answers_;           ///< for the same nodes
    std::map<wire::NodeId, ClockQuestion> questions_;       ///< for the same nodes
    std::map<wire::NodeId, NodeLosses> losses_;             ///< for the same nodes
    std::map<wire::NodeId, SelfReportCheck> self_reports_;  ///< for the same nodes
    ReadingHold held_;
    NodeRegistry nodes_;
    RangeGate ranges_;
    std::vector<JointIntake> joint_sources_;  ///< in the rig's order
    std::uint64_t relocks_ = 0;               ///< of the host's clock, at the newest frame
    WallTime stamp_;                          ///< of the current frame
    std::uint64_t jumps_ = 0;                 ///< of the time stamps, so far
    bool is_time_known_ = false;              ///< whether the host time was known at the newest frame
    std::optional<HostTime> known_since_;     ///< the host time after the last jump
};

}  // namespace octoskin
