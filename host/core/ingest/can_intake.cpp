#include "host/core/ingest/can_intake.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <variant>

#include "common/wire/codec.hpp"
#include "host/core/ingest/rejecting.hpp"

namespace octoskin {
namespace {

/// Positions beyond the source's joints are zero on the wire. Another value is that of a joint which the rig
/// does not have, so that the joints before it may be other ones, too.
bool has_joint_beyond(const JointReading& reading, std::size_t joint_count) {
    const auto rest = std::span(reading.position_rad).subspan(joint_count);
    return std::ranges::any_of(rest, [](double position) { return position != 0.0; });
}

}  // namespace

CanIntake::CanIntake(const HostRig& rig, const IntakeConfig& config)
    : config_(config),
      host_clock_(config.host_clock),
      nodes_(rig),
      ranges_(rig, config.uses_no_return, Nanoseconds{config.clock.now_slack}) {
    for (const HostJointSource& source : rig.joint_sources) {
        joint_sources_.push_back({source.node_id, source.joints.size(), JointAssembler(source.rate_hz),
                                  JointSenderCheck(source.rate_hz, !source.is_local)});
    }
    for (const auto& [node, record] : nodes_.records()) {
        clocks_.emplace(node, ClockMap(config.clock));
        answers_.try_emplace(node);
        questions_.try_emplace(node);
        losses_.try_emplace(node);
        self_reports_.try_emplace(node);
    }
}

FrameOutcome CanIntake::on_frame(const wire::CanFrame& frame, WallTime stamp) {
    stamp_ = stamp;
    FrameOutcome outcome;
    const auto decoded = wire::decode(frame);
    if (!decoded) {
        outcome.rejected = reason_of(decoded.error());
        note_damage(frame, decoded.error());
        const wire::NodeId sender = wire::node_of(frame.can_id);
        if (decoded.error() == wire::DecodeError::wrong_version &&
            wire::type_of(frame.can_id) == wire::FrameType::heartbeat && nodes_.knows(sender)) {
            constexpr unsigned kVersionMask = 7;  // frozen for all versions: docs/protocol.md
            nodes_.on_other_version(sender, static_cast<std::uint8_t>(frame.data[0] & kVersionMask), now());
        }
        return outcome;
    }
    const wire::NodeId node = decoded->node_id;
    const bool is_from_node =
        node != wire::kHostId && !std::holds_alternative<wire::Command>(decoded->message);
    if (is_from_node && !nodes_.knows(node)) {
        outcome.rejected = FrameReason::unknown_node;
        return outcome;
    }
    // Only after these checks: an unknown node on another interface of the log must not move the host time.
    host_clock_.observe(stamp);
    nodes_.on_running(host_clock_.running());
    note_time();
    end_joint_samples(outcome);
    if (is_from_node) {
        nodes_.on_frame(node, steady_now());
    }
    outcome.rejected =
        std::visit([&](const auto& message) { return on(node, message, outcome); }, decoded->message);
    end_joint_samples(outcome);
    return outcome;
}

/// Uses the last known host time: the time stamp of a damaged frame changes nothing.
void CanIntake::note_damage(const wire::CanFrame& frame, wire::DecodeError error) {
    const wire::NodeId node = wire::node_of(frame.can_id);
    const auto now_known = now();
    if (error == wire::DecodeError::wrong_crc && now_known && nodes_.knows(node)) {
        ranges_.on_damage(node, *now_known);
    }
}

void CanIntake::end_joint_samples(FrameOutcome& outcome) {
    const auto now_known = now();
    if (!now_known) return;
    const bool has_relocked =
        std::exchange(relocks_, host_clock_.relocks()) != host_clock_.relocks();  // host time may be equal
    for (JointIntake& source : joint_sources_) {
        if (has_relocked) source.senders.settle(outcome.joint_samples_of_before);
        source.senders.settle_if_back(*now_known, outcome.joint_samples_of_before);
        source.senders.advance(*now_known, outcome.joint_samples);
    }
}

std::uint64_t CanIntake::joint_samples_pending() const {
    std::uint64_t pending = 0;
    for (const JointIntake& source : joint_sources_)
        pending += source.assembler.pending() + source.senders.waiting();
    return pending;
}

JointSenderCheck::Ended CanIntake::joints_due(HostTime now) {
    JointSenderCheck::Ended ended;
    for (JointIntake& source : joint_sources_) source.senders.advance(now, ended);
    return ended;
}

JointSenderCheck::Ended CanIntake::settle_joints() {
    JointSenderCheck::Ended ended;
    for (JointIntake& source : joint_sources_) source.senders.settle(ended);
    return ended;
}

void CanIntake::note_time() {
    const std::uint64_t jumps = host_clock_.steps_back() + host_clock_.steps_ahead() + host_clock_.relocks();
    if (std::exchange(jumps_, jumps) != jumps) known_since_.reset();
    if (!known_since_) begin_time();
    const auto now_known = now();
    if (!std::exchange(is_time_known_, now_known.has_value()) && now_known) nodes_.on_time_known(*now_known);
}

void CanIntake::begin_time() {
    known_since_ = now();
    if (!known_since_) return;
    for (const auto& [node, record] : nodes_.records()) ranges_.expect(node, known_since_);
}

std::optional<HostTime> CanIntake::steady_now() const {
    constexpr Nanoseconds kSteady{1'000'000'000};
    const auto now_known = now();
    return known_since_ && now_known && *now_known - *known_since_ >= kSteady ? now_known : std::nullopt;
}

Result<MappedTime, ReadingReason> CanIntake::capture_time(wire::NodeId node,
                                                          const wire::TimeResidue& capture) const {
    const auto now_known = now();
    if (const auto reason = reason_of(nodes_.verdict(node, now_known))) {
        return unexpected(*reason);
    }
    if (!now_known) {
        return unexpected(ReadingReason::no_host_time);
    }
    const auto captured = clocks_.at(node).locate(capture, *now_known);
    if (!captured) {
        return unexpected(clock_reason<ReadingReason>(captured.error()));
    }
    return *captured;
}

void CanIntake::accept(wire::NodeId node, const wire::RangeReading& reading, FrameOutcome& outcome) {
    if (!ranges_.knows(node, reading.sensor)) {
        outcome.readings.push_back(unexpected(ReadingReason::unknown_sensor));
        return;
    }
    ranges_.on_arrival(node, reading, now());
    nodes_.on_reading(node, reading, steady_now());
    auto measurement = measure(node, reading);
    note_fate(node, reading, measurement);
    if (!measurement) {
        give_up_held(node, reading, measurement.error(), outcome);
    } else if (const auto until = ranges_.held_until(*measurement, *now())) {
        if (held_.put(*measurement, reading.sequence, *until)) {
            ++outcome.readings_held;
            return;
        }
        measurement = unexpected(ReadingReason::contradicts_reading);
    }
    outcome.readings.push_back(measurement);
}

void CanIntake::note_fate(wire::NodeId node, const wire::RangeReading& reading,
                          const Result<RangeMeasurement, ReadingReason>& measurement) {
    const auto rejected = measurement ? std::nullopt : std::optional(measurement.error());
    ranges_.on_fate(node, reading.sensor, rejected);
    const auto now_known = now();
    if (!now_known || rejected == ReadingReason::duplicate) {
        return;
    }
    losses_.at(node).on_reading(*now_known);
    if (rejected) {
        losses_.at(node).on_refused(*now_known, *rejected);
    }
}

/// A reading that repeats a number with other contents is rejected together with the held reading of the same
/// number: either may be the foreign one. If no reading of that number is held (an earlier number came with a
/// later time), or the sensor is already disputed, all held readings of the sensor are rejected.
void CanIntake::give_up_held(wire::NodeId node, const wire::RangeReading& reading, ReadingReason reason,
                             FrameOutcome& outcome) {
    if (reason != ReadingReason::contradicts_reading) {
        return;
    }
    const std::size_t twins = held_.drop(node, reading.sensor, reading.sequence);
    const bool are_all_doubtful = twins == 0 || ranges_.senders(node, reading.sensor).is_disputed(*now());
    const std::size_t others = are_all_doubtful ? held_.drop(node, reading.sensor) : 0;
    outcome.readings_given_up.insert(outcome.readings_given_up.end(), twins,
                                     ReadingReason::contradicts_reading);
    outcome.readings_given_up.insert(outcome.readings_given_up.end(), others, ReadingReason::sensor_disputed);
    for (const ReadingReason given_up : outcome.readings_given_up) {
        losses_.at(node).on_refused(*now(), given_up);
    }
}

Result<RangeMeasurement, ReadingReason> CanIntake::measure(wire::NodeId node,
                                                           const wire::RangeReading& reading) {
    const auto captured = capture_time(node, reading.capture);
    if (!captured) {
        return unexpected(ranges_.skip(node, reading, now()).value_or(captured.error()));
    }
    ClockQuestion& question = questions_.at(node);
    auto measurement = ranges_.check(node, reading, *captured, *now(), question.is_open());
    if (!measurement && contradicts_clock(measurement.error())) {
        question.on_impossible(reading.sensor);
    } else if (measurement) {
        question.on_possible(reading.sensor);
    }
    return measurement;
}

bool CanIntake::wants_exchange() const {
    return std::ranges::any_of(questions_, [](const auto& entry) { return entry.second.wants_exchange(); });
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::Range& message, FrameOutcome& outcome) {
    accept(node, message.reading, outcome);
    return std::nullopt;
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::RangeFd& message, FrameOutcome& outcome) {
    for (std::size_t i = 0; i < message.count; ++i) {
        const wire::RangeFd::Entry& entry = message.entries[i];
        accept(node, entry.reading, outcome);
        if (ranges_.knows(node, entry.reading.sensor)) {
            ranges_.on_signal(node, entry.reading.sensor, entry.signal);
        }
    }
    return std::nullopt;
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::RangeAux& message, FrameOutcome&) {
    if (!ranges_.knows(node, message.sensor)) {
        return FrameReason::unknown_sensor;
    }
    ranges_.on_signal(node, message.sensor, message.signal);
    return std::nullopt;
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::Heartbeat& message, FrameOutcome&) {
    ranges_.on_rate(node, message.is_rate_overridden, now());
    if (nodes_.verdict(node, now()) != NodeCondition::usable) ranges_.expect(node, now());
    if (nodes_.on_heartbeat(node, message, now()) == NodeRegistry::Life::restarted) {
        clocks_.at(node).forget();
        answers_.at(node).forget();
        questions_.at(node).answer();
        ranges_.forget(node);
        self_reports_.at(node).forget();
    }
    SelfReportCheck& reports = self_reports_.at(node);
    reports.on_report(SelfReportCheck::Fact::time_suspect, 0, message.is_time_suspect ? 1 : 0, steady_now());
    reports.on_report(SelfReportCheck::Fact::hash_low, 0, message.node_hash_low, steady_now());
    return std::nullopt;
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::NodeInfo& message, FrameOutcome&) {
    if (!nodes_.on_info(node, message, now())) return FrameReason::node_refused;
    SelfReportCheck& reports = self_reports_.at(node);
    if (const auto* identity = std::get_if<wire::InfoIdentity>(&message))
        reports.on_report(SelfReportCheck::Fact::hash, 0, identity->node_hash, steady_now());
    if (const auto* build = std::get_if<wire::InfoBuild>(&message))
        reports.on_report(SelfReportCheck::Fact::build, 0, build->build_id, steady_now());
    return std::nullopt;
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::SensorHealth& message, FrameOutcome&) {
    if (!ranges_.knows(node, message.sensor)) {
        return FrameReason::unknown_sensor;
    }
    ranges_.on_health(node, message, now());
    const bool is_certain = ranges_.is_certain(node, message.sensor);
    self_reports_.at(node).on_report(SelfReportCheck::Fact::certain, message.sensor, is_certain ? 1 : 0,
                                     steady_now());
    return std::nullopt;
}

void CanIntake::add_exchange(wire::NodeId node) {
    const auto answers = exchange_.take_samples(node);
    const auto verdict = answers.empty() ? std::nullopt : answers_.at(node).take(answers, clocks_.at(node));
    if (!verdict) {
        return;
    }
    if (verdict == SampleEffect::contradicts) {
        ranges_.on_clock_contradicted(node);
        return;
    }
    questions_.at(node).answer();
    ranges_.on_clock_confirmed(node);
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::SyncReport& message, FrameOutcome&) {
    const auto taken = exchange_.on_report(node, message);
    add_exchange(node);
    return taken ? std::nullopt : Rejection(reason_of(taken.error()));
}

CanIntake::Rejection CanIntake::on(wire::NodeId, const wire::Sync& message, FrameOutcome&) {
    const auto taken = exchange_.on_sync(message, stamp_);
    return taken ? std::nullopt : Rejection(reason_of(taken.error()));
}

CanIntake::Rejection CanIntake::on(wire::NodeId, const wire::FollowUp& message, FrameOutcome&) {
    const auto stamp = exchange_.on_follow_up(message);
    if (!stamp) {
        return reason_of(stamp.error());
    }
    const std::uint64_t relocks_before = host_clock_.relocks();
    host_clock_.learn(*stamp);
    for (const auto& [node, clock] : clocks_) {
        if (host_clock_.relocks() > relocks_before) {
            ranges_.forget_order(node);  // readings since the clock step had wrong times
        }
        add_exchange(node);
    }
    return std::nullopt;
}

CanIntake::Rejection CanIntake::on(wire::NodeId, const wire::Mark& message, FrameOutcome& outcome) {
    outcome.mark = message;
    return std::nullopt;
}

CanIntake::Rejection CanIntake::on(wire::NodeId, const wire::Command&, FrameOutcome&) {
    return FrameReason::host_command;
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::Reflex& message, FrameOutcome&) {
    if (!ranges_.knows(node, message.sensor)) {
        return FrameReason::unknown_sensor;
    }
    ranges_.on_reflex(node, message);
    return std::nullopt;
}

/// Not used by the map: `octoskin black-box` reads it from the log.
CanIntake::Rejection CanIntake::on(wire::NodeId, const wire::BlackBox&, FrameOutcome&) {
    return FrameReason::diagnostic_frame;
}

/// Not used by the map: `octoskin calibrate` waits for it.
CanIntake::Rejection CanIntake::on(wire::NodeId, const wire::Calibration&, FrameOutcome&) {
    return FrameReason::diagnostic_frame;
}

CanIntake::Rejection CanIntake::on(wire::NodeId node, const wire::JointState& message,
                                   FrameOutcome& outcome) {
    const auto now_known = now();
    const auto source = std::ranges::find(joint_sources_, node, &JointIntake::node);
    if (source == joint_sources_.end()) {
        return FrameReason::not_joint_source;
    }
    if (is_refused_for_joints(nodes_.verdict(node, now_known))) {
        return FrameReason::node_refused;
    }
    if (!now_known) {
        return FrameReason::joint_no_host_time;
    }
    const JointAssembler::Outcome assembled = source->assembler.on_frame(message, *now_known);
    for (const JointReason reason : assembled.given_up) {
        outcome.joint_samples.push_back(unexpected(reason));
    }
    outcome.joint_samples_begun += assembled.opened ? 1U : 0U;
    if (assembled.is_contradiction) {
        const std::uint8_t sequence = std::visit([](const auto& part) { return part.sequence; }, message);
        source->senders.on_contradiction(sequence,
                                         assembled.is_of_one_round  ? JointSenderCheck::Rounds::one
                                         : assembled.is_of_no_round ? JointSenderCheck::Rounds::none
                                                                    : JointSenderCheck::Rounds::any,
                                         *now_known, outcome.joint_samples);
    }
    if (assembled.complete) {
        const auto index = static_cast<std::size_t>(source - joint_sources_.begin());
        const auto placed = place(index, *assembled.complete, *now_known);
        if (placed) {
            source->senders.on_sample(assembled.complete->sequence, *placed, *now_known,
                                      outcome.joint_samples);
        } else {
            outcome.joint_samples.push_back(placed);
        }
    }
    return assembled.is_repeated ? Rejection(FrameReason::joint_repeated) : std::nullopt;
}

Result<JointMeasurement, JointReason> CanIntake::place(std::size_t source, const JointReading& reading,
                                                       HostTime now) const {
    const JointIntake& of = joint_sources_[source];
    const auto sampled = clocks_.at(of.node).locate(reading.sampled, now);
    if (!sampled) {
        return unexpected(clock_reason<JointReason>(sampled.error()));
    }
    if (sampled->time - reading.begun > Nanoseconds{config_.clock.now_slack}) {
        return unexpected(JointReason::contradictory);
    }
    // Frames of the next round arrive one round after this sample was taken, plus or minus a period of
    // jitter.
    const bool may_be_mixed = !reading.is_in_order && now - sampled->time > of.assembler.round() * 7 / 8;
    if (may_be_mixed) return unexpected(JointReason::contradictory);
    if (now - sampled->time > config_.joint_age_max) {
        return unexpected(JointReason::too_old);
    }
    if (has_joint_beyond(reading, of.joint_count)) {
        return unexpected(JointReason::wrong_count);
    }
    if (!reading.has_pace) {  // checked last: a source's first samples precede its clock's first exchange
        return unexpected(JointReason::too_frequent);
    }
    return JointMeasurement{.sampled = sampled->time,
                            .position_rad = reading.position_rad,
                            .relocks = host_clock_.relocks(),
                            .source = static_cast<std::uint8_t>(source)};
}

}  // namespace octoskin
