// The host's path from frames to maps. The same object serves a replay and the daemon: it opens nothing,
// reads no clock, and its maps depend on what was measured, not on when it arrived.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "host/core/counters/input_counters.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/pipeline/depth_beside.hpp"
#include "host/core/pipeline/depth_stage.hpp"
#include "host/core/pipeline/fed_map.hpp"
#include "host/core/pipeline/joint_gate.hpp"
#include "host/core/pipeline/map_builder.hpp"
#include "host/core/pipeline/mark_gate.hpp"
#include "host/core/pipeline/mark_window.hpp"
#include "host/core/pipeline/measurement_queue.hpp"
#include "host/core/pipeline/time_jump.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

struct PipelineConfig {
    std::vector<MapFeed> maps = every_feed();
    MapBegin begin = MapBegin::first_usable;
    Release release = Release::by_capture_time;
    /// Maximum time that a measurement waits after its capture. Longer than the longest gap over which joints
    /// are interpolated, and than the age limit of a range.
    Nanoseconds lag{250'000'000};
    JointHistoryConfig joints;
    IntakeConfig intake;  ///< `uses_no_return` follows from the mapping
    QueueLimits waiting_max;
    unsigned depth_threads = 1;  ///< threads that work on an image; the map does not depend on it
};

/// The result of every input, for each kind of input in `reasons.hpp`.
struct PipelineInputs {
    InputCounters<FrameReason> frames;
    InputCounters<ReadingReason> readings;
    InputCounters<JointReason> joint_samples;
    /// Of each camera; one without a camera, whose frames are refused.
    std::vector<InputCounters<DepthReason>> depth_frames{1};
    /// Sets the time with which later rejections are recorded, in nanoseconds: a frame's time stamp or,
    /// without a bus, the capture time of an image.
    void now_at(std::int64_t ns) noexcept {
        frames.now_at(ns);
        readings.now_at(ns);
        joint_samples.now_at(ns);
        for (InputCounters<DepthReason>& camera : depth_frames) camera.now_at(ns);
    }
};

class Pipeline {
  public:
    /// Refuses, by name, a link of the rig that the robot does not have. `robot` must move the joints of
    /// `rig.joint_names()` in that order (asserted: equal count).
    [[nodiscard]] static Result<Pipeline, RobotModelFault> build(const HostRig& rig, RobotModel robot,
                                                                 const MappingConfig& mapping,
                                                                 const PipelineConfig& config = {});

    /// The fused map continues from `fused`, which must have the mapping's resolution (asserted).
    void begin_with(FusedMap fused) { builder_.begin_with(std::move(fused)); }
    /// The same with the memory of sensors and camera: MapBuilder::begin_with.
    [[nodiscard]] MapBuilder::LeftOut begin_with(MapState state) {
        return builder_.begin_with(std::move(state));
    }
    /// Makes all of the fused map stale until it is seen again: FusedMap::clear_times.
    void clear_times() noexcept { builder_.clear_times(); }
    /// For a saved map that still waits for its first measurement: FusedMap::wait.
    void wait(std::int64_t seconds) { builder_.wait(seconds); }
    /// Call after the machine slept, because the clocks of later inputs stood still or are different clocks.
    /// As at a time jump, waiting inputs are resolved, the state from before is cleared, a listener is
    /// notified that its order ends, and late inputs captured before are not used. The fused map waits like a
    /// saved one; report with `wait` how much time has passed.
    void jump_over_sleep();
    /// Applies other limits to the fused map, at the same resolution (asserted): FusedMap::limit. Throws
    /// std::bad_alloc; nothing is changed then.
    void limit_map(const MapConfig& config) { builder_.limit_map(config); }
    /// After `finish`: moves the fused map out.
    [[nodiscard]] FusedMap take_map() { return builder_.take_map(); }
    /// Continues the fused map of another pipeline, which has ended (`finish`) and has the same resolution
    /// (asserted), and its time: time that passes meanwhile ages the map, except across a time jump.
    void resume_from(Pipeline& ended);
    /// `listener` is notified of each later input of the maps; null: none.
    void set_listener(CommitListener* listener) noexcept { builder_.set_listener(listener); }

    /// `observer` sees each later measurement of the maps; null: none.
    void observe(MeasurementObserver* observer) noexcept { builder_.observe(observer); }

    /// Takes frames in order of arrival. `stamp`: time of reception; it does not place measurements.
    void on_can(const wire::CanFrame& frame, WallTime stamp);
    /// Takes the depth frames of a camera in the order of capture, at about the time of their arrival among
    /// the CAN frames.
    void on_depth(DepthFrame frame);
    /// From now on, each camera's frames are converted to terms by its worker, and later measurements may go
    /// into the maps before a frame; a listener gets the order. While a worker has a frame, two more of its
    /// camera wait. A further one displaces the oldest of them (`queue_overflow`). If waiting inputs must be
    /// resolved at once, waiting frames are dropped, too. `workers`: one for each camera or more, in its
    /// order (asserted); empty: the call that releases a frame converts it, and everything waits for it.
    /// Requires `Release::once_placed` (asserted). The pipeline must not be moved while a worker has a frame.
    /// The workers must live until they are replaced.
    void work_beside(const std::vector<DepthWorker*>& workers);
    /// Workers may have finished frames: these go into the maps, and the next ones begin.
    void on_worker_done();
    /// No CAN frame arrives at present, and the host time is `now`, known from a source other than the bus.
    /// Integrates what need not wait longer. Until the next CAN frame, time advances with the captures of
    /// depth frames, and a frame captured well after `now` is rejected.
    void on_silence(HostTime now);
    /// No further CAN frame will come: from now on, time advances with the captures of depth frames.
    void finish_can();
    /// Nothing more will come: waiting inputs are integrated or counted. No input may be added afterwards.
    void finish();

    [[nodiscard]] std::span<const FedMap> maps() const noexcept { return builder_.maps(); }
    /// The map with this feed, which must exist (asserted).
    [[nodiscard]] const FusedMap& map(MapFeed feed = MapFeed::both) const noexcept {
        return builder_.map(feed);
    }
    [[nodiscard]] const PipelineInputs& inputs() const noexcept { return inputs_; }
    /// True if in = used + rejected + waiting, for each kind of input.
    [[nodiscard]] bool is_balanced() const;
    /// One table for each kind of input.
    [[nodiscard]] std::vector<CounterTable> counter_tables() const;
    /// The tables as text.
    [[nodiscard]] std::string inputs_text() const;

    /// The host time; empty while unknown.
    [[nodiscard]] std::optional<HostTime> now() const { return intake_.now(); }
    /// Number of time jumps back by over 0.15 s: the host that sends SYNC restarted, or another host sends
    /// it. Waiting inputs were resolved, and the state from before was cleared; the maps stay.
    [[nodiscard]] std::uint64_t times_back() const noexcept { return time_jump_.times_back(); }
    /// Number of time jumps ahead by over a second more than the time that passed: another host sends SYNC,
    /// or its clock was set. Handled in the same way; the maps do not age.
    [[nodiscard]] std::uint64_t times_ahead() const noexcept { return time_jump_.times_ahead(); }
    /// Capture times of the readings that the last `on_can`, `on_depth` or `on_silence` put into the maps.
    [[nodiscard]] std::span<const HostTime> just_used() const noexcept { return just_used_; }
    /// True if the host time is known and three periods of the camera have passed without a frame of it.
    [[nodiscard]] bool is_camera_stale(std::size_t camera) const;
    [[nodiscard]] const CanIntake& intake() const noexcept { return intake_; }
    /// The check of a source's samples that rejects positions that the arm cannot have.
    [[nodiscard]] const JointGate& joint_gate(std::size_t source) const { return joint_gates_.at(source); }
    /// Converts measurements to maps. A recording that begins now also needs the joint samples stored there.
    [[nodiscard]] const MapBuilder& builder() const noexcept { return builder_; }
    /// For a replay in a daemon's order, which bypasses the pipeline's own inputs.
    [[nodiscard]] MapBuilder& builder() noexcept { return builder_; }

  private:
    Pipeline(const HostRig& rig, MapBuilder builder, const MappingConfig& mapping,
             const PipelineConfig& config);

    void settle_marks(HostTime now);
    void on_jump(const TimeJump::Jump& jump);  ///< also for a sleep, as a jump by 0
    /// Integrates or counts all waiting inputs, by what is known.
    void settle_waiting();
    void queue(const FrameOutcome& outcome);
    void queue(const RangeMeasurement& measurement);
    void queue(const JointMeasurement& joints);
    void queue(const JointSenderCheck::Ended& joint_samples);

    /// Integrates what need not wait any longer.
    void advance(HostTime now);
    void release_joints(HostTime until);
    /// Releases measurements captured at or before `until` and, with `Release::once_placed`, all placed ones.
    void release_measurements(HostTime until);
    [[nodiscard]] bool is_placed(const MeasurementQueue::Next& next) const;
    /// The cameras whose worker has no frame.
    [[nodiscard]] CameraSet idle_cameras() const;
    [[nodiscard]] InputCounters<DepthReason>& counters_of(std::size_t camera);
    [[nodiscard]] std::uint64_t depth_frames_pending(std::size_t camera) const;
    [[nodiscard]] Status<ReadingReason> integrate(const RangeMeasurement& measurement);
    /// Puts the frame into the maps, or gives it to the worker. True if it is in the maps.
    bool take_depth(DepthFrame frame);
    void finish_depth(std::size_t camera);
    void drop_oldest_depth(std::size_t camera);

    PipelineConfig config_;
    // From frames to measurements in host time.
    CanIntake intake_;
    MarkGate marks_;
    TimeJump time_jump_;
    bool has_can_time_ = false;              ///< the bus gives the time, and may continue to
    std::optional<HostTime> external_time_;  ///< time of `on_silence`, since the newest CAN frame
    // Order of the measurements.
    MeasurementQueue waiting_;
    HostTime released_until_;
    // Placement, and the maps' voxels.
    std::vector<JointGate> joint_gates_;  ///< one for each source of joint states
    MapBuilder builder_;
    std::vector<DepthBeside> beside_;  ///< one for each camera

    PipelineInputs inputs_;
    std::vector<HostTime> just_used_;  ///< by the current call, or the last one
    std::vector<std::string> camera_names_;
    std::vector<Nanoseconds> camera_patiences_;  ///< three frame periods each
    bool is_finished_ = false;
};

}  // namespace octoskin
