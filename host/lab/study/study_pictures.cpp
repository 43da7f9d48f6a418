#include "host/lab/study/study_pictures.hpp"

#include <algorithm>

#include "host/apps/recording/reading.hpp"
#include "host/io/watch/map_changes.hpp"
#include "host/lab/report/pictures.hpp"
#include "host/lab/study/captions.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/arm/trajectory.hpp"

namespace octoskin {
namespace {

using report::PicturePair;

using Beams = std::vector<report::Segment>;

/// One range of each sensor whose beam meets the world.
Beams beams_at(const sim::World& world, const rig::Rig& rig, const sim::Arm::LinkPoses& poses) {
    Beams beams;
    for (const rig::Node& node : rig.nodes) {
        for (const rig::Sensor& sensor : node.sensors) {
            const Eigen::Isometry3d T_base_sensor = poses.at(sensor.link) * sensor.T_link_sensor;
            const Eigen::Vector3d origin = T_base_sensor.translation();
            const Eigen::Vector3d direction = T_base_sensor.linear().col(2);
            if (const auto hit = world.cast(origin, direction, rig.range_limits.max_m)) {
                beams.push_back({origin, origin + hit->range_m * direction});
            }
        }
    }
    return beams;
}

/// Adds the robot at the instant of its motion, out of a few, at which most sensors see the world.
void dress_with_robot(const sim::World& world, const sim::Scenario& scenario, const rig::Rig& rig,
                      report::SceneDressing& dressing) {
    const auto lock = lock_reading();
    const auto arm = sim::Arm::read(rig.urdf, rig.base_link, rig.joint_names());
    const auto capsules = rig::real_body(rig);
    if (!arm || !capsules)
        return;  // not expected: the same files were read before; the picture is then drawn without the robot
    const auto trajectory = sim::Trajectory::circle(*arm, scenario.motion, sim::SimTime{0});
    if (!trajectory) return;
    constexpr int kInstants = 8;
    for (int i = 0; i < kInstants; ++i) {
        const auto poses = arm->forward(trajectory->at(sim::SimTime{trajectory->end().us * i / kInstants}));
        Beams beams = beams_at(world, rig, poses);
        if (i > 0 && beams.size() <= dressing.beams.size()) continue;
        dressing.beams = std::move(beams);
        dressing.robot.clear();
        for (const sim::BodyCapsule& capsule : sim::posed_body(*capsules, poses)) {
            dressing.robot.push_back({capsule.p_base_a, capsule.p_base_b, capsule.radius_m});
        }
    }
}

/// A map with its title and caption.
struct NamedMap {
    std::string title;
    std::string caption;
    const FusedMap* map;
};

NamedMap camera_map_to_draw(const FusedMap* map, std::size_t cameras) {
    if (cameras == 1) return {"Depth camera only", "The map of the external camera alone.", map};
    return {std::to_string(cameras) + " depth cameras only", "The map of the depth cameras alone.", map};
}

std::vector<NamedMap> maps_to_draw(std::span<const FedMap> maps, std::size_t cameras) {
    const NamedMap ranges = {"Range sensors only", "What the sensors on the arm measured during its motion.",
                             find_map(maps, MapFeed::ranges)};
    if (cameras == 0) return {ranges};
    return {camera_map_to_draw(find_map(maps, MapFeed::camera), cameras),
            ranges,
            {"Fused", "One map of both.", find_map(maps, MapFeed::both)}};
}

/// All with the same views, so that the pictures can be compared.
std::vector<PicturePair> draw_maps(const std::vector<NamedMap>& named, const evaluation::Truth& truth) {
    std::vector<std::vector<report::PaintedVoxel>> painted;
    for (const NamedMap& one : named) painted.push_back(report::paint_map(*one.map, truth));
    painted.push_back(report::paint_truth(truth));
    const Eigen::AlignedBox3d content = report::content_of(painted, truth.resolution_m);
    if (content.isEmpty()) return {};
    const report::ViewPair views = report::views_of(report::corners_of(content));
    std::vector<PicturePair> pictures;
    for (std::size_t i = 0; i < named.size(); ++i) {
        report::ImagePair images = report::render_voxels(painted[i], truth.resolution_m, views);
        pictures.push_back(
            {named[i].title, named[i].caption, std::move(images.front), std::move(images.back)});
    }
    return pictures;
}

PicturePair draw_scene(const sim::World& world, const sim::Scenario& scenario, const rig::Rig& rig) {
    report::SceneDressing dressing;
    dressing.stage = {scenario.region.p_base_min, scenario.region.p_base_max};
    if (scenario.region.floor_top_m) dressing.stage.min().z() = *scenario.region.floor_top_m;
    dressing.cameras = rig.external_cameras();
    dressing.hidden_models = scenario.hidden_models;
    dress_with_robot(world, scenario, rig, dressing);
    report::ImagePair images = report::render_scene(world, dressing);
    return {"The scene", scene_caption(rig, scenario, dressing.beams.size()), std::move(images.front),
            std::move(images.back)};
}

}  // namespace

std::vector<PicturePair> draw_pictures(const sim::World& world, const sim::Scenario& scenario,
                                       const rig::Rig& rig, std::span<const FedMap> maps,
                                       const evaluation::Truth& truth) {
    std::vector<PicturePair> pictures = draw_maps(maps_to_draw(maps, rig.cameras.size()), truth);
    pictures.insert(pictures.begin(), draw_scene(world, scenario, rig));
    return pictures;
}

std::vector<report::ViewedMap> viewed_maps(std::span<const FedMap> maps, std::size_t cameras) {
    constexpr std::size_t kPayloadBytes = std::size_t{1} << 20U;
    std::vector<report::ViewedMap> viewed;
    for (const NamedMap& named : maps_to_draw(maps, cameras)) {
        report::ViewedMap& one = viewed.emplace_back();
        one.title = named.title;
        watch::MissingBricks bricks;
        bricks.add(watch::bricks_of(*named.map));
        do one.payloads.push_back(bricks.take(*named.map, kPayloadBytes));
        while (!bricks.empty());
    }
    std::ranges::reverse(viewed);  // the fused map is shown first
    return viewed;
}

}  // namespace octoskin
