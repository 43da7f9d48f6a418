#include "host/core/pipeline/map_builder.hpp"

#include <algorithm>
#include <cassert>
#include <new>
#include <utility>

namespace octoskin {
namespace {

ReadingReason reason_of(BeamFault fault) {
    switch (fault) {
        case BeamFault::self_hit:
            return ReadingReason::self_hit;
        case BeamFault::unplaced:
            return ReadingReason::joints_missing;
        case BeamFault::not_finite:
            break;
    }
    return ReadingReason::beam_not_valid;
}

ReadingReason reason_of(BeamRejection rejection) {
    if (rejection == BeamRejection::outside_map) return ReadingReason::outside_map;
    if (rejection == BeamRejection::cone_too_large) return ReadingReason::cone_too_large;
    return ReadingReason::beam_not_valid;
}

bool sees_any_cone(const HostRig& rig) {
    const auto is_cone = [](const HostZone& zone) { return zone.optics.is_cone(); };
    const auto has_cone = [&](const HostSensor& sensor) {
        return std::ranges::any_of(sensor.zones, is_cone);
    };
    return std::ranges::any_of(
        rig.nodes, [&](const HostNode& node) { return std::ranges::any_of(node.sensors, has_cone); });
}

/// Removes the zones that the rig does not have, or has with other optics: no beam of them will come, and a
/// beam of arbitrary width would take long to clear. Returns how many were removed.
std::size_t leave_out_others(SensorHistories& histories, const BeamBuilder& beams) {
    const auto is_other = [&](const Beam& beam) {
        const BeamOptics* const optics = beams.optics_of(beam.source);
        return optics == nullptr || *optics != beam.optics;
    };
    const auto has_other = [&](const auto& newest) {
        return std::ranges::any_of(newest, [&](const auto& reading) { return is_other(reading.beam); });
    };
    std::size_t left_out = 0;
    for (auto& sensor : histories) {
        left_out += std::erase_if(sensor.second.zones, [&](const auto& entry) {
            const ZoneHistory& zone = entry.second;
            return has_other(zone.newest) || has_other(zone.passages) ||
                   (zone.confirmed && is_other(*zone.confirmed));
        });
    }
    std::erase_if(histories, [](const auto& sensor) { return sensor.second.zones.empty(); });
    return left_out;
}

/// An image's box may be large: a lack of memory is handled as a refusal.
Result<DepthUpdates, DepthReason> updates_or_reason(DepthStage& stage, const DepthFrame& frame,
                                                    const RobotPose* robot) {
    try {
        return stage.updates(frame, robot);
    } catch (const std::bad_alloc&) {
        return unexpected(DepthReason::no_memory);
    }
}

}  // namespace

Result<MapBuilder, RobotModelFault> MapBuilder::build(const HostRig& rig, RobotModel robot,
                                                      const MappingConfig& mapping,
                                                      const JointHistoryConfig& joints,
                                                      const std::vector<MapFeed>& maps,
                                                      unsigned depth_threads) {
    auto beams = BeamBuilder::build(rig, robot,
                                    {.removes_robot = mapping.removes_robot_from_ranges,
                                     .no_return_clear_m = mapping.no_return_clear_m,
                                     .sees_cones = mapping.range_update == RangeUpdate::cone});
    if (!beams) {
        return unexpected(beams.error());
    }
    std::vector<std::optional<LinkId>> camera_links;
    for (const HostCamera& camera : rig.cameras) {
        camera_links.push_back(camera.link.empty() ? std::nullopt : robot.find_link(camera.link));
        if (!camera.link.empty() && !camera_links.back())
            return unexpected(RobotModelFault{RobotModelError::unreachable, camera.link});
    }
    auto tracker = RobotTracker::build(rig, std::move(robot), joints);
    if (!tracker) {
        return unexpected(tracker.error());
    }
    return MapBuilder(rig, std::move(tracker).value(), camera_links, std::move(beams).value(), mapping, maps,
                      depth_threads);
}

MapBuilder::MapBuilder(const HostRig& rig, RobotTracker robot,
                       std::span<const std::optional<LinkId>> camera_links, BeamBuilder beams,
                       const MappingConfig& mapping, const std::vector<MapFeed>& maps, unsigned depth_threads)
    : robot_(std::move(robot)),
      T_map_base_(rig.T_map_base),
      beams_(std::move(beams)),
      ranges_(mapping, mapping.range_update == RangeUpdate::cone && sees_any_cone(rig)) {
    for (const MapFeed feed : maps) maps_.push_back({feed, FusedMap(mapping.map)});
    const bool compares =
        !rig.cameras.empty() && mapping.removes_robot_from_depth && mapping.reports_contradicting_sensors;
    std::vector<CrossCheckConfig> checks;
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        cameras_.push_back({camera_links[i], DepthStage(rig, mapping, depth_threads, compares, i)});
        const MappingConfig of_camera = mapping_of(rig.cameras[i], mapping);
        checks.push_back(
            {.camera_sigma_m = of_camera.camera_sigma_m(), .is_filtered = of_camera.removes_camera_noise()});
    }
    if (compares) {
        cross_checks_.emplace(rig, checks);
        refuses_contradicting_ = mapping.refuses_contradicting_sensors;
    }
}

void MapBuilder::begin_with(FusedMap map) {
    assert(map.resolution_m() == own_map().resolution_m());
    own_map() = std::move(map);
}

MapBuilder::LeftOut MapBuilder::begin_with(MapState state) {
    LeftOut left_out;
    for (Camera& camera : cameras_) camera.stage.forget();
    for (const CameraMemory& memory : state.cameras) {
        const bool is_taken = std::ranges::any_of(
            cameras_, [&memory](Camera& camera) { return camera.stage.resume_with(memory); });
        if (!is_taken) left_out.cameras.push_back(memory.name);
    }
    begin_with(std::move(state.map));
    left_out.zones = leave_out_others(state.histories, beams_);
    ranges_.resume_with(std::move(state.histories));
    return left_out;
}

std::vector<CameraMemory> MapBuilder::camera_memories() const {
    std::vector<CameraMemory> memories;
    for (const Camera& camera : cameras_)
        if (auto memory = camera.stage.memory()) memories.push_back(std::move(*memory));
    return memories;
}

void MapBuilder::wait(std::int64_t seconds) {
    if (!own_map().wait(seconds) || listener_ == nullptr) return;
    listener_->on_wait({seconds});
    listener_->on_time(std::nullopt, maps_);
}

const FusedMap& MapBuilder::map(MapFeed feed) const noexcept {
    const FusedMap* const map = find_map(maps_, feed);
    assert(map != nullptr);
    return *map;
}

FusedMap& MapBuilder::own_map() noexcept {
    const auto found = std::ranges::find(maps_, MapFeed::both, &FedMap::feed);
    assert(found != maps_.end());
    return found->map;
}

template <class Apply>
auto MapBuilder::watched(const Apply& apply) {
    try {
        return apply();
    } catch (...) {
        if (listener_ != nullptr) listener_->on_broken_off();
        throw;
    }
}

Status<JointReason> MapBuilder::add(const JointMeasurement& joints) {
    const auto added = watched([&] { return robot_.add(joints); });
    if (added && listener_ != nullptr) {
        listener_->on_joints(joints);
    }
    if (added && observer_ != nullptr) observer_->on_sample(joints);
    return added;
}

void MapBuilder::clear_motion(Nanoseconds jumped_by) {
    if (listener_ != nullptr) {
        listener_->on_time_jump();
    }
    for (FedMap& fed : maps_) fed.map.jump_time(jumped_by);
    ranges_.forget();
    if (cross_checks_) cross_checks_->forget_beams();
    robot_.forget();
}

Status<ReadingReason> MapBuilder::integrate(const RangeMeasurement& measurement) {
    const RobotPose* const robot = robot_.at(measurement.captured);
    if (robot == nullptr) {
        return unexpected(ReadingReason::joints_missing);
    }
    const auto beam = beams_.place(measurement, *robot);
    if (!beam) {
        return unexpected(reason_of(beam.error()));
    }
    const BeamSource& source = measurement.source;
    const bool is_out = is_refused(source.node_id, source.sensor);
    const Status<ReadingReason> added = is_out ? unexpected(ReadingReason::contradicts_camera)
                                               : watched([&] { return add_range(measurement, *beam); });
    if (added && observer_ != nullptr) observer_->on_beam(*beam);
    if (cross_checks_ && (added || is_out)) compare(measurement, *beam, *robot);
    return added;
}

void MapBuilder::compare(const RangeMeasurement& measurement, const Beam& beam, const RobotPose& robot) {
    const Eigen::Isometry3d T_map_sensor = beams_.T_map_sensor(measurement.source, robot);
    const JointTwists twists_map = beams_.twists_map(measurement.source, robot, robot_.robot());
    for (std::size_t i = 0; i < cameras_.size(); ++i)
        cross_checks_->of(i).on_beam(beam, T_map_sensor, seen_from(cameras_[i], twists_map, robot));
}

JointTwists MapBuilder::seen_from(const Camera& camera, JointTwists twists_map,
                                  const RobotPose& robot) const {
    if (!camera.link) return twists_map;
    JointTwists of_camera;
    robot_.robot().twists(*camera.link, robot.T_base_link, of_camera);
    of_camera = placed(T_map_base_, of_camera);
    for (std::size_t i = 0; i < twists_map.size(); ++i) {
        twists_map[i].turn -= of_camera[i].turn;
        twists_map[i].shift -= of_camera[i].shift;
    }
    return twists_map;
}

Status<DepthReason> MapBuilder::place_camera(DepthFrame& frame, const RobotPose& robot) const {
    const Camera& camera = cameras_.at(frame.camera);
    if (!camera.link || frame.T_map_camera) return Done{};
    if ((robot_.robot().joints_above(*camera.link) & robot.unknown) != 0)
        return unexpected(DepthReason::joints_missing);
    frame.T_map_camera = T_map_base_ * robot.T_base_link[*camera.link] * camera.stage.camera().T_link_camera;
    return Done{};
}

Status<ReadingReason> MapBuilder::add_range(const RangeMeasurement& measurement, const Beam& beam) {
    std::vector<VoxelUpdate> changes;
    MapFeeder feeder(maps_, measurement.captured, listener_ != nullptr ? &changes : nullptr, listener_);
    if (const auto added = ranges_.integrate(beam, feeder); !added)
        return unexpected(reason_of(added.error()));
    if (listener_ != nullptr) {
        listener_->on_reading(measurement, beam, changes);
        listener_->on_maps(maps_);
    }
    return Done{};
}

Status<DepthReason> MapBuilder::integrate(DepthFrame frame) {
    auto depth = begin(std::move(frame));
    if (!depth) {
        return unexpected(depth.error());
    }
    work(*depth);
    return finish(*depth);
}

Result<MapBuilder::DepthWork, DepthReason> MapBuilder::begin(DepthFrame frame) {
    if (frame.camera >= cameras_.size()) return unexpected(DepthReason::no_camera);
    DepthWork depth{.frame = std::move(frame), .robot = {}};
    if (depth_needs_robot(depth.frame.camera)) {
        const RobotPose* const robot = robot_.at(depth.frame.captured);
        if (robot == nullptr) {
            return unexpected(DepthReason::joints_missing);
        }
        depth.robot = *robot;
        if (const auto placed = place_camera(depth.frame, *robot); !placed) return unexpected(placed.error());
    }
    return depth;
}

void MapBuilder::work(DepthWork& depth) {
    DepthStage& stage = cameras_[depth.frame.camera].stage;
    depth.updates = updates_or_reason(stage, depth.frame, depth.robot ? &*depth.robot : nullptr);
}

Status<DepthReason> MapBuilder::finish(const DepthWork& depth) {
    if (!depth.updates) {
        if (depth.updates.error() == DepthReason::wrong_size)
            cameras_[depth.frame.camera].stage.note_wrong_size(depth.frame);
        return unexpected(depth.updates.error());
    }
    // A replay of the order that the listener gets computes the pose now: it must be the one that was used.
    if (depth.robot) {
        const RobotPose* const now = robot_.at(depth.frame.captured);
        if (now == nullptr || now->unknown != depth.robot->unknown) return unexpected(DepthReason::late);
    }
    watched([&] { add_depth(depth); });
    return Done{};
}

void MapBuilder::add_depth(const DepthWork& depth) {
    DepthStage& stage = cameras_[depth.frame.camera].stage;
    stage.keep(depth.frame);
    MapFeeder feeder(maps_, depth.frame.captured, nullptr, listener_);
    if (!depth.updates->retracted.empty()) feeder.apply(depth.updates->retracted, nullptr);
    feeder.apply(depth.updates->terms, nullptr);
    if (cross_checks_) {
        stage.swap_images(seen_);
        cross_checks_->of(depth.frame.camera)
            .on_depth(seen_, stage.T_map_camera_of(depth.frame), depth.frame.captured);
    }
    if (listener_ != nullptr) {
        listener_->on_depth(depth.frame, depth.updates->terms);
        listener_->on_maps(maps_);
    }
    if (observer_ != nullptr) observer_->on_image(depth.frame);
}

}  // namespace octoskin
