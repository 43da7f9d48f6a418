#include "tests/sim/cross_check/recorded_arm.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "common/lens/lens_distortion.hpp"
#include "host/core/beams/beam_builder.hpp"
#include "host/core/cross_check/certain_pixels.hpp"
#include "host/core/depth/depth_filter.hpp"
#include "host/core/depth/depth_image.hpp"
#include "host/core/depth/pixel_rays.hpp"
#include "host/core/pipeline/robot_tracker.hpp"
#include "host/core/self_filter/robot_filter.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/camera/depth_camera.hpp"
#include "hw/sim/camera/sensor_scene.hpp"
#include "hw/sim/noise/noise.hpp"

namespace octoskin::testing_support {
namespace {

const std::filesystem::path kHw = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw";
/// The camera filter's deviation, of what comes in and, about, of what goes out.
constexpr double kCameraSigmaM = 0.03;
constexpr double kFilteredSigmaM = 0.015;
/// What a sensor ranges while another does is not of one instant.
constexpr std::int64_t kStaggerUs = 900;
/// The device's own limit: a weaker signal is no target.
constexpr double kSignalMinMcps = 1.0;

/// What a fixture needs must be there.
template <class T>
auto needed(T result) {
    if (!result) std::abort();
    return std::move(*result);
}

/// z towards what it looks at, x level.
Eigen::Isometry3d looking(const Eigen::Vector3d& from, const Eigen::Vector3d& at) {
    Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d ahead = (at - from).normalized();
    const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ()).normalized();
    T_base_camera.linear() << right, ahead.cross(right), ahead;
    T_base_camera.translation() = from;
    return T_base_camera;
}

/// With the true camera.
rig::Rig read_rig_of(const std::string& name, std::uint32_t pixel_divisor, const KeptChoice& choice) {
    rig::Rig rig = needed(rig::read_rig(kHw / "rigs" / name));
    if (choice.camera_at_m)
        rig.cameras.front().T_link_camera = looking((*choice.camera_at_m)[0], (*choice.camera_at_m)[1]);
    rig::Camera& camera = rig.cameras.front();
    camera.width /= pixel_divisor;
    camera.height /= pixel_divisor;
    for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value /= pixel_divisor;
    return rig;
}

sim::Trajectory revolutions_of(const sim::Arm& arm, sim::Scenario& scenario, std::uint32_t revolutions) {
    scenario.motion.revolutions = revolutions;
    return needed(sim::Trajectory::circle(arm, scenario.motion, sim::SimTime{0}));
}

/// The world, the arm and the camera, which all rigs share.
struct Stage {
    Stage(const rig::Rig& rig, const KeptChoice& choice)
        : arm(needed(sim::Arm::read(rig.urdf, rig.base_link, rig.joint_names()))),
          body(needed(rig::read_capsules(rig.urdf, {}))),
          scenario(needed(sim::read_scenario(kHw / ".." / choice.scenario))),
          world(needed(sim::World::read(scenario.world))),
          trajectory(revolutions_of(arm, scenario, choice.revolutions)),
          camera(world, rig.cameras.front(), scenario.depth_noise, choice.seed) {}

    sim::Arm arm;
    sim::Body body;
    sim::Scenario scenario;
    sim::World world;
    sim::Trajectory trajectory;
    sim::DepthCamera camera;
};

struct Sensor {
    BeamSource source;
    std::string link;
    Eigen::Isometry3d T_link_sensor;
    std::vector<Roi> zones;
    sim::Noise noise;  ///< of its ranges, as its scenes have it
    sim::RangingScene scene;
    std::array<sim::RangingScene, kTurns> turned;
    std::vector<RangePredictor> predictors;  ///< by zone
};

/// About the sensor's position, as RangePredictor turns the axis of the whole array.
Eigen::Isometry3d turned_mount(const Eigen::Isometry3d& T_link_sensor, std::size_t turn) {
    const double towards = 2.0 * std::numbers::pi * static_cast<double>(turn) / kTurns;
    const Eigen::Vector3d about(-std::sin(towards), std::cos(towards), 0.0);
    return T_link_sensor * Eigen::AngleAxisd(kTurnDeg * std::numbers::pi / 180.0, about);
}

/// Where a rig has a camera that is off.
Eigen::Isometry3d reported(const Eigen::Isometry3d& T_base_camera, const CameraError& error) {
    Eigen::Isometry3d T_given_true = Eigen::Isometry3d::Identity();
    const double turn_rad = error.turn_deg.norm() * std::numbers::pi / 180.0;
    if (turn_rad > 0.0)
        T_given_true.linear() = Eigen::AngleAxisd(turn_rad, error.turn_deg.normalized()).toRotationMatrix();
    T_given_true.translation() = error.shift_m;
    return T_base_camera * T_given_true.inverse();
}

class Rig {
  public:
    Rig(const rig::Rig& rig, const Stage& stage, const KeptChoice& choice)
        : setup_(needed(make_host_setup(rig))),
          beams_(needed(BeamBuilder::build(setup_.rig, setup_.robot, {.sees_cones = true}))),
          tracker_(needed(RobotTracker::build(setup_.rig, std::move(setup_.robot), {}))),
          has_turned_(choice.has_turned),
          has_predictions_(choice.has_predictions),
          joint_offset_rad_(choice.joint_offset_rad) {
        run.rig = setup_.rig;
        run.rig.cameras.front().T_link_camera =
            reported(setup_.rig.cameras.front().T_link_camera, choice.camera_error);
        std::uint32_t noise_id = 0;
        const auto scene_of = [&](const rig::Sensor& sensor, const Eigen::Isometry3d& T_link_sensor) {
            return sim::ranging_scene({stage.world, stage.arm, stage.trajectory, stage.body,
                                       rig.links_ignored_by_sensors, stage.scenario.ranges, choice.seed},
                                      {sensor.link, T_link_sensor, noise_id, sensor.cone});
        };
        for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
            const rig::Node& node = rig.nodes[n];
            for (std::size_t i = 0; i < node.sensors.size(); ++i, ++noise_id) {
                const rig::Sensor& sensor = node.sensors[i];
                Sensor kept{.source = {node.config.node_id, static_cast<std::uint8_t>(i), 0},
                            .link = sensor.link,
                            .T_link_sensor = sensor.T_link_sensor,
                            .zones = {},
                            .noise = sim::Noise(choice.seed, sim::NoiseSource::range).of(noise_id),
                            .scene = scene_of(sensor, sensor.T_link_sensor),
                            .turned = {},
                            .predictors = {}};
                for (std::size_t turn = 0; turn < kTurns && has_turned_; ++turn)
                    kept.turned[turn] = scene_of(sensor, turned_mount(sensor.T_link_sensor, turn));
                const SensorConfig& config = node.config.sensors[i];
                const auto& zones = setup_.rig.nodes[n].sensors[i].zones;
                for (std::size_t zone = 0; zone < zones.size(); ++zone) {
                    kept.zones.push_back(config.zones[zone]);
                    kept.predictors.emplace_back(zones[zone].direction_sensor, zones[zone].optics,
                                                 PredictorConfig{.camera_sigma_m = kFilteredSigmaM});
                }
                run.sources.push_back(kept.source);
                sensors_.push_back(std::move(kept));
            }
        }
    }

    [[nodiscard]] const HostRig& host() const { return run.rig; }
    [[nodiscard]] RobotPose robot_at(const Stage& stage, std::int64_t us) {
        add(stage, us);
        return *tracker_.at(HostTime{1'000 * us});
    }

    void keep(const Stage& stage, const CameraView& view, std::uint32_t image, std::int64_t image_us) {
        std::vector<KeptReading>& readings = run.images.emplace_back();
        for (SensorNumber i = 0; i < sensors_.size(); ++i) {
            const auto us = image_us + static_cast<std::int64_t>(i + 1) * kStaggerUs;
            const RobotPose robot = robot_at(stage, us);
            readings.push_back(reading_of(sensors_[i], view, robot, image, us));
        }
    }

    KeptRun run;

  private:
    void add(const Stage& stage, std::int64_t us) {
        const Eigen::VectorXd joints = stage.trajectory.at(sim::SimTime{us});
        JointMeasurement sample{HostTime{1'000 * us}, {}};
        std::copy(joints.begin(), joints.end(), sample.position_rad.begin());
        for (std::size_t i = 0; i < kJointsMax; ++i) sample.position_rad[i] -= joint_offset_rad_[i];
        if (!tracker_.add(sample)) std::abort();
    }

    KeptReading reading_of(const Sensor& sensor, const CameraView& view, const RobotPose& robot,
                           std::uint32_t image, std::int64_t us) {
        const std::size_t zone = image % sensor.zones.size();
        BeamSource source = sensor.source;
        source.zone = static_cast<std::uint8_t>(zone);
        KeptReading kept;
        kept.beam.source = source;
        kept.beam.captured = HostTime{1'000 * us};
        const auto ranged = [&](const sim::RangingScene& scene) -> std::optional<KeptRange> {
            const auto seen = scene(image, sim::SimTime{us}, sensor.zones[zone]);
            const HostRangeLimits& limits = host().range_limits;
            if (!seen.range_m || seen.peak_signal_mcps < kSignalMinMcps || *seen.range_m < limits.min_m ||
                *seen.range_m > limits.max_m || seen.sigma_m > limits.sigma_max_m ||
                !beams_.place({source, kept.beam.captured, seen.range_m, seen.sigma_m}, robot))
                return std::nullopt;
            kept.beam.sigma_m = std::max(kept.beam.sigma_m, seen.sigma_m);
            return KeptRange{*seen.range_m, seen.sigma_m * sensor.noise.gaussian(image)};
        };
        kept.sound = ranged(sensor.scene);
        for (std::size_t turn = 0; turn < kTurns && has_turned_; ++turn)
            kept.turned[turn] = ranged(sensor.turned[turn]);
        const Eigen::Isometry3d T_map_sensor = beams_.T_map_sensor(source, robot);
        kept.beam.p_map_sensor = T_map_sensor.translation();
        kept.beam.direction_map =
            T_map_sensor.linear() *
            host().nodes[source.node_id - 1U].sensors[source.sensor].zones[zone].direction_sensor;
        kept.T_map_sensor = T_map_sensor;
        kept.twists_map = beams_.twists_map(source, robot, tracker_.robot());
        if (!has_predictions_) return kept;
        const auto began = std::chrono::steady_clock::now();
        kept.predictions = sensor.predictors[zone].predict(view, T_map_sensor);
        const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - began;
        run.predicted_us_max = std::max(run.predicted_us_max, took.count());
        run.predicted_us_mean += (took.count() - run.predicted_us_mean) / ++predicted_;
        return kept;
    }

    HostSetup setup_;
    BeamBuilder beams_;
    RobotTracker tracker_;
    bool has_turned_;
    bool has_predictions_;
    JointPositions joint_offset_rad_;
    std::vector<Sensor> sensors_;
    double predicted_ = 0.0;
};

}  // namespace

CameraView KeptCamera::view(std::size_t image) const {
    const SeenImages& seen = images[image];
    return CameraView({seen.everything, seen.world, seen.certainty}, intrinsics, T_map_camera, ray_slope_max);
}

std::vector<KeptRun> keep_runs(const std::vector<std::string>& names, std::uint32_t pixel_divisor,
                               const KeptChoice& choice) {
    const Stage stage(read_rig_of(names.at(0), pixel_divisor, choice), choice);
    std::vector<std::unique_ptr<Rig>> rigs;
    for (const std::string& name : names)
        rigs.push_back(std::make_unique<Rig>(read_rig_of(name, pixel_divisor, choice), stage, choice));
    const HostRig& host = rigs.front()->host();
    const auto camera = std::make_shared<KeptCamera>();
    camera->intrinsics = host.cameras.front().intrinsics;
    camera->ray_slope_max = LensInverse(host.cameras.front().intrinsics.lens).radius();
    camera->T_map_camera = host.T_map_base * host.cameras.front().T_link_camera;
    const PixelRays pixel_rays(camera->intrinsics);
    const Eigen::Isometry3d T_camera_base = host.cameras.front().T_link_camera.inverse();
    const bool is_full = pixel_divisor == 1;
    DepthFilter filter({.is_enabled = true,
                        .window = is_full ? 5U : 3U,
                        .sigma_m = kCameraSigmaM,
                        .min_support = is_full ? 5U : 3U});
    CertainPixels certain(camera->intrinsics, {.camera_sigma_m = kCameraSigmaM});
    const auto images = static_cast<std::uint32_t>(100 * choice.revolutions);
    for (std::uint32_t image = 0; image < images; ++image) {
        const std::int64_t us = 100'000LL * image;
        const RobotPose robot = rigs.front()->robot_at(stage, us);
        DepthImage world = needed(to_depth_image(
            {HostTime{1'000 * us}, camera->intrinsics.width, camera->intrinsics.height,
             stage.camera.render(stage.body.at(stage.arm.forward(stage.trajectory.at(sim::SimTime{us}))),
                                 image)},
            {host.cameras.front().depth_min_m, host.cameras.front().depth_max_m}));
        for (float& depth_m : world.depth_m) depth_m /= static_cast<float>(choice.camera_error.depth_scale);
        SeenImages& seen = camera->images.emplace_back();
        const DepthImage raw = world;
        filter.filter(world);
        std::vector<PosedCapsule> body_camera = robot.body_base;
        for (PosedCapsule& capsule : body_camera) {
            capsule.p_a = T_camera_base * capsule.p_a;
            capsule.p_b = T_camera_base * capsule.p_b;
        }
        certain.find(raw, world, seen.certainty);
        seen.everything = world;
        remove_robot(world, pixel_rays, body_camera, host.depth_self_margin_m);
        seen.world = std::move(world);
        for (const auto& rig : rigs) rig->keep(stage, camera->view(image), image, us);
    }
    std::vector<KeptRun> runs;
    for (const auto& rig : rigs) {
        rig->run.camera = camera;
        runs.push_back(std::move(rig->run));
    }
    return runs;
}

}  // namespace octoskin::testing_support
