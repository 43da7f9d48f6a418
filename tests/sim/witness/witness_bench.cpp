#include "tests/sim/witness/witness_bench.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "host/core/beams/beam_builder.hpp"
#include "host/core/depth/depth_image.hpp"
#include "host/core/pipeline/robot_tracker.hpp"
#include "host/core/self_filter/robot_filter.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/camera/depth_camera.hpp"
#include "hw/sim/camera/sensor_scene.hpp"

namespace octoskin::testing_support {
namespace {

const std::filesystem::path kHw = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw";

/// What a fixture needs must be there.
template <class T>
auto needed(T result) {
    if (!result) std::abort();
    return std::move(*result);
}

rig::Rig read_rig_of(std::uint32_t pixel_divisor) {
    rig::Rig rig = needed(rig::read_rig(kHw / "rigs/experiment.yaml"));
    rig::Camera& camera = *rig.camera;
    camera.width /= pixel_divisor;
    camera.height /= pixel_divisor;
    for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value /= pixel_divisor;
    return rig;
}

struct Mounted {
    BeamSource source;
    sim::SensorMount mount;
};

}  // namespace

struct WitnessBench::Parts {
    explicit Parts(std::uint32_t pixel_divisor)
        : rig(read_rig_of(pixel_divisor)),
          arm(needed(sim::Arm::read(rig.urdf, rig.base_link, rig.joints.joints))),
          capsules(needed(rig::read_capsules(rig.urdf, {}))),
          scenario(needed(sim::read_scenario(kHw / "worlds/experiment.scenario.yaml"))),
          world(needed(sim::World::read(scenario.world))),
          trajectory(needed(sim::Trajectory::circle(arm, scenario.motion, sim::SimTime{0}))) {
        std::uint32_t noise_id = 0;
        for (const rig::Node& node : rig.nodes) {
            for (std::size_t i = 0; i < node.sensors.size(); ++i, ++noise_id) {
                const rig::Sensor& sensor = node.sensors[i];
                mounted.push_back({{node.config.node_id, static_cast<std::uint8_t>(i), 0},
                                   {sensor.link, sensor.T_link_sensor, noise_id}});
            }
        }
    }

    rig::Rig rig;
    sim::Arm arm;
    std::vector<rig::Capsule> capsules;
    sim::Scenario scenario;
    sim::World world;
    sim::Trajectory trajectory;
    std::vector<Mounted> mounted;
};

std::size_t WitnessOutcome::flagged() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(flagged_s, [](const auto& at) { return at.has_value(); }));
}

double WitnessOutcome::flagged_s_median() const {
    std::vector<double> times;
    for (const auto& at : flagged_s) {
        if (at) times.push_back(*at);
    }
    std::ranges::sort(times);
    return times.empty() ? 0.0 : times[times.size() / 2];
}

WitnessBench::WitnessBench(std::uint32_t pixel_divisor)
    : parts_(std::make_unique<const Parts>(pixel_divisor)) {}
WitnessBench::~WitnessBench() = default;

std::size_t WitnessBench::sensors() const {
    return parts_->mounted.size();
}

WitnessOutcome WitnessBench::run(std::uint64_t seed, const RigFault& fault, double frames_hz) const {
    const Parts& parts = *parts_;
    HostSetup setup = needed(make_host_setup(parts.rig));
    const HostRig& host = setup.rig;
    const BeamBuilder beams = needed(BeamBuilder::build(host, setup.robot, {}));
    RobotTracker tracker = needed(RobotTracker::build(host, std::move(setup.robot), {}));
    const PixelRays pixel_rays(host.camera->intrinsics);
    const sim::DepthCamera camera(parts.world, *parts.rig.camera, parts.scenario.depth_sigma_m, seed);
    std::vector<sim::RangingScene> scenes;
    for (const Mounted& sensor : parts.mounted) {
        scenes.push_back(sim::ranging_scene({parts.world, parts.arm, parts.trajectory, parts.capsules,
                                             parts.rig.links_ignored_by_sensors, parts.scenario.ranges, seed},
                                            sensor.mount));
    }
    SensorWitness witness(host, {.is_filtered = false});
    WitnessOutcome outcome;
    outcome.flagged_s.resize(parts.mounted.size());
    const auto frames = static_cast<std::uint32_t>(10.0 * frames_hz);
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        const double at_s = frame / frames_hz;
        const sim::SimTime time{std::llround(1e6 * at_s)};
        const HostTime captured{1'000 * time.us};
        const Eigen::VectorXd joints = parts.trajectory.at(time);
        JointMeasurement sample{captured, {}};
        std::copy(joints.begin(), joints.end(), sample.position_rad.begin());
        if (!tracker.add(sample)) std::abort();
        const RobotPose robot = *tracker.at(captured);
        for (SensorNumber i = 0; i < parts.mounted.size(); ++i) {
            const SensorNumber optics = fault.wired_to ? fault.wired_to(i) : i;
            const auto seen = scenes[optics](frame, time, Roi{});
            if (!seen.range_m) continue;
            const double range_m = fault.altered ? fault.altered(i, *seen.range_m) : *seen.range_m;
            if (range_m < host.range_limits.min_m || range_m > host.range_limits.max_m) continue;
            const auto beam = beams.place({parts.mounted[i].source, captured, range_m, seen.sigma_m}, robot);
            if (beam) witness.on_beam(*beam, beams.T_map_sensor(beam->source, robot));
        }
        DepthImage image = needed(
            to_depth_image({captured, host.camera->intrinsics.width, host.camera->intrinsics.height,
                            camera.render(sim::posed_body(parts.capsules, parts.arm.forward(joints)), frame)},
                           {host.camera->depth_min_m, host.camera->depth_max_m}));
        const Eigen::Isometry3d T_camera_base = host.camera->T_base_camera.inverse();
        std::vector<PosedCapsule> body_camera = robot.body_base;
        for (PosedCapsule& capsule : body_camera) {
            capsule.p_a = T_camera_base * capsule.p_a;
            capsule.p_b = T_camera_base * capsule.p_b;
        }
        DepthImage everything = image;
        remove_robot(image, pixel_rays, body_camera, host.depth_self_margin_m);
        const auto began = std::chrono::steady_clock::now();
        witness.on_depth(everything, image, host.T_map_base * host.camera->T_base_camera, captured);
        witness.settle();
        const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - began;
        outcome.compared_us_max = std::max(outcome.compared_us_max, took.count());
        for (SensorNumber i = 0; i < parts.mounted.size(); ++i) {
            const auto [node_id, sensor, zone] = parts.mounted[i].source;
            if (!outcome.flagged_s[i] && witness.evidence(node_id, sensor).contradicts())
                outcome.flagged_s[i] = at_s;
        }
    }
    for (const Mounted& sensor : parts.mounted)
        outcome.evidence.push_back(witness.evidence(sensor.source.node_id, sensor.source.sensor));
    return outcome;
}

}  // namespace octoskin::testing_support
