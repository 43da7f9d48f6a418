#include "host/core/pipeline/pipeline.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace octoskin {
namespace {

/// Number of images that wait for the worker. With one more, the map would lag by the processing time of that
/// image. With one less, even a sufficiently fast worker would occasionally miss an image.
constexpr std::size_t kBesideWorkMax = 2;
constexpr HostTime kEndOfTime{std::numeric_limits<std::int64_t>::max()};

IntakeConfig intake_config(const PipelineConfig& config, const MappingConfig& mapping) {
    IntakeConfig intake = config.intake;
    intake.uses_no_return = mapping.no_return_clear_m > 0.0;
    return intake;
}

/// Samples of all sources wait in one buffer.
QueueLimits limits_of(const HostRig& rig, QueueLimits limits) {
    limits.joint_samples *= std::max(rig.joint_sources.size(), std::size_t{1});
    return limits;
}

std::vector<JointGate> gates_of(const HostRig& rig, std::span<const JointLimits> limits, double tolerance) {
    std::vector<JointGate> gates;
    std::size_t first = 0;
    for (const HostJointSource& source : rig.joint_sources) {
        gates.emplace_back(limits.subspan(first, source.joints.size()), tolerance);
        first += source.joints.size();
    }
    return gates;
}

std::vector<std::string> names_of(const std::vector<HostCamera>& cameras) {
    std::vector<std::string> names;
    for (const HostCamera& camera : cameras) names.push_back(camera.name);
    return names;
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
      waiting_(config.release, limits_of(rig, config.waiting_max), names_of(rig.cameras)),
      joint_gates_(gates_of(rig, builder.robot().robot().limits(), config.joints.limit_tolerance)),
      builder_(std::move(builder)),
      beside_(rig.cameras.size()) {
    inputs_.depth_frames.resize(std::max(rig.cameras.size(), std::size_t{1}));
    camera_names_ = names_of(rig.cameras);
    for (const HostCamera& camera : rig.cameras) {
        camera_patiences_.emplace_back(std::llround(3e9 / camera.rate_hz));
    }
}

void Pipeline::resume_from(Pipeline& ended) {
    assert(ended.is_finished_);
    begin_with(ended.take_map());
    time_jump_.resume_from(ended.time_jump_, ended.intake_.host_clock());
    waiting_.begin_at(ended.waiting_.begin());
}

void Pipeline::on_can(const wire::CanFrame& frame, WallTime stamp) {
    assert(!is_finished_);
    inputs_.now_at(stamp.ns);
    inputs_.frames.count_in();
    external_time_.reset();
    just_used_.clear();
    FrameOutcome outcome = intake_.on_frame(frame, stamp);
    queue(outcome.joint_samples_of_before);
    if (const auto now_known = now()) {
        if (const auto jump = time_jump_.notice(*now_known, intake_.host_clock())) on_jump(*jump);
    }
    const auto fate = outcome.mark ? marks_.take(*outcome.mark, now()) : MarkGate::Fate::taken;
    if (fate == MarkGate::Fate::ignored) {
        outcome.rejected = FrameReason::mark_ignored;
    }
    if (fate != MarkGate::Fate::waits) {
        outcome.rejected ? inputs_.frames.reject(*outcome.rejected) : inputs_.frames.use();
    }
    queue(outcome);
    if (const auto now_known = now()) {
        has_can_time_ = true;
        settle_marks(*now_known);
        advance(*now_known);
    }
}

/// Clears everything remembered from before the time jump; the maps stay, and do not age.
void Pipeline::on_jump(const TimeJump::Jump& jump) {
    settle_waiting();
    builder_.clear_motion(jump.by);
    for (JointGate& gate : joint_gates_) gate.forget();
    waiting_.forget_time(jump.begin);
    just_used_.clear();  // from before the jump: their age is unknown
}

void Pipeline::jump_over_sleep() {
    on_jump({Nanoseconds{0}, now()});
    builder_.begin_to_wait();
}

void Pipeline::settle_waiting() {
    queue(intake_.settle_joints());
    for (const RangeMeasurement& measurement : intake_.take_held()) {
        queue(measurement);
    }
    queue(intake_.settle_joints());
    release_joints(kEndOfTime);
    for (std::size_t camera = 0; camera < beside_.size(); ++camera) {
        if (beside_[camera].is_at_work()) finish_depth(camera);
        // A live map does not wait for queued images.
        while (beside_[camera].has_worker() && waiting_.depth_frames(camera) > 0) drop_oldest_depth(camera);
    }
    release_measurements(kEndOfTime);
}

void Pipeline::drop_oldest_depth(std::size_t camera) {
    (void)waiting_.take_depth(camera);
    counters_of(camera).reject(DepthReason::queue_overflow);
}

void Pipeline::work_beside(const std::vector<DepthWorker*>& workers) {
    assert(workers.empty() || config_.release == Release::once_placed);
    for (std::size_t camera = 0; camera < beside_.size(); ++camera)
        beside_[camera].lend(workers.empty() ? nullptr : workers.at(camera));
}

void Pipeline::on_worker_done() {
    bool is_any_done = false;
    for (std::size_t camera = 0; camera < beside_.size(); ++camera) {
        if (!beside_[camera].is_at_work() || !beside_[camera].is_done()) continue;
        finish_depth(camera);
        is_any_done = true;
    }
    if (is_any_done) release_measurements(released_until_);
}

void Pipeline::finish_depth(std::size_t camera) {
    counters_of(camera).settle(beside_[camera].finish(builder_));
}

CameraSet Pipeline::idle_cameras() const {
    CameraSet idle;
    for (std::size_t camera = 0; camera < beside_.size(); ++camera)
        idle.set(camera, !beside_[camera].is_at_work());
    return idle;
}

InputCounters<DepthReason>& Pipeline::counters_of(std::size_t camera) {
    return inputs_.depth_frames[camera < inputs_.depth_frames.size() ? camera : 0];
}

void Pipeline::settle_marks(HostTime now) {
    for (const MarkGate::Settled& settled : marks_.settle(now)) {
        settled.is_taken ? inputs_.frames.use() : inputs_.frames.reject(FrameReason::mark_ignored);
    }
}

void Pipeline::queue(const FrameOutcome& outcome) {
    inputs_.joint_samples.count_in(outcome.joint_samples_begun);
    queue(outcome.joint_samples);
    inputs_.readings.count_in(outcome.readings.size() + outcome.readings_held);
    for (const ReadingReason reason : outcome.readings_given_up) {
        inputs_.readings.reject(reason);
    }
    for (const auto& reading : outcome.readings) {
        reading ? queue(*reading) : inputs_.readings.reject(reading.error());
    }
}

void Pipeline::queue(const RangeMeasurement& measurement) {
    const auto rejected = waiting_.put(measurement);
    if (!rejected) return;
    inputs_.readings.reject(*rejected);
    intake_.on_lost(measurement.source.node_id, *rejected);
}

void Pipeline::queue(const JointSenderCheck::Ended& joint_samples) {
    for (const auto& joints : joint_samples) {
        joints ? queue(*joints) : inputs_.joint_samples.reject(joints.error());
    }
}

void Pipeline::queue(const JointMeasurement& joints) {
    if (const auto rejected = waiting_.put(joints)) inputs_.joint_samples.reject(*rejected);
}

void Pipeline::on_depth(DepthFrame frame) {
    assert(!is_finished_);
    if (!has_can_time_) inputs_.now_at(frame.captured.ns);
    const std::size_t camera = frame.camera;
    InputCounters<DepthReason>& counters = counters_of(camera);
    counters.count_in();
    just_used_.clear();
    const auto known = external_time_ ? external_time_ : now();
    const auto refused = camera < builder_.cameras() ? waiting_.check_arrival(frame, known)
                                                     : std::optional(DepthReason::no_camera);
    if (refused) {
        counters.reject(*refused);
        return;
    }
    // A rig without a bus, or with a silent one, has no clock but its cameras. Integrating what is due first
    // makes room for the frame.
    const std::optional<HostTime> now_known = has_can_time_ ? now() : frame.captured;
    if (now_known) advance(*now_known);
    if (const auto full = waiting_.put(std::move(frame))) counters.reject(*full);
    if (now_known && config_.release == Release::once_placed) advance(*now_known);
    while (beside_[camera].is_at_work() && waiting_.depth_frames(camera) > kBesideWorkMax &&
           is_placed(*waiting_.oldest_depth(camera))) {
        drop_oldest_depth(camera);
    }
}

void Pipeline::advance(HostTime now) {
    for (const RangeMeasurement& measurement : intake_.take_due(now)) {
        queue(measurement);
    }
    // The samples around an instant may be as far apart as the joint history allows.
    const bool is_live = config_.release == Release::once_placed;
    release_joints(is_live ? kEndOfTime : now - (config_.lag - config_.joints.bracket_max));
    release_measurements(now - config_.lag);
}

bool Pipeline::is_placed(const MeasurementQueue::Next& next) const {
    if (config_.release == Release::by_capture_time) return false;
    const bool needs_robot = !next.camera || builder_.depth_needs_robot(*next.camera);
    return !needs_robot || builder_.is_settled(next.key.captured);
}

void Pipeline::release_joints(HostTime until) {
    while (const auto joints = waiting_.take_joints(until)) {
        const auto checked = joint_gates_.at(joints->source).check(*joints);
        inputs_.joint_samples.settle(checked ? builder_.add(*joints) : checked);
    }
}

void Pipeline::release_measurements(HostTime until) {
    released_until_ = until;
    while (true) {  // each iteration removes one from a bounded buffer
        const auto next = waiting_.next(idle_cameras());
        if (!next || (next->key.captured > until && !is_placed(*next))) return;
        const bool is_used = next->camera ? take_depth(waiting_.take_depth(*next->camera))
                                          : inputs_.readings.settle(integrate(waiting_.take_reading()));
        if (is_used) waiting_.on_used(next->key);
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
        waiting_.on_used_reading(measurement.source, measurement.captured);
        just_used_.push_back(measurement.captured);
    }
    return integrated;
}

bool Pipeline::take_depth(DepthFrame frame) {
    InputCounters<DepthReason>& counters = counters_of(frame.camera);
    DepthBeside& beside = beside_[frame.camera];
    if (!marks_.contains(frame.captured)) {
        counters.reject(DepthReason::outside_marks);
        return false;
    }
    if (!beside.has_worker()) return counters.settle(builder_.integrate(std::move(frame)));
    const auto begun = beside.begin(builder_, std::move(frame));
    if (!begun) counters.reject(begun.error());
    return false;
}

void Pipeline::on_silence(HostTime now) {
    has_can_time_ = false;
    external_time_ = now;
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
        inputs_.frames.reject(FrameReason::mark_ignored);
    }
    settle_waiting();
    for (std::uint64_t i = intake_.joint_samples_pending(); i > 0 && !is_finished_; --i) {
        inputs_.joint_samples.reject(JointReason::incomplete);
    }
    is_finished_ = true;
}

bool Pipeline::is_camera_stale(std::size_t camera) const {
    const auto now_known = now();
    if (!now_known) return false;
    const auto newest = waiting_.newest_depth(camera);
    return !newest || *now_known - *newest > camera_patiences_.at(camera);
}

std::uint64_t Pipeline::depth_frames_pending(std::size_t camera) const {
    if (camera >= beside_.size()) return 0;
    return waiting_.depth_frames(camera) + (beside_[camera].is_at_work() ? 1U : 0U);
}

std::vector<CounterTable> Pipeline::counter_tables() const {
    const std::uint64_t samples_open = is_finished_ ? 0 : intake_.joint_samples_pending();
    std::vector<CounterTable> tables{
        tabulate("CAN frames", inputs_.frames, marks_.waiting(), seconds_text),
        tabulate("readings", inputs_.readings, waiting_.readings() + intake_.readings_held(), seconds_text),
        tabulate("joint samples", inputs_.joint_samples, waiting_.joint_samples() + samples_open,
                 seconds_text)};
    for (std::size_t camera = 0; camera < inputs_.depth_frames.size(); ++camera) {
        tables.push_back(tabulate("depth frames", inputs_.depth_frames[camera], depth_frames_pending(camera),
                                  seconds_text));
        if (camera < camera_names_.size()) tables.back().of = camera_names_[camera];
    }
    return tables;
}

bool Pipeline::is_balanced() const {
    return std::ranges::all_of(counter_tables(), &CounterTable::is_balanced);
}

std::string Pipeline::inputs_text() const {
    std::string text;
    for (const CounterTable& table : counter_tables()) text += to_text(table);
    return text;
}

}  // namespace octoskin
