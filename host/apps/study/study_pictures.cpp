#include "host/apps/study/study_pictures.hpp"

#include "host/apps/recording/reading.hpp"
#include "host/apps/report/pictures.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/arm/trajectory.hpp"

namespace octoskin {
namespace {

using report::PicturePair;

/// The robot as it stands a quarter of the way round, with one range of each sensor.
void dress_with_robot(const sim::World& world, const sim::Scenario& scenario, const rig::Rig& rig,
                      report::SceneDressing& dressing) {
    const auto lock = lock_reading();
    const auto arm = sim::Arm::read(rig.urdf, rig.base_link, rig.joints.joints);
    const auto capsules = rig::read_capsules(rig.urdf, {});
    if (!arm || !capsules) return;  // the same files were read before; a picture without a robot beats none
    const auto trajectory = sim::Trajectory::circle(*arm, scenario.motion, sim::SimTime{0});
    if (!trajectory) return;
    const sim::SimTime instant{trajectory->end().us / 8};
    const auto poses = arm->forward(trajectory->at(instant));
    for (const sim::BodyCapsule& capsule : sim::posed_body(*capsules, poses)) {
        dressing.robot.push_back({capsule.p_base_a, capsule.p_base_b, capsule.radius_m});
    }
    for (const rig::Node& node : rig.nodes) {
        for (const rig::Sensor& sensor : node.sensors) {
            const Eigen::Isometry3d T_base_sensor = poses.at(sensor.link) * sensor.T_link_sensor;
            const Eigen::Vector3d origin = T_base_sensor.translation();
            const Eigen::Vector3d direction = T_base_sensor.linear().col(2);
            if (const auto hit = world.cast(origin, direction, rig.range_limits.max_m);
                hit && direction.z() < 0.3) {
                dressing.beams.push_back({origin, origin + hit->range_m * direction});
            }
        }
    }
}

PicturePair draw_map(const char* title, const char* caption, const FusedMap& map,
                     const evaluation::Truth& truth) {
    report::ImagePair images =
        report::render_voxels(report::paint_map(map, truth), truth.resolution_m, report::views_of(truth));
    return {title, caption, std::move(images.front), std::move(images.back)};
}

PicturePair draw_scene(const sim::World& world, const sim::Scenario& scenario, const rig::Rig& rig) {
    report::SceneDressing dressing;
    dressing.stage = {scenario.region.p_base_min, scenario.region.p_base_max};
    if (scenario.region.floor_top_m) dressing.stage.min().z() = *scenario.region.floor_top_m;
    dressing.camera = rig.camera;
    dressing.hidden_models = scenario.hidden_models;
    dress_with_robot(world, scenario, rig, dressing);
    report::ImagePair images = report::render_scene(world, dressing);
    return {"The scene",
            "The arm with its range sensors' beams, the external camera, and what the camera cannot see: the "
            "hidden objects, and the "
            "insides of the compartments.",
            std::move(images.front), std::move(images.back)};
}

}  // namespace

std::vector<PicturePair> draw_pictures(const sim::World& world, const sim::Scenario& scenario,
                                       const rig::Rig& rig, const MapSet& maps,
                                       const evaluation::Truth& truth) {
    std::vector<PicturePair> pictures;
    pictures.push_back(draw_scene(world, scenario, rig));
    pictures.push_back(draw_map("Depth camera only",
                                "What a planner with the external camera knows: the shelves' backs and tops, "
                                "and nothing behind them.",
                                *maps.depth(), truth));
    pictures.push_back(draw_map("Range sensors only",
                                "What the sensors on the arm found in one revolution: thin bands where beams "
                                "met the objects and the compartments.",
                                *maps.proximity(), truth));
    pictures.push_back(draw_map(
        "Fused", "One map of both: the backs from the camera; objects and compartments from the arm.",
        *maps.fused(), truth));
    return pictures;
}

}  // namespace octoskin
