#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/range_status.hpp"
#include "host/io/mapfile/octomap_writer.hpp"

namespace octoskin::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// At `x_m` on the arm, looking along the arm's +x or -x.
Eigen::Isometry3d T_arm_sensor(double x_m, bool looks_outward) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = x_m;
    T.linear().col(0) = Eigen::Vector3d::UnitY();
    T.linear().col(1) = looks_outward ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(0, 0, -1);
    T.linear().col(2) = looks_outward ? Eigen::Vector3d(1, 0, 0) : Eigen::Vector3d(-1, 0, 0);
    return T;
}

HostSensor sensor(const std::string& name, const Eigen::Isometry3d& T_link_sensor) {
    HostSensor sensor;
    sensor.name = name;
    sensor.link = "arm";
    sensor.T_link_sensor = T_link_sensor;
    return sensor;
}

HostNode node(wire::NodeId id, std::vector<HostSensor> sensors) {
    return {.node_id = id,
            .name = "node " + std::to_string(id),
            .node_hash = 0xC0FFEE00U + id,
            .pinned_build_id = {},
            .sensors = std::move(sensors)};
}

HostCamera camera() {
    HostCamera camera;
    camera.intrinsics = {.width = 16, .height = 12, .fx = 20.0, .fy = 20.0, .cx = 8.0, .cy = 6.0};
    // At (2, 0, 0.5), looking along -x; the image's right is +y.
    camera.T_link_camera.translation() = Eigen::Vector3d(2.0, 0.0, 0.5);
    camera.T_link_camera.linear() << 0, 0, -1, 1, 0, 0, 0, -1, 0;
    return camera;
}

}  // namespace

HostRig one_joint_rig() {
    HostRig rig;
    rig.name = "one joint";
    rig.T_map_base.translation() = Eigen::Vector3d(0.02, 0.02, 0.02);
    const HostSensor good = sensor("good", T_arm_sensor(0.12, true));
    HostSensor lost_pose = good;
    lost_pose.T_link_sensor.translation().x() = kNaN;
    HostSensor far = good;
    far.T_link_sensor.translation().x() = 2000.0;
    HostSensor no_offset = good;
    no_offset.zones[0].offset_m = kNaN;
    rig.nodes = {
        node(kLeft, {good, sensor("inward", T_arm_sensor(0.12, false)), lost_pose, far, no_offset, good}),
        node(kRight, {good}), node(kThird, {good})};
    rig.nodes[1].pinned_build_id = 77;
    rig.joint_sources = {{.node_id = kJoints, .joints = {"shoulder"}, .rate_hz = 100.0}};
    rig.cameras = {camera()};
    rig.body = {{"base", {0, 0, -0.5}, {0, 0, 0.5}, 0.05}, {"arm", {0.08, 0, 0}, {0.14, 0, 0}, 0.03}};
    rig.certain_body = rig.body;
    rig.links_ignored_by_sensors = {"arm"};
    return rig;
}

RobotModel one_joint_robot() {
    const std::vector<JointDescription> joints = {{.name = "shoulder",
                                                   .parent_link = "base",
                                                   .child_link = "arm",
                                                   .kind = JointKind::revolute,
                                                   .T_parent_joint = Eigen::Isometry3d::Identity(),
                                                   .axis = Eigen::Vector3d::UnitZ(),
                                                   .limits = {-3.2, 3.2, 8.0}}};
    const std::vector<std::string> moved = {"shoulder"};
    return RobotModel::build("base", joints, moved).value();
}

double angle_at(double t_s) {
    return M_PI / 2.0 + 8.0 * std::clamp(t_s - 3.505, -0.1, 0.1);
}

MappingConfig plain_mapping() {
    MappingConfig mapping = paper_mapping();
    mapping.map.resolution_m = 0.04;
    return mapping;
}

DepthFrame flat_frame(double captured_s, std::uint16_t depth_mm) {
    return {.captured = host_at(captured_s),
            .width = 16,
            .height = 12,
            .depth_mm = std::vector<std::uint16_t>(std::size_t{16} * 12, depth_mm)};
}

wire::RangeReading good_reading(std::uint8_t sensor) {
    return {.sensor = sensor,
            .zone = 0,
            .device_status = kDeviceStatusComplete,
            .sequence = 0,
            .range_mm = 520,
            .sigma_quarter_mm = 40,
            .capture = wire::classical_residue({})};
}

const HostNode& node_of(const Scene& scene, wire::NodeId id) {
    return *std::ranges::find(scene.rig.nodes, id, &HostNode::node_id);
}

void keep_alive(Scene& scene, wire::NodeId node, double from_s) {
    scene.bus.info(from_s + 0.01, node_of(scene, node));
    for (double t = from_s; t < 9.0; t += 0.1) {
        scene.bus.heartbeat(t, node_of(scene, node));
    }
    for (double t = from_s + 0.02; t < 9.0; t += 1.0) {
        for (std::uint8_t sensor = 0; sensor < node_of(scene, node).sensors.size(); ++sensor) {
            scene.bus.health(t, node, sensor);
        }
    }
}

Scene good_scene() {
    Scene scene;
    scene.bus.set_clock(kLeft, 0U - 5'000'000U, 80e-6);  // wraps after 5 s
    scene.bus.set_clock(kRight, 77, -40e-6);
    scene.bus.set_clock(kThird, 3'000'000'000U, 10e-6);
    scene.bus.set_clock(kJoints, 123'456'789, -60e-6);
    for (int k = 0; k <= 8; ++k) {
        scene.bus.exchange(0.1 + k, {kLeft, kRight, kJoints});
    }
    keep_alive(scene, kLeft);
    for (int k = 50; k <= 900; ++k) {
        if (k < 700 || k > 730) {
            const double position = angle_at(0.01 * k);
            scene.bus.joints(0.01 * k, kJoints, {&position, 1});
        }
    }
    for (int k = 0; k < 10; ++k) {
        wire::RangeReading reading = good_reading();
        reading.range_mm = static_cast<std::uint16_t>(520 + 100 * k);
        scene.bus.range(3.505 + 0.033 * k, kLeft, reading);
    }
    for (int k = 0; k < 6; ++k) {
        scene.depth.push_back(flat_frame(4.0 + 0.1 * k));
    }
    return scene;
}

Pipeline make_pipeline(const Scene& scene) {
    auto pipeline = Pipeline::build(scene.rig, one_joint_robot(), scene.mapping, scene.config);
    EXPECT_TRUE(pipeline.has_value());
    return std::move(pipeline).value();
}

RunResult run(const Scene& scene) {
    return run(scene, scene.bus.frames());
}

RunResult run(const Scene& scene, std::vector<StampedFrame> frames) {
    Pipeline pipeline = make_pipeline(scene);
    ScriptedSource can(std::move(frames));
    ScriptedDepth depth(scene.depth);
    const ReplayOutcome outcome = replay(pipeline, can, {&depth}, [&](const ReplayProgress&) {
        EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
    });
    EXPECT_TRUE(outcome.is_complete());
    return {.inputs = pipeline.inputs(),
            .depth_ot = encode_ot(pipeline.map(MapFeed::camera)),
            .proximity_ot = encode_ot(pipeline.map(MapFeed::ranges)),
            .fused_ot = encode_ot(pipeline.map()),
            .outcome = outcome,
            .inputs_text = pipeline.inputs_text()};
}

}  // namespace octoskin::test
