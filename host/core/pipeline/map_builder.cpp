#include "host/core/pipeline/map_builder.hpp"

#include <algorithm>
#include <cassert>
#include <new>
#include <utility>

namespace octoskin {
namespace {

ReadingReason reason_of(BeamFault fault) {
    return fault == BeamFault::self_hit ? ReadingReason::self_hit : ReadingReason::beam_not_valid;
}

ReadingReason reason_of(BeamRejection rejection) {
    return rejection == BeamRejection::outside_map ? ReadingReason::outside_map
                                                   : ReadingReason::beam_not_valid;
}

CapWidth width_of(const StandingRanges::Answer& standing) {
    return standing.stands ? CapWidth::core : CapWidth::whole;
}

bool sees_any_cone(const HostRig& rig) {
    const auto is_cone = [](const HostZone& zone) { return zone.optics.is_cone(); };
    const auto has_cone = [&](const HostSensor& sensor) {
        return std::ranges::any_of(sensor.zones, is_cone);
    };
    return std::ranges::any_of(
        rig.nodes, [&](const HostNode& node) { return std::ranges::any_of(node.sensors, has_cone); });
}

/// An image's box may be large: what there is no memory for is refused like what is wrong.
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
                                                      const JointHistoryConfig& joints, const MapChoice& maps,
                                                      unsigned depth_threads) {
    assert(robot.joint_count() == rig.joints.joints.size());
    auto beams = BeamBuilder::build(rig, robot,
                                    {.removes_robot = mapping.removes_robot_from_ranges,
                                     .no_return_clear_m = mapping.no_return_clear_m,
                                     .sees_cones = mapping.range_update == RangeUpdate::cone});
    if (!beams) {
        return unexpected(beams.error());
    }
    auto tracker = RobotTracker::build(rig, std::move(robot), joints);
    if (!tracker) {
        return unexpected(tracker.error());
    }
    return MapBuilder(rig, std::move(tracker).value(), std::move(beams).value(), mapping, maps,
                      depth_threads);
}

MapBuilder::MapBuilder(const HostRig& rig, RobotTracker robot, BeamBuilder beams,
                       const MappingConfig& mapping, const MapChoice& maps, unsigned depth_threads)
    : robot_(std::move(robot)),
      beams_(std::move(beams)),
      beam_integrator_(mapping),
      cone_finder_(mapping),
      standing_(mapping.standing),
      sight_(mapping.standing),
      has_cones_(mapping.range_update == RangeUpdate::cone && sees_any_cone(rig)),
      maps_(mapping.map, maps) {
    const bool compares =
        rig.camera && mapping.removes_robot_from_depth && mapping.reports_contradicting_sensors;
    if (rig.camera) {
        depth_stage_.emplace(rig, mapping, depth_threads, compares);
    }
    if (compares) {
        witness_.emplace(rig, WitnessConfig{.camera_sigma_m = mapping.depth_filter.sigma_m,
                                            .is_filtered = mapping.depth_filter.is_enabled});
        refuses_contradicting_ = mapping.refuses_contradicting_sensors;
    }
}

Status<JointReason> MapBuilder::add(const JointMeasurement& joints) {
    const auto added = robot_.add(joints);
    if (added && listener_ != nullptr) {
        listener_->on_joints(joints);
    }
    return added;
}

void MapBuilder::forget_motion(Nanoseconds leapt) {
    if (listener_ != nullptr) {
        listener_->on_time_leap();
    }
    maps_.leap(leapt);
    standing_.forget();
    sight_.forget();
    if (witness_) {
        witness_->forget_beams();
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
                                        : beam->optics.is_cone() ? add_cone(measurement, *beam)
                                                                 : add_ray(measurement, *beam);
    if (witness_ && (added || is_out)) {
        witness_->on_beam(*beam, beams_.T_map_sensor(source, *robot));
    }
    return added;
}

Status<ReadingReason> MapBuilder::add_ray(const RangeMeasurement& measurement, const Beam& beam) {
    const auto updates = beam_integrator_.integrate(beam);
    if (!updates) {
        return unexpected(reason_of(updates.error()));
    }
    maps_.go_on(measurement.captured);
    maps_.add_proximity(*updates);
    if (has_cones_) {
        (void)sight_.take(beam, cone_finder_.length_m(beam));
    }
    if (listener_ != nullptr) {
        listener_->on_reading(measurement, beam, *updates);
        listener_->on_maps(maps_);
    }
    return Done{};
}

Status<ReadingReason> MapBuilder::add_cone(const RangeMeasurement& measurement, const Beam& beam) {
    const StandingRanges::Answer standing = standing_.take(beam);
    const auto voxels = cone_finder_.find(beam, width_of(standing));
    if (!voxels) {
        return unexpected(reason_of(voxels.error()));
    }
    maps_.go_on(measurement.captured);
    const ConeModel& model = cone_finder_.model_of(beam);
    const Blame blame = standing.is_told ? Blame::occupied : Blame::all;
    if (listener_ != nullptr) {
        std::vector<VoxelUpdate> changes = maps_.changes_of_proximity(**voxels, model, blame);
        believe_standing(beam, standing, &changes);
        listener_->on_reading(measurement, beam, changes);
        listener_->on_maps(maps_);
    } else {
        maps_.add_proximity(**voxels, model, blame);
        believe_standing(beam, standing, nullptr);
    }
    return Done{};
}

void MapBuilder::believe_standing(const Beam& beam, const StandingRanges::Answer& standing,
                                  std::vector<VoxelUpdate>* changes) {
    std::vector<VoxelUpdate> more;
    std::vector<VoxelUpdate>* const told = changes != nullptr ? &more : nullptr;
    if (const Beam* const through = sight_.take(beam, cone_finder_.length_m(beam))) {
        const auto is_ranged = [&](VoxelKey key) {
            return sight_.any_newest(beam.captured,
                                     [&](const Beam& other) { return cone_finder_.ends_about(other, key); });
        };
        if (const auto voxels = cone_finder_.find(*through)) {
            maps_.clear(**voxels, is_ranged, told);
        }
    }
    for (const Beam& ended : standing.ended) {
        if (const auto voxels = cone_finder_.find(ended)) {
            maps_.forget_weak_hits(**voxels, told);
        }
    }
    for (const Beam& believed : standing.believed) {
        // As a rule what was marked once is still there, and nothing else need be found.
        const Eigen::Vector3d p_map = believed.p_map_sensor + *believed.range_m * believed.direction_map;
        if (maps_.is_marked(p_map)) continue;
        // So near to the edge of the octree a mean of ranges may lie beyond it.
        if (const auto voxels = cone_finder_.find(believed, width_of(standing))) {
            maps_.mark(**voxels, p_map, standing_.model().hits, told);
        }
    }
    for (const VoxelUpdate& update : more) {
        const auto same = std::ranges::find(*changes, update.key, &VoxelUpdate::key);
        if (same != changes->end()) {
            same->log_odds += update.log_odds;
        } else {
            changes->push_back(update);
        }
    }
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
    // Who replays the order that the listener is told asks for the pose now.
    if (depth.robot && robot_.at(depth.frame.captured) == nullptr) {
        return unexpected(DepthReason::late);
    }
    maps_.go_on(depth.frame.captured);
    maps_.add_depth(depth.updates->terms);
    if (witness_) {
        depth_stage_->swap_images(seen_);
        witness_->on_depth(seen_, depth_stage_->T_map_camera_of(depth.frame), depth.frame.captured);
    }
    if (listener_ != nullptr) {
        listener_->on_depth(depth.frame, depth.updates->terms);
        listener_->on_maps(maps_);
    }
    return Done{};
}

}  // namespace octoskin
