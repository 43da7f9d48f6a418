// The host's way from frames to maps, one way, left to right. The same object serves a replay and the daemon:
// it opens nothing, asks for no time, and the maps it builds depend on what was measured, not on when it
// arrived.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "host/core/account/account.hpp"
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
#include "host/core/pipeline/time_leap.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

struct PipelineConfig {
    std::vector<MapFeed> maps = every_feed();
    MapBegin begin = MapBegin::first_usable;
    Release release = Release::by_capture_time;
    /// A measurement waits so long at most after it was captured. More than the longest gap that joints are
    /// interpolated over, and than the age limit of a range.
    Nanoseconds lag{250'000'000};
    JointHistoryConfig joints;
    IntakeConfig intake;  ///< `uses_no_return` follows from the mapping
    QueueLimits waiting_max;
    unsigned depth_threads = 1;  ///< how many work on a depth image; the map is the same
};

/// The fate of every input, by the units of `reasons.hpp`.
struct PipelineAccounts {
    Account<FrameReason> frames;
    Account<ReadingReason> readings;
    Account<JointReason> joint_samples;
    Account<DepthReason> depth_frames;
    /// Nanoseconds: of the stamp or, without a bus, the capture that what is rejected from now on came with.
    void now_at(std::int64_t ns) noexcept {
        frames.now_at(ns);
        readings.now_at(ns);
        joint_samples.now_at(ns);
        depth_frames.now_at(ns);
    }
};

class Pipeline {
  public:
    /// Refuses, by name, a link of the rig that the robot does not have. `robot` moves the joints of
    /// `rig.joints.joints`, in that order (asserted: as many).
    [[nodiscard]] static Result<Pipeline, RobotModelFault> build(const HostRig& rig, RobotModel robot,
                                                                 const MappingConfig& mapping,
                                                                 const PipelineConfig& config = {});

    /// The fused map goes on from this one, which has the mapping's resolution (asserted).
    void begin_with(FusedMap fused) { builder_.begin_with(std::move(fused)); }
    /// The same with what the range sensors read before: MapBuilder::begin_with.
    [[nodiscard]] std::size_t begin_with(MapState state) { return builder_.begin_with(std::move(state)); }
    /// All of the fused map is stale until it is seen again: FusedMap::forget_times.
    void forget_times() noexcept { builder_.forget_times(); }
    /// Of a map that was saved, until its first measurement: FusedMap::wait.
    void wait(std::int64_t seconds) { builder_.wait(seconds); }
    /// The machine slept, and the clocks of what comes stood still, or are those of others: as where the time
    /// leaps, what waits is settled, what was remembered of the time before is forgotten, a listener learns
    /// that its order ends, and what was captured before and comes late is not used. The fused map waits as
    /// one that was saved: `wait` says what has passed.
    void go_on_after_sleep();
    /// Other limits for the fused map from now on, at the same resolution (asserted): FusedMap::limit. Throws
    /// std::bad_alloc, and then nothing is changed.
    void limit_map(const MapConfig& config) { builder_.limit_map(config); }
    /// After `finish`: the fused map.
    [[nodiscard]] FusedMap take_map() { return builder_.take_map(); }
    /// The fused map of another one goes on, which has ended (`finish`) and has this one's resolution
    /// (asserted), and with it what time it was there: what passes meanwhile makes the map older, and where
    /// the time leaps nothing does.
    void go_on_from(Pipeline& ended);
    /// `listener` is told of what goes into the maps from now on; null: nobody is.
    void tell(CommitListener* listener) noexcept { builder_.tell(listener); }

    /// Frames in the order of arrival. `stamp`: when it was received; it places nothing.
    void on_can(const wire::CanFrame& frame, WallTime stamp);
    /// Depth frames in the order of their capture, at about the time when they arrive among the CAN frames.
    void on_depth(DepthFrame frame);
    /// From now on `worker` turns depth frames into terms, and what is captured after a frame may go into the
    /// maps before it: a listener learns the order. While it is at one, two more wait, and the oldest gives
    /// way; where what waits has to be settled at once, they are counted as `queue_overflow`. Null: the call
    /// that releases a frame does, and everything waits for it. For `Release::once_placed` (asserted). While
    /// a frame is worked on, the pipeline must not be moved; the worker lives as long as it is named here.
    void work_beside(DepthWorker* worker);
    /// The worker may be done with a frame: then that goes into the maps, and the next begins.
    void on_worker_done();
    /// No CAN frame comes for now, and it is `now` on the host's clock, by who knows beside the bus: what
    /// need not wait any longer is integrated. Until a frame tells the time again the camera does, up to
    /// `now`.
    void on_silence(HostTime now);
    /// No further CAN frame will come: from now on the camera tells the time.
    void finish_can();
    /// Nothing more will come: what still waits is integrated or counted. Nothing may be given in afterwards.
    void finish();

    [[nodiscard]] std::span<const FedMap> maps() const noexcept { return builder_.maps(); }
    /// The map that is fed so, which is there (asserted).
    [[nodiscard]] const FusedMap& map(MapFeed feed = MapFeed::both) const noexcept {
        return builder_.map(feed);
    }
    [[nodiscard]] const PipelineAccounts& accounts() const noexcept { return accounts_; }
    /// In = used + rejected + what still waits, for each unit of account.
    [[nodiscard]] bool is_balanced() const;
    /// One table per unit of account.
    [[nodiscard]] std::vector<AccountTable> account_tables() const;
    /// The tables as text.
    [[nodiscard]] std::string account_text() const;

    /// The host's clock; empty while unknown.
    [[nodiscard]] std::optional<HostTime> now() const { return intake_.now(); }
    /// How often "now" went back by over 0.15 s: the host that sends SYNC began anew, or another one
    /// does. What waited was settled, and what was remembered of the time before forgotten: the maps stay.
    [[nodiscard]] std::uint64_t times_back() const noexcept { return time_leap_.times_back(); }
    /// How often it went ahead by over a second more than passed: another host sends SYNC, or its clock was
    /// set. The same is done, and the maps stay as old as they were.
    [[nodiscard]] std::uint64_t times_ahead() const noexcept { return time_leap_.times_ahead(); }
    /// When the readings were captured that the last `on_can`, `on_depth` or `on_silence` put into the maps.
    [[nodiscard]] std::span<const HostTime> just_used() const noexcept { return just_used_; }
    /// True if "now" is known and three periods have passed without a depth frame that the rig promises.
    [[nodiscard]] bool is_camera_stale() const;
    [[nodiscard]] const CanIntake& intake() const noexcept { return intake_; }
    /// Which joint samples the arm cannot have taken.
    [[nodiscard]] const JointGate& joint_gate() const noexcept { return joint_gate_; }
    /// Null if the rig has no camera.
    [[nodiscard]] const DepthStage* depth_stage() const noexcept { return builder_.depth_stage(); }
    /// What turns measurements into maps: whoever starts to record needs its joint samples.
    [[nodiscard]] const MapBuilder& builder() const noexcept { return builder_; }
    /// For a replay in a daemon's own order, which gives the pipeline itself nothing.
    [[nodiscard]] MapBuilder& builder() noexcept { return builder_; }

  private:
    Pipeline(const HostRig& rig, MapBuilder builder, const MappingConfig& mapping,
             const PipelineConfig& config);

    void settle_marks(HostTime now);
    void on_leap(const TimeLeap::Leap& leap);  ///< also a sleep, as one by 0
    /// What waits is integrated or counted, by what is known.
    void settle_waiting();
    void queue(const FrameOutcome& outcome);
    void queue(const RangeMeasurement& measurement);
    void queue(const JointMeasurement& joints);
    void queue(const JointSenderCheck::Ended& joint_samples);

    /// Integrates what need not wait any longer.
    void advance(HostTime now);
    void release_joints(HostTime until);
    /// Those captured until then, and those that are placed if that is enough.
    void release_measurements(HostTime until);
    [[nodiscard]] bool is_placed(const ReleaseKey& key, bool is_depth) const;
    [[nodiscard]] Status<ReadingReason> integrate(const RangeMeasurement& measurement);
    /// The frame goes into the maps, or the worker begins with it. Whether it is in the maps.
    bool take_depth(DepthFrame frame);
    void finish_depth();
    void drop_oldest_depth();

    PipelineConfig config_;
    // From frames to measurements in host time.
    CanIntake intake_;
    MarkGate marks_;
    TimeLeap time_leap_;
    bool has_can_time_ = false;            ///< and more of it may come
    std::optional<HostTime> told_beside_;  ///< of `on_silence`, since the newest frame
    // Their order.
    MeasurementQueue waiting_;
    HostTime released_until_;
    // Where each was taken, and what it says of the maps' voxels.
    JointGate joint_gate_;
    MapBuilder builder_;
    DepthBeside beside_;

    PipelineAccounts accounts_;
    std::vector<HostTime> just_used_;             ///< by the call under way, or the last one
    std::optional<Nanoseconds> camera_patience_;  ///< three periods; empty without a camera
    bool is_finished_ = false;
};

}  // namespace octoskin
