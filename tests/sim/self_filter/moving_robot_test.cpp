// The arm moves before the camera at 1 m/s, the joints' times are 20 ms off and the camera's pose is 2 cm
// off: the robot does not come into the map, and what is not near it stays.
//
// What the padding has to cover: 2 cm + 1 m/s * 20 ms = 4 cm between where a point of the arm is and where
// the host takes it to be, and what is left of the camera's noise after the depth filter. The experiment's
// rig pads by 9 cm.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "host/core/beams/beam_builder.hpp"
#include "host/core/kinematics/self_hit.hpp"
#include "host/core/pipeline/map_builder.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/camera/depth_camera.hpp"
#include "hw/sim/camera/sensor_scene.hpp"
#include "hw/sim/scenario/scenario.hpp"

namespace octoskin {
namespace {

const std::filesystem::path kHw = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw";
constexpr double kSpeed_mps = 1.0;
constexpr double kApart_m = 0.04;  ///< what is further from the padded arm has to stay
constexpr std::uint32_t kFramesBefore = 10;
constexpr std::uint32_t kFrames = 30;
constexpr std::int64_t kFramePeriod_us = 100'000;

using Voxels = std::set<VoxelKey>;

/// What the host does not know.
struct Injected {
    double joints_late_s = 0.0;  ///< their times are later than the truth by this
    Eigen::Vector3d camera_off_m = Eigen::Vector3d::Zero();
};

struct Outcome {
    std::size_t robot_voxels = 0;      ///< that were occupied after any frame
    std::size_t robot_frames_max = 0;  ///< how many frames one of them was occupied, one after the other
    std::size_t obstacles = 0;         ///< voxels that are further from the padded arm than kApart_m
    std::size_t obstacles_lost = 0;    ///< of those
};

class MovingRobot : public testing::Test {
  protected:
    MovingRobot()
        : rig_(rig::read_rig(kHw / "rigs/experiment.yaml").value()),
          arm_(sim::Arm::read(rig_.urdf, rig_.base_link, rig_.joint_names()).value()),
          capsules_(rig::real_body(rig_).value()),
          scenario_(sim::read_scenario(kHw / "worlds/experiment.scenario.yaml").value()),
          world_(sim::World::read(scenario_.world).value()),
          trajectory_(fast_circle()) {}

    /// The experiment's circle, faster: with a constant orientation every point of the hand moves at the
    /// speed.
    sim::Trajectory fast_circle() {
        sim::CircleMotion motion = scenario_.motion;
        motion.revolutions = 2;
        motion.tick_rate_hz =
            kSpeed_mps * motion.ticks_per_revolution / (2.0 * std::numbers::pi * motion.radius_m);
        return sim::Trajectory::circle(arm_, motion, sim::SimTime{kFramesBefore * kFramePeriod_us}).value();
    }

    [[nodiscard]] MapBuilder builder(const Injected& injected, double margin_m,
                                     const MappingConfig& mapping) const {
        HostSetup setup = make_host_setup(rig_).value();
        setup.rig.cameras.front().T_link_camera.pretranslate(injected.camera_off_m);
        setup.rig.depth_self_margin_m = margin_m;
        MapBuilder builder =
            MapBuilder::build(setup.rig, std::move(setup.robot), mapping, {}, {MapFeed::both}).value();
        const auto late_us = std::llround(1e6 * injected.joints_late_s);
        for (std::int64_t at_us = -200'000; at_us < (kFrames + 2) * kFramePeriod_us; at_us += 10'000) {
            const Eigen::VectorXd joints = trajectory_.at(sim::SimTime{std::max<std::int64_t>(0, at_us)});
            JointMeasurement sample{HostTime{kStart_ns + 1'000 * (at_us + late_us)}, {}};
            std::copy(joints.begin(), joints.end(), sample.position_rad.begin());
            EXPECT_TRUE(builder.add(sample));
        }
        return builder;
    }

    [[nodiscard]] std::vector<sim::BodyCapsule> body_at(std::uint32_t frame) const {
        return sim::posed_body(capsules_,
                               arm_.forward(trajectory_.at(sim::SimTime{frame * kFramePeriod_us})));
    }

    void integrate(MapBuilder& builder, const sim::DepthCamera& camera, std::uint32_t frame,
                   const std::vector<sim::BodyCapsule>& body) const {
        ASSERT_TRUE(builder.integrate(DepthFrame{HostTime{kStart_ns + 1'000 * frame * kFramePeriod_us},
                                                 rig_.cameras.front().width, rig_.cameras.front().height,
                                                 camera.render(body, frame)}));
    }

    static Voxels occupied(const MapBuilder& builder) {
        const FusedMap& map = builder.map();
        Voxels voxels;
        map.for_each_known([&](VoxelKey key, float log_odds) {
            if (map.occupancy_of(log_odds) == Occupancy::occupied) voxels.insert(key);
        });
        return voxels;
    }

    /// Whether one of the voxels, or of their neighbours, is this one.
    static bool is_beside(const Voxels& voxels, VoxelKey key) {
        for (int i = 0; i < 27; ++i) {
            const auto moved = [](std::uint16_t k, int by) { return static_cast<std::uint16_t>(k + by); };
            if (voxels.contains(
                    {moved(key.x, i % 3 - 1), moved(key.y, i / 3 % 3 - 1), moved(key.z, i / 9 - 1)}))
                return true;
        }
        return false;
    }

    /// Whether a surface of the world lies in the voxel about this point, along an axis from its middle.
    [[nodiscard]] bool is_of_world(const Eigen::Vector3d& p_base, double resolution_m) const {
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
            if (world_.cast(p_base, along, 0.5 * resolution_m) ||
                world_.cast(p_base, -along, 0.5 * resolution_m))
                return true;
        }
        return false;
    }

    /// In all frames so far.
    [[nodiscard]] double distance_to_arm(const Eigen::Vector3d& point) const {
        double nearest_m = std::numeric_limits<double>::infinity();
        for (const auto& [frame, body] : bodies_) {
            if (frame < kFramesBefore) continue;
            for (const sim::BodyCapsule& capsule : body) {
                nearest_m = std::min(
                    nearest_m,
                    distance_to_surface({capsule.p_base_a, capsule.p_base_b, capsule.radius_m, 0}, point));
            }
        }
        return nearest_m;
    }

    /// Two maps of the same frames, noise and errors: one of the world alone, the other of the arm in it from
    /// the eleventh frame on. What the second has more of is the robot, wherever it is, unless the world has
    /// a surface in it: of a panel seen at a grazing angle the arm may hide those rays that would clear it.
    /// What the second has less of, it lost.
    Outcome run(const Injected& injected, double margin_m, const MappingConfig& mapping, const char* what) {
        const sim::DepthCamera camera(world_, rig_.cameras.front(), scenario_.depth_noise, 1);
        MappingConfig without_filter = mapping;
        without_filter.removes_robot_from_depth = false;
        MapBuilder world = builder(injected, margin_m, without_filter);
        MapBuilder both = builder(injected, margin_m, mapping);
        const VoxelLattice lattice(mapping.map.resolution_m);
        bodies_.clear();
        Outcome outcome;
        std::map<VoxelKey, std::size_t> frames_occupied;
        Voxels robot_voxels;
        Voxels before;     ///< the arm came; it hides them
        Voxels obstacles;  ///< that noise alone never takes off the map
        for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
            bodies_[frame] = body_at(frame);
            integrate(world, camera, frame, {});
            if (frame + 1 == kFramesBefore) {
                both.begin_with(world.map().copy());
                before = occupied(world);
                obstacles = before;
            }
            if (frame < kFramesBefore) continue;
            integrate(both, camera, frame, bodies_.at(frame));
            const Voxels of_world = occupied(world);
            std::erase_if(obstacles, [&](VoxelKey key) { return !of_world.contains(key); });
            std::map<VoxelKey, std::size_t> now_occupied;
            for (const VoxelKey key : occupied(both)) {
                if (is_beside(of_world, key) || before.contains(key)) continue;
                const Eigen::Vector3d p_base = lattice.centre_of(key) - injected.camera_off_m;
                if (is_of_world(p_base, mapping.map.resolution_m)) continue;
                robot_voxels.insert(key);
                now_occupied[key] = frames_occupied[key] + 1;
                outcome.robot_frames_max = std::max(outcome.robot_frames_max, now_occupied[key]);
            }
            frames_occupied = std::move(now_occupied);
        }
        outcome.robot_voxels = robot_voxels.size();
        const Voxels left = occupied(both);
        for (const VoxelKey key : obstacles) {
            // The map is where the host takes the camera to be.
            const Eigen::Vector3d p_base = lattice.centre_of(key) - injected.camera_off_m;
            if (distance_to_arm(p_base) <= margin_m + kApart_m) continue;
            ++outcome.obstacles;
            outcome.obstacles_lost += left.contains(key) ? 0U : 1U;
        }
        std::printf("%s: %zu robot voxels, for %zu frames at most; %zu of %zu obstacle voxels lost\n", what,
                    outcome.robot_voxels, outcome.robot_frames_max, outcome.obstacles_lost,
                    outcome.obstacles);
        return outcome;
    }

    static constexpr std::int64_t kStart_ns = 1'000'000'000;
    rig::Rig rig_;
    sim::Arm arm_;
    std::vector<rig::Capsule> capsules_;
    sim::Scenario scenario_;
    sim::World world_;
    sim::Trajectory trajectory_;
    std::map<std::uint32_t, std::vector<sim::BodyCapsule>> bodies_;
};

TEST_F(MovingRobot, is_not_in_the_map_and_obstacles_stay) {
    const Injected cases[] = {
        {.joints_late_s = 0.02, .camera_off_m = {0.0, 0.02, 0.0}},
        {.joints_late_s = -0.02, .camera_off_m = {0.0, -0.02, 0.0}},
        {.joints_late_s = 0.02, .camera_off_m = {0.02, 0.0, 0.0}},
        {.joints_late_s = -0.02, .camera_off_m = {0.0, 0.0, 0.02}},
    };
    for (const Injected& injected : cases) {
        const Outcome outcome = run(injected, rig_.depth_self_margin_m, fast_mapping(), "fast, errors");
        EXPECT_LE(outcome.robot_frames_max, 1U);
        EXPECT_GT(outcome.obstacles, 100U);
        // A voxel of the floor, seen at a grazing angle, of whose rays the arm's outline hides those that
        // mark it.
        EXPECT_LE(outcome.obstacles_lost * 1'000, outcome.obstacles);
    }
}

TEST_F(MovingRobot, is_in_the_map_if_the_padding_covers_less_than_the_errors) {
    const Outcome outcome = run({.joints_late_s = 0.02, .camera_off_m = {0.0, 0.02, 0.0}}, 0.0,
                                fast_mapping(), "fast, no padding");
    EXPECT_GT(outcome.robot_frames_max, 1U) << "the test sees no robot where there is one";
}

struct RangeOutcome {
    std::size_t of_robot = 0;  ///< ranges that are others than if there were no robot
    std::size_t of_robot_used = 0;
    std::size_t of_world = 0;
    std::size_t of_world_dropped = 0;
};

/// Every sensor of a rig, 30 times a second while the arm moves.
RangeOutcome ranges_of(const std::filesystem::path& rig_file, const sim::Arm& arm, const sim::Body& true_body,
                       const sim::World& world, const sim::Scenario& scenario,
                       const sim::Trajectory& trajectory, double late_s, double padding_m) {
    constexpr double kSame_m = 0.05;
    const sim::Body no_robot({});
    rig::Rig rig = rig::read_rig(rig_file).value();
    // Across the beam only padding helps: the margin is one along it.
    for (const std::string& link : arm.links()) rig.link_padding_m[link] = padding_m;
    HostSetup setup = make_host_setup(rig).value();
    const BeamBuilder beams =
        BeamBuilder::build(setup.rig, setup.robot,
                           {.removes_robot = true, .no_return_clear_m = 0.0, .sees_cones = true})
            .value();
    const RobotBody body = RobotBody::build(setup.rig.body, setup.robot).value();
    RobotPose pose;
    pose.T_base_link.resize(setup.robot.link_count());
    RangeOutcome outcome;
    std::uint32_t noise_id = 0;
    for (const rig::Node& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i, ++noise_id) {
            const rig::Sensor& sensor = node.sensors[i];
            const sim::SensorMount mount{sensor.link, sensor.T_link_sensor, noise_id, sensor.cone};
            const auto scene = [&](const sim::Body& robot) {
                return sim::ranging_scene(
                    {world, arm, trajectory, robot, rig.links_ignored_by_sensors, scenario.ranges, 1}, mount);
            };
            const auto with = scene(true_body);
            const auto without = scene(no_robot);
            for (std::uint32_t index = 0; index < 100; ++index) {
                const sim::SimTime time{trajectory.start().us + 33'333 * index};
                const auto range_m = with(index, time, Roi{}).range_m;
                if (!range_m) continue;
                const auto world_m = without(index, time, Roi{}).range_m;
                const bool is_world = world_m && std::abs(*world_m - *range_m) < kSame_m;
                const Eigen::VectorXd joints =
                    trajectory.at(sim::SimTime{time.us - std::llround(1e6 * late_s)});
                setup.robot.forward(std::span(joints.data(), static_cast<std::size_t>(joints.size())),
                                    pose.T_base_link);
                body.pose(pose.T_base_link, pose.body_base);
                const bool is_used = beams
                                         .place({{node.config.node_id, static_cast<std::uint8_t>(i), 0},
                                                 HostTime{},
                                                 *range_m,
                                                 0.01},
                                                pose)
                                         .has_value();
                (is_world ? outcome.of_world : outcome.of_robot) += 1;
                if (!is_world && is_used) ++outcome.of_robot_used;
                if (is_world && !is_used) ++outcome.of_world_dropped;
            }
        }
    }
    return outcome;
}

TEST_F(MovingRobot, ranges_of_it_are_dropped_and_those_of_the_world_are_used) {
    for (const char* file : {"rigs/experiment.yaml", "rigs/experiment_cone.yaml"}) {
        for (const double late_s : {0.02, -0.02}) {
            const RangeOutcome outcome = ranges_of(kHw / file, arm_, sim::Body(capsules_), world_, scenario_,
                                                   trajectory_, late_s, 0.04);
            std::printf("%s, %+.2f s: %zu of %zu ranges of the robot used, %zu of %zu of the world dropped\n",
                        file, late_s, outcome.of_robot_used, outcome.of_robot, outcome.of_world_dropped,
                        outcome.of_world);
            EXPECT_GT(outcome.of_robot, 100U);
            EXPECT_LE(outcome.of_robot_used * 100, outcome.of_robot) << file;
            EXPECT_LE(outcome.of_world_dropped * 25, outcome.of_world) << file;
        }
    }
}

}  // namespace
}  // namespace octoskin
