// Builds maps from measurements in host time: pose of the robot, beam or image, terms of the voxels, maps.
// The result depends only on the calls and their order: no clock, no queue, no gate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/beams/beam_builder.hpp"
#include "host/core/cross_check/cross_checks.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/mapping/map_state.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/mapping/range_model.hpp"
#include "host/core/pipeline/commit.hpp"
#include "host/core/pipeline/depth_stage.hpp"
#include "host/core/pipeline/fed_map.hpp"
#include "host/core/pipeline/map_feeder.hpp"
#include "host/core/pipeline/measurement_observer.hpp"
#include "host/core/pipeline/robot_tracker.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

class MapBuilder {
  public:
    /// Refuses, by name, a link of the rig that the robot does not have. `robot` must move the joints of
    /// `rig.joint_names()` in that order (asserted: equal count). `depth_threads`: of each camera, see
    /// DepthIntegrator.
    [[nodiscard]] static Result<MapBuilder, RobotModelFault> build(const HostRig& rig, RobotModel robot,
                                                                   const MappingConfig& mapping,
                                                                   const JointHistoryConfig& joints,
                                                                   const std::vector<MapFeed>& maps,
                                                                   unsigned depth_threads = 1);

    /// The map of all sensors (asserted: it exists) continues from `map`, which must have the mapping's
    /// resolution (asserted).
    void begin_with(FusedMap map);
    /// What of a state was dropped, because this rig is another.
    struct LeftOut {
        std::size_t zones = 0;  ///< that this rig does not have, or with other optics
        /// Names of the cameras that this rig does not have, or with another size or pose.
        std::vector<std::string> cameras = {};
        friend bool operator==(const LeftOut&, const LeftOut&) = default;
    };
    /// The same, with the memory of the sensors and of the cameras: for an equal rig and mapping, later
    /// inputs have the same effect as in the builder that the state comes from. O(readings + pixels). Throws
    /// std::bad_alloc.
    [[nodiscard]] LeftOut begin_with(MapState state);
    /// The complete state of the map of all sensors, except the joint samples (`for_each_joint_sample`). A
    /// copy: O(sensors + pixels). While a frame is in work, the state is that before the frame. Throws
    /// std::bad_alloc.
    [[nodiscard]] MapState state() const { return {map().copy(), ranges_.histories(), camera_memories()}; }
    /// The sensors' histories of that state. Throws std::bad_alloc.
    [[nodiscard]] SensorHistories histories() const { return ranges_.histories(); }
    /// The cameras' part of that state: DepthStage::memory.
    [[nodiscard]] std::vector<CameraMemory> camera_memories() const;
    /// The map of all sensors waits for its next measurement: FusedMap::begin_to_wait. A replay does not
    /// reproduce this: call it after `clear_motion`.
    void begin_to_wait() noexcept { own_map().begin_to_wait(); }
    /// FusedMap::clear_times of the map of all sensors.
    void clear_times() noexcept { own_map().clear_times(); }
    /// FusedMap::wait of the map of all sensors; the listener is notified if ages grew.
    void wait(std::int64_t seconds);
    /// Applies other limits to the map of all sensors, at the same resolution (asserted).
    void limit_map(const MapConfig& config) { own_map().limit(config); }
    /// Moves that map out, for another builder to continue. Later calls with inputs are not allowed.
    [[nodiscard]] FusedMap take_map() { return std::move(own_map()); }
    /// `listener` is notified of each later input; null: none.
    void set_listener(CommitListener* listener) noexcept { listener_ = listener; }
    /// `observer` sees each later measurement; null: none.
    void observe(MeasurementObserver* observer) noexcept { observer_ = observer; }

    /// From now on, readings of a sensor that contradicts the camera also go into the map. For a replay of a
    /// map's inputs, from which refused readings are already missing.
    void accept_contradicting() noexcept { refuses_contradicting_ = false; }

    /// Takes joint samples in the order of their times.
    [[nodiscard]] Status<JointReason> add(const JointMeasurement& joints);
    [[nodiscard]] Status<ReadingReason> integrate(const RangeMeasurement& measurement);
    [[nodiscard]] Status<DepthReason> integrate(DepthFrame frame);

    /// The same in three steps, so that another thread can run the second, which takes most of the time. One
    /// frame of each camera at a time. Between the first and the last step, readings, joint samples and
    /// frames of other cameras may be added, and `depth_stage` of the camera may be used for its camera, its
    /// memory and its wrong sizes only.
    struct DepthWork {
        DepthFrame frame;
        std::optional<RobotPose> robot;  ///< at the frame's time, if the frame requires it
        Result<DepthUpdates, DepthReason> updates = unexpected(DepthReason::no_camera);
    };
    [[nodiscard]] Result<DepthWork, DepthReason> begin(DepthFrame frame);
    /// Uses only the depth stage of the frame's camera.
    void work(DepthWork& depth);
    /// `late`: the robot's pose at that time is no longer stored, or other joints are known by now.
    [[nodiscard]] Status<DepthReason> finish(const DepthWork& depth);

    /// Time jump: clears the robot's motion; the maps stay. Later times are ahead of the earlier scale by
    /// `jumped_by`, or behind, if negative.
    void clear_motion(Nanoseconds jumped_by);

    /// True if the rig has this sensor and zone. Other readings must not be added (asserted).
    [[nodiscard]] bool has(const BeamSource& source) const { return beams_.has(source); }
    /// The number of the rig's cameras.
    [[nodiscard]] std::size_t cameras() const noexcept { return cameras_.size(); }
    /// True if a depth frame of that camera requires the robot's pose.
    [[nodiscard]] bool depth_needs_robot(std::size_t camera) const {
        return cameras_.at(camera).stage.needs_robot();
    }
    /// True if the joint samples around `instant` have arrived or will never come.
    [[nodiscard]] bool is_settled(HostTime instant) const noexcept { return robot_.is_settled(instant); }
    /// The robot's motion: gaps between joint samples, joints without a position.
    [[nodiscard]] const RobotTracker& robot() const noexcept { return robot_; }
    /// Visits all joint samples from which poses are still interpolated, the oldest of a source first.
    void for_each_joint_sample(const std::function<void(const JointMeasurement&)>& visit) const {
        robot_.for_each_sample(visit);
    }

    [[nodiscard]] std::span<const FedMap> maps() const noexcept { return maps_; }
    /// The map with this feed, which must exist (asserted).
    [[nodiscard]] const FusedMap& map(MapFeed feed = MapFeed::both) const noexcept;
    [[nodiscard]] const DepthStage& depth_stage(std::size_t camera) const {
        return cameras_.at(camera).stage;
    }
    /// The cross-checks of the range sensors against the cameras. Null without a camera, if the robot stays
    /// in the images, and if the mapping disables the reports.
    [[nodiscard]] const CrossChecks* cross_checks() const noexcept {
        return cross_checks_ ? &*cross_checks_ : nullptr;
    }
    /// True if the readings of a sensor of the rig are refused because it contradicts a camera.
    [[nodiscard]] bool is_refused(std::uint8_t node_id, std::uint8_t sensor) const {
        return refuses_contradicting_ && cross_checks_ && cross_checks_->is_to_be_refused(node_id, sensor);
    }

  private:
    struct Camera {
        std::optional<LinkId> link;  ///< that carries it; empty: the base link
        DepthStage stage;
    };
    /// `camera_links`: of each camera; empty: the base link.
    MapBuilder(const HostRig& rig, RobotTracker robot, std::span<const std::optional<LinkId>> camera_links,
               BeamBuilder beams, const MappingConfig& mapping, const std::vector<MapFeed>& maps,
               unsigned depth_threads);

    [[nodiscard]] FusedMap& own_map() noexcept;
    [[nodiscard]] Status<ReadingReason> add_range(const RangeMeasurement& measurement, const Beam& beam);
    void add_depth(const DepthWork& depth);
    /// Calls `apply`, which applies one input; notifies the listener if an exception leaves it.
    template <class Apply>
    auto watched(const Apply& apply);

    /// Gives a frame of a camera on a link its pose; `joints_missing`: the link is unplaced.
    [[nodiscard]] Status<DepthReason> place_camera(DepthFrame& frame, const RobotPose& robot) const;
    void compare(const RangeMeasurement& measurement, const Beam& beam, const RobotPose& robot);
    /// Relative to a camera, which a joint may move, too.
    [[nodiscard]] JointTwists seen_from(const Camera& camera, JointTwists twists_map,
                                        const RobotPose& robot) const;

    RobotTracker robot_;
    Eigen::Isometry3d T_map_base_;
    BeamBuilder beams_;
    RangeModel ranges_;
    std::vector<Camera> cameras_;
    std::optional<CrossChecks> cross_checks_;
    bool refuses_contradicting_ = false;
    SeenImages seen_;  ///< memory swapped with the depth stages
    std::vector<FedMap> maps_;
    CommitListener* listener_ = nullptr;
    MeasurementObserver* observer_ = nullptr;
};

}  // namespace octoskin
