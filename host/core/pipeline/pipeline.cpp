#include "host/core/pipeline/pipeline.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

namespace octoskin {
namespace {

/// A depth frame this far in the future has a wrong epoch.
constexpr Nanoseconds kDepthAheadMax{1'000'000'000};
/// Far less than any timing budget: two readings of one source this close are one and the same, placed by two
/// states of the clock map.
constexpr Nanoseconds kSameReading{5'000'000};
/// Images that wait for the worker. With one more the map would be older by the time that one takes; with one
/// less a worker that is quick enough would miss one now and then.
constexpr std::size_t kBesideWorkMax = 2;
constexpr HostTime kEndOfTime{std::numeric_limits<std::int64_t>::max()};
/// The camera's place in the order of sources: node 0 is the host.
constexpr BeamSource kCameraSource{};

IntakeConfig intake_config(const PipelineConfig& config, const MappingConfig& mapping) {
    IntakeConfig intake = config.intake;
    intake.uses_no_return = mapping.no_return_clear_m > 0.0;
    return intake;
}

}  // namespace

Result<Pipeline, RobotModelFault> Pipeline::build(const HostRig& rig, RobotModel robot,
                                                  const MappingConfig& mapping,
                                                  const PipelineConfig& config) {
    assert(config.lag > config.joints.bracket_max);
    auto builder =
        MapBuilder::build(rig, std::move(robot), mapping, config.joints, config.maps, config.depth_threads);
    if (!builder) {
        return unexpected(builder.error());
    }
    return Pipeline(rig, std::move(builder).value(), mapping, config);
}

Pipeline::Pipeline(const HostRig& rig, MapBuilder builder, const MappingConfig& mapping,
                   const PipelineConfig& config)
    : config_(config),
      intake_(rig, intake_config(config, mapping)),
      marks_(config.begin),
      joints_waiting_(config.joint_samples_waiting_max),
      readings_waiting_(config.readings_waiting_max),
      depth_waiting_(config.depth_frames_waiting_max),
      builder_(std::move(builder)),
      joint_jump_(builder_.joint_limits()) {
    if (rig.camera) {
        camera_patience_ = Nanoseconds{std::llround(3e9 / rig.camera->rate_hz)};
    }
}

void Pipeline::go_on_from(Pipeline& ended) {
    assert(ended.is_finished_);
    begin_with(ended.take_map());
    time_leap_.go_on_from(ended.time_leap_, ended.intake_.host_clock());
    time_begin_ = ended.time_begin_;
}

void Pipeline::on_can(const wire::CanFrame& frame, WallTime stamp) {
    assert(!is_finished_);
    accounts_.now_at(stamp.ns);
    accounts_.frames.take_in();
    told_beside_.reset();
    just_used_.clear();
    FrameOutcome outcome = intake_.on_frame(frame, stamp);
    queue(outcome.joint_samples_of_before);
    if (const auto now_known = now()) {
        if (const auto leap = time_leap_.notice(*now_known, intake_.host_clock())) {
            go_on_after(leap->by);
            time_begin_ = leap->begin;
        }
    }
    const auto fate = outcome.mark ? marks_.take(*outcome.mark, now()) : MarkGate::Fate::taken;
    if (fate == MarkGate::Fate::ignored) {
        outcome.rejected = FrameReason::mark_ignored;
    }
    if (fate != MarkGate::Fate::waits) {
        outcome.rejected ? accounts_.frames.reject(*outcome.rejected) : accounts_.frames.use();
    }
    queue(outcome);
    if (const auto now_known = now()) {
        has_can_time_ = true;
        settle_marks(*now_known);
        advance(*now_known);
    }
}

/// All that is remembered of the time before ends here; the maps stay, and are no older.
void Pipeline::go_on_after(Nanoseconds leapt) {
    settle_waiting();
    builder_.forget_motion(leapt);
    joint_jump_.forget();
    integrated_.reset();
    used_.clear();
    just_used_.clear();  // of the time before: their age is not known
    depth_newest_.reset();
}

void Pipeline::settle_waiting() {
    queue(intake_.settle_joints());
    for (const RangeMeasurement& measurement : intake_.take_held()) {
        queue(measurement);
    }
    queue(intake_.settle_joints());
    release_joints(kEndOfTime);
    if (in_work_) {
        finish_depth();
    }
    // A live map does not stand still for images that it had no time for.
    while (worker_ != nullptr && depth_waiting_.size() > 0) {
        drop_oldest_depth();
    }
    release_measurements(kEndOfTime);
}

void Pipeline::drop_oldest_depth() {
    (void)depth_waiting_.pop();
    accounts_.depth_frames.reject(DepthReason::queue_overflow);
}

void Pipeline::work_beside(DepthWorker* worker) {
    assert(worker == nullptr || config_.release == Release::once_placed);
    assert(!in_work_);
    worker_ = worker;
}

void Pipeline::on_worker_done() {
    if (!in_work_ || !worker_->is_done()) {
        return;
    }
    finish_depth();
    release_measurements(released_until_);
}

void Pipeline::finish_depth() {
    const auto done = std::exchange(in_work_, nullptr);
    worker_->finish();
    accounts_.depth_frames.settle(builder_.finish(*done));
}

void Pipeline::settle_marks(HostTime now) {
    for (const MarkGate::Settled& settled : marks_.settle(now)) {
        settled.is_taken ? accounts_.frames.use() : accounts_.frames.reject(FrameReason::mark_ignored);
    }
}

void Pipeline::queue(const FrameOutcome& outcome) {
    accounts_.joint_samples.take_in(outcome.joint_samples_begun);
    queue(outcome.joint_samples);
    accounts_.readings.take_in(outcome.readings.size() + outcome.readings_held);
    for (const ReadingReason reason : outcome.readings_given_up) {
        accounts_.readings.reject(reason);
    }
    for (const auto& reading : outcome.readings) {
        reading ? queue(*reading) : accounts_.readings.reject(reading.error());
    }
}

void Pipeline::queue(const RangeMeasurement& measurement) {
    const ReleaseKey key{measurement.captured, measurement.source};
    std::optional<ReadingReason> rejected;
    if (is_late(key)) {
        rejected = ReadingReason::late;
    } else if (is_repeated(key)) {
        rejected = ReadingReason::duplicate;
    } else if (readings_waiting_.push(key, measurement) != ReorderBuffer<RangeMeasurement>::Pushed::waits) {
        rejected = ReadingReason::queue_overflow;
    }
    if (!rejected) return;
    accounts_.readings.reject(*rejected);
    intake_.on_lost(measurement.source.node_id, *rejected);
}

bool Pipeline::is_repeated(const ReleaseKey& key) const {
    const auto used = used_.find(key.source);
    return (used != used_.end() && key.captured - used->second < kSameReading) ||
           readings_waiting_.has_near(key, kSameReading);
}

void Pipeline::queue(const JointSenderCheck::Ended& joint_samples) {
    for (const auto& joints : joint_samples) {
        joints ? queue(*joints) : accounts_.joint_samples.reject(joints.error());
    }
}

void Pipeline::queue(const JointMeasurement& joints) {
    using Pushed = ReorderBuffer<JointMeasurement>::Pushed;
    const Pushed pushed = joints_waiting_.push({joints.sampled, kCameraSource}, joints);
    if (pushed != Pushed::waits) {
        accounts_.joint_samples.reject(pushed == Pushed::refused ? JointReason::out_of_order
                                                                 : JointReason::queue_overflow);
    }
}

std::optional<DepthReason> Pipeline::fault_on_arrival(const DepthFrame& frame) const {
    if (!builder_.has_camera()) return DepthReason::no_camera;
    if (depth_newest_ && frame.captured <= *depth_newest_) return DepthReason::out_of_order;
    const auto now_known = told_beside_ ? told_beside_ : now();
    if (now_known && frame.captured - *now_known > kDepthAheadMax) return DepthReason::ahead_of_time;
    if (is_late({frame.captured, kCameraSource})) return DepthReason::late;
    return std::nullopt;
}

void Pipeline::on_depth(DepthFrame frame) {
    assert(!is_finished_);
    if (!has_can_time_) accounts_.now_at(frame.captured.ns);
    accounts_.depth_frames.take_in();
    just_used_.clear();
    if (const auto reason = fault_on_arrival(frame)) {
        accounts_.depth_frames.reject(*reason);
        return;
    }
    const HostTime captured = frame.captured;
    depth_newest_ = captured;
    // A rig without a bus, or with a silent one, has no other clock than its camera. What is due makes room.
    const std::optional<HostTime> now_known = has_can_time_ ? now() : captured;
    if (now_known) {
        advance(*now_known);
    }
    using Pushed = ReorderBuffer<DepthFrame>::Pushed;
    if (depth_waiting_.is_full() ||
        depth_waiting_.push({captured, kCameraSource}, std::move(frame)) != Pushed::waits) {
        accounts_.depth_frames.reject(DepthReason::queue_overflow);
    }
    if (now_known && config_.release == Release::once_placed) {
        advance(*now_known);
    }
    while (in_work_ && depth_waiting_.size() > kBesideWorkMax && is_placed(*depth_waiting_.front())) {
        drop_oldest_depth();
    }
}

void Pipeline::advance(HostTime now) {
    for (const RangeMeasurement& measurement : intake_.take_due(now)) {
        queue(measurement);
    }
    // The samples that surround an instant may be as far apart as the history allows.
    const bool is_live = config_.release == Release::once_placed;
    release_joints(is_live ? kEndOfTime : now - (config_.lag - config_.joints.bracket_max));
    release_measurements(now - config_.lag);
}

bool Pipeline::is_placed(const ReleaseKey& key) const {
    if (config_.release == Release::by_capture_time) {
        return false;
    }
    const bool needs_robot = key.source != kCameraSource || builder_.depth_needs_robot();
    return !needs_robot || builder_.is_settled(key.captured);
}

void Pipeline::release_joints(HostTime until) {
    while (joints_waiting_.size() > 0 && joints_waiting_.front()->captured <= until) {
        accounts_.joint_samples.settle(add(joints_waiting_.pop()));
    }
}

/// What is beyond the limits is nowhere that the arm could have moved to or from.
Status<JointReason> Pipeline::add(const JointMeasurement& joints) {
    const std::span<const JointLimits> limits = builder_.joint_limits();
    const auto position = std::span(joints.position_rad).first(limits.size());
    for (std::size_t i = 0; i < limits.size(); ++i) {
        if (limits[i].hold(position[i], config_.joints.limit_tolerance)) continue;
        joint_beyond_ = {i, position[i], limits[i], joints.sampled};
        return unexpected(JointReason::out_of_limits);
    }
    const JointJump::Verdict verdict = joint_jump_.judge(joints.sampled, position, joints.relocks);
    if (verdict == JointJump::Verdict::jumped) return unexpected(JointReason::joint_jump);
    if (verdict == JointJump::Verdict::withheld) return unexpected(JointReason::second_sender);
    return builder_.add(joints);
}

void Pipeline::release_measurements(HostTime until) {
    released_until_ = until;
    while (true) {  // each round takes one out of a bounded buffer
        const auto reading = readings_waiting_.front();
        const auto depth = in_work_ ? std::nullopt : depth_waiting_.front();
        const bool is_depth_next = depth && (!reading || *depth < *reading);
        const auto next = is_depth_next ? depth : reading;
        if (!next || (next->captured > until && !is_placed(*next))) {
            return;
        }
        const bool is_used = is_depth_next ? take_depth(depth_waiting_.pop())
                                           : accounts_.readings.settle(integrate(readings_waiting_.pop()));
        integrated_ = is_used ? next : integrated_;
    }
}

Status<ReadingReason> Pipeline::integrate(const RangeMeasurement& measurement) {
    if (!marks_.contains(measurement.captured)) {
        intake_.on_lost(measurement.source.node_id, ReadingReason::outside_marks);
        return unexpected(ReadingReason::outside_marks);
    }
    const auto integrated = builder_.integrate(measurement);
    intake_.on_fate_in_map(measurement.source, integrated ? std::nullopt : std::optional(integrated.error()));
    if (integrated) {
        used_[measurement.source] = measurement.captured;
        just_used_.push_back(measurement.captured);
    }
    return integrated;
}

bool Pipeline::take_depth(DepthFrame frame) {
    if (!marks_.contains(frame.captured)) {
        accounts_.depth_frames.reject(DepthReason::outside_marks);
        return false;
    }
    if (worker_ == nullptr) {
        return accounts_.depth_frames.settle(builder_.integrate(std::move(frame)));
    }
    const Status<DepthReason> begun = begin_depth(std::move(frame));
    if (!begun) {
        accounts_.depth_frames.reject(begun.error());
    }
    return false;
}

Status<DepthReason> Pipeline::begin_depth(DepthFrame frame) {
    try {
        auto begun = builder_.begin(std::move(frame));
        if (!begun) {
            return unexpected(begun.error());
        }
        in_work_ = std::make_unique<MapBuilder::DepthWork>(std::move(begun).value());
        worker_->begin([this, depth = in_work_.get()] { builder_.work(*depth); });
        return Done{};
    } catch (const std::bad_alloc&) {
        in_work_ = nullptr;
        return unexpected(DepthReason::no_memory);
    }
}

void Pipeline::on_silence(HostTime now) {
    has_can_time_ = false;
    told_beside_ = now;
    just_used_.clear();
    queue(intake_.joints_due(now));
    advance(now);
}

void Pipeline::finish_can() {
    queue(intake_.settle_joints());
    release_joints(kEndOfTime);
    has_can_time_ = false;
}

void Pipeline::finish() {
    for (std::size_t i = marks_.give_up(); i > 0; --i) {
        accounts_.frames.reject(FrameReason::mark_ignored);
    }
    settle_waiting();
    for (std::uint64_t i = intake_.joint_samples_pending(); i > 0 && !is_finished_; --i) {
        accounts_.joint_samples.reject(JointReason::incomplete);
    }
    is_finished_ = true;
}

bool Pipeline::is_camera_stale() const {
    const auto now_known = now();
    if (!camera_patience_ || !now_known) {
        return false;
    }
    return !depth_newest_ || *now_known - *depth_newest_ > *camera_patience_;
}

std::vector<AccountTable> Pipeline::account_tables() const {
    const std::uint64_t samples_open = is_finished_ ? 0 : intake_.joint_samples_pending();
    return {tabulate("CAN frames", accounts_.frames, marks_.waiting(), seconds_text),
            tabulate("readings", accounts_.readings, readings_waiting_.size() + intake_.readings_held(),
                     seconds_text),
            tabulate("joint samples", accounts_.joint_samples, joints_waiting_.size() + samples_open,
                     seconds_text),
            tabulate("depth frames", accounts_.depth_frames, depth_waiting_.size() + (in_work_ ? 1U : 0U),
                     seconds_text)};
}

bool Pipeline::is_balanced() const {
    return std::ranges::all_of(account_tables(), &AccountTable::is_balanced);
}

std::string Pipeline::account_text() const {
    std::string text;
    for (const AccountTable& table : account_tables()) text += to_text(table);
    return text;
}

}  // namespace octoskin
