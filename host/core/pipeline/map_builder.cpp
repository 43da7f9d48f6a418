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
    std::optional<LinkId> camera_link;
    if (rig.camera && !rig.camera->link.empty()) {
        camera_link = robot.find_link(rig.camera->link);
        if (!camera_link) return unexpected(RobotModelFault{RobotModelError::unreachable, rig.camera->link});
    }
    auto tracker = RobotTracker::build(rig, std::move(robot), joints);
    if (!tracker) {
        return unexpected(tracker.error());
    }
    return MapBuilder(rig, std::move(tracker).value(), camera_link, std::move(beams).value(), mapping, maps,
                      depth_threads);
}

MapBuilder::MapBuilder(const HostRig& rig, RobotTracker robot, std::optional<LinkId> camera_link,
                       BeamBuilder beams, const MappingConfig& mapping, const std::vector<MapFeed>& maps,
                       unsigned depth_threads)
    : robot_(std::move(robot)),
      T_map_base_(rig.T_map_base),
      camera_link_(camera_link),
      beams_(std::move(beams)),
      ranges_(mapping, mapping.range_update == RangeUpdate::cone && sees_any_cone(rig)) {
    for (const MapFeed feed : maps) maps_.push_back({feed, FusedMap(mapping.map)});
    const bool compares =
        rig.camera && mapping.removes_robot_from_depth && mapping.reports_contradicting_sensors;
    if (rig.camera) {
        depth_stage_.emplace(rig, mapping, depth_threads, compares);
    }
    if (compares) {
        cross_check_.emplace(rig, CrossCheckConfig{.camera_sigma_m = mapping.camera_sigma_m(),
                                                   .is_filtered = mapping.removes_camera_noise()});
        refuses_contradicting_ = mapping.refuses_contradicting_sensors;
    }
}

void MapBuilder::begin_with(FusedMap map) {
    assert(map.resolution_m() == own_map().resolution_m());
    own_map() = std::move(map);
}

MapBuilder::LeftOut MapBuilder::begin_with(MapState state) {
    if (depth_stage_) depth_stage_->forget();
    const bool is_camera_taken = !state.camera || (depth_stage_ && depth_stage_->resume_with(*state.camera));
    begin_with(std::move(state.map));
    const std::size_t zones = leave_out_others(state.histories, beams_);
    ranges_.resume_with(std::move(state.histories));
    return {.zones = zones, .is_camera = !is_camera_taken};
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
    return added;
}

void MapBuilder::clear_motion(Nanoseconds jumped_by) {
    if (listener_ != nullptr) {
        listener_->on_time_jump();
    }
    for (FedMap& fed : maps_) fed.map.jump_time(jumped_by);
    ranges_.forget();
    if (cross_check_) {
        cross_check_->forget_beams();
    }
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
    if (cross_check_ && (added || is_out)) {
        cross_check_->on_beam(*beam, beams_.T_map_sensor(source, *robot), twists_of(measurement, *robot));
    }
    return added;
}

/// Relative to the camera, which a joint may move, too.
JointTwists MapBuilder::twists_of(const RangeMeasurement& measurement, const RobotPose& robot) const {
    JointTwists twists = beams_.twists_map(measurement.source, robot, robot_.robot());
    if (!camera_link_) return twists;
    JointTwists of_camera;
    robot_.robot().twists(*camera_link_, robot.T_base_link, of_camera);
    of_camera = placed(T_map_base_, of_camera);
    for (std::size_t i = 0; i < twists.size(); ++i) {
        twists[i].turn -= of_camera[i].turn;
        twists[i].shift -= of_camera[i].shift;
    }
    return twists;
}

Status<DepthReason> MapBuilder::place_camera(DepthFrame& frame, const RobotPose& robot) const {
    if (!camera_link_ || frame.T_map_camera) return Done{};
    if ((robot_.robot().joints_above(*camera_link_) & robot.unknown) != 0)
        return unexpected(DepthReason::joints_missing);
    frame.T_map_camera =
        T_map_base_ * robot.T_base_link[*camera_link_] * depth_stage_->camera().T_link_camera;
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
    if (!depth_stage_) {
        return unexpected(DepthReason::no_camera);
    }
    DepthWork depth{.frame = std::move(frame), .robot = {}};
    if (depth_stage_->needs_robot()) {
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
    depth.updates = updates_or_reason(*depth_stage_, depth.frame, depth.robot ? &*depth.robot : nullptr);
}

Status<DepthReason> MapBuilder::finish(const DepthWork& depth) {
    if (!depth.updates) {
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
    depth_stage_->keep(depth.frame);
    MapFeeder feeder(maps_, depth.frame.captured, nullptr, listener_);
    if (!depth.updates->retracted.empty()) feeder.apply(depth.updates->retracted, nullptr);
    feeder.apply(depth.updates->terms, nullptr);
    if (cross_check_) {
        depth_stage_->swap_images(seen_);
        cross_check_->on_depth(seen_, depth_stage_->T_map_camera_of(depth.frame), depth.frame.captured);
    }
    if (listener_ != nullptr) {
        listener_->on_depth(depth.frame, depth.updates->terms);
        listener_->on_maps(maps_);
    }
}

}  // namespace octoskin
