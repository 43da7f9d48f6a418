// From measurements in host time to maps: where the robot was, the beam or image, its voxels' terms, the
// maps. What it builds depends on nothing but the calls and their order: no clock, no queue, no gate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/beams/beam_builder.hpp"
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
#include "host/core/pipeline/robot_tracker.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/core/witness/sensor_witness.hpp"

namespace octoskin {

class MapBuilder {
  public:
    /// Refuses, by name, a link of the rig that the robot does not have. `robot` moves the joints of
    /// `rig.joints.joints`, in that order (asserted: as many). `depth_threads`: see DepthIntegrator.
    [[nodiscard]] static Result<MapBuilder, RobotModelFault> build(const HostRig& rig, RobotModel robot,
                                                                   const MappingConfig& mapping,
                                                                   const JointHistoryConfig& joints,
                                                                   const std::vector<MapFeed>& maps,
                                                                   unsigned depth_threads = 1);

    /// The map of all sensors (asserted that there is one) goes on from this one, which has the mapping's
    /// resolution (asserted).
    void begin_with(FusedMap map);
    /// The same, with what the range sensors read before: what is given in next becomes what it would have
    /// become where the state is from, for a rig and mapping that are equal. The answer: of so many zones
    /// what was read is left out, as this rig does not have them, or their optics are others. O(readings).
    [[nodiscard]] std::size_t begin_with(MapState state);
    /// All that the map of all sensors follows from, but for the joint samples (`for_each_joint_sample`). A
    /// copy: O(sensors). Throws std::bad_alloc.
    [[nodiscard]] MapState state() const { return {map().copy(), ranges_.histories()}; }
    /// What of it the range sensors read. Throws std::bad_alloc.
    [[nodiscard]] SensorHistories histories() const { return ranges_.histories(); }
    /// The map of all sensors waits for its next measurement: FusedMap::begin_to_wait. No replay does that:
    /// to be called behind `forget_motion`.
    void begin_to_wait() noexcept { own_map().begin_to_wait(); }
    /// FusedMap::forget_times, of the map of all sensors.
    void forget_times() noexcept { own_map().forget_times(); }
    /// Of a map that waits for the time to go on: FusedMap::wait.
    void wait(std::int64_t seconds);
    /// Other limits for it, at the same resolution (asserted).
    void limit_map(const MapConfig& config) { own_map().limit(config); }
    /// That map, for another builder to begin with; nothing may be given in after.
    [[nodiscard]] FusedMap take_map() { return std::move(own_map()); }
    /// `listener` is told of what goes in from now on; null: nobody is.
    void tell(CommitListener* listener) noexcept { listener_ = listener; }

    /// From now on readings of a sensor that contradicts the camera go into the map, too: who replays what
    /// went into a map has none of those that did not.
    void refuse_nobody() noexcept { refuses_contradicting_ = false; }

    /// Joint samples in the order of their times.
    [[nodiscard]] Status<JointReason> add(const JointMeasurement& joints);
    [[nodiscard]] Status<ReadingReason> integrate(const RangeMeasurement& measurement);
    [[nodiscard]] Status<DepthReason> integrate(DepthFrame frame);

    /// The same in three steps, for whoever has another thread for the second, which takes the time. One
    /// frame at a time; from the first step to the last readings and joint samples may be given in, and
    /// nobody may ask `depth_stage()` for anything but its camera.
    struct DepthWork {
        DepthFrame frame;
        std::optional<RobotPose> robot;  ///< at the frame's time, if it needs to be known
        Result<DepthUpdates, DepthReason> updates = unexpected(DepthReason::no_camera);
    };
    [[nodiscard]] Result<DepthWork, DepthReason> begin(DepthFrame frame);
    /// Uses nothing of the builder's but the depth stage.
    void work(DepthWork& depth);
    /// `late`: where the robot was then has been forgotten meanwhile.
    [[nodiscard]] Status<DepthReason> finish(const DepthWork& depth);

    /// Time leaps: where the robot was is forgotten, the maps stay. What comes next is told by a time that is
    /// ahead by this of the one so far, or behind, below 0.
    void forget_motion(Nanoseconds leapt);

    /// Whether the rig has this sensor and zone: no other reading may be given in (asserted).
    [[nodiscard]] bool has(const BeamSource& source) const { return beams_.has(source); }
    [[nodiscard]] bool has_camera() const noexcept { return depth_stage_.has_value(); }
    /// Whether a depth frame needs to know where the robot was. There must be a camera.
    [[nodiscard]] bool depth_needs_robot() const noexcept { return depth_stage_->needs_robot(); }
    /// Whether the joint samples about `instant` are here, or will never come.
    [[nodiscard]] bool is_settled(HostTime instant) const noexcept { return robot_.is_settled(instant); }
    /// Of the joints that a sample has, in its order.
    [[nodiscard]] std::span<const JointLimits> joint_limits() const noexcept {
        return robot_.robot().limits();
    }
    /// The newest gap between joint samples that no pose could be found in; empty if there was none.
    [[nodiscard]] const std::optional<JointGap>& newest_joint_gap() const noexcept {
        return robot_.newest_gap();
    }
    [[nodiscard]] std::uint64_t joint_gaps_in_a_row() const noexcept { return robot_.gaps_in_a_row(); }
    /// Every joint sample that poses are still interpolated from, the oldest first.
    void for_each_joint_sample(const std::function<void(const JointMeasurement&)>& visit) const {
        robot_.for_each_sample(visit);
    }

    [[nodiscard]] std::span<const FedMap> maps() const noexcept { return maps_; }
    /// The map that is fed so, which is there (asserted).
    [[nodiscard]] const FusedMap& map(MapFeed feed = MapFeed::both) const noexcept;
    /// Null if the rig has no camera.
    [[nodiscard]] const DepthStage* depth_stage() const noexcept {
        return depth_stage_ ? &*depth_stage_ : nullptr;
    }
    /// What the camera says of the range sensors; null without a camera, where the robot stays in its image,
    /// and where the mapping wants no reports.
    [[nodiscard]] const SensorWitness* witness() const noexcept { return witness_ ? &*witness_ : nullptr; }
    /// Whether the readings of a sensor of the rig stay out of the map, because it contradicts the camera.
    [[nodiscard]] bool is_refused(std::uint8_t node_id, std::uint8_t sensor) const {
        return refuses_contradicting_ && witness_ && witness_->is_to_be_refused(node_id, sensor);
    }

  private:
    MapBuilder(const HostRig& rig, RobotTracker robot, BeamBuilder beams, const MappingConfig& mapping,
               const std::vector<MapFeed>& maps, unsigned depth_threads);

    [[nodiscard]] FusedMap& own_map() noexcept;
    [[nodiscard]] Status<ReadingReason> add_range(const RangeMeasurement& measurement, const Beam& beam);

    RobotTracker robot_;
    BeamBuilder beams_;
    RangeModel ranges_;
    std::optional<DepthStage> depth_stage_;
    std::optional<SensorWitness> witness_;
    bool refuses_contradicting_ = false;
    SeenImages seen_;  ///< their memory goes to the depth stage and comes back
    std::vector<FedMap> maps_;
    CommitListener* listener_ = nullptr;
};

}  // namespace octoskin
