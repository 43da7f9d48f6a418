// The rigs and the robot that come with the house. Oracle for the 34 sensor poses: the rings' definition,
// evaluated here with plain trigonometry.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "common/config/node_config.hpp"
#include "hw/rigfile/can_load.hpp"
#include "hw/rigfile/i2c_load.hpp"
#include "hw/rigfile/phase_spread.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {
namespace {

const std::filesystem::path kRigs = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw" / "rigs";

Rig shipped(const std::string& name) {
    auto rig = read_rig(kRigs / name);
    EXPECT_TRUE(rig) << rig.error().message();
    return std::move(rig).value();
}

struct Ring {
    int sensors;
    double tilt_deg;
    double z_m;
    double phase_steps;
};
constexpr std::array<Ring, 4> kRings = {Ring{8, -40.0, 0.01, 0.0}, Ring{9, -13.0, 0.03, 0.5},
                                        Ring{9, 13.0, 0.06, 0.0}, Ring{8, 40.0, 0.08, 0.5}};
constexpr double kRadiusM = 0.07;

TEST(ShippedRigs, experiment_has_the_34_sensor_poses_of_the_rings) {
    const Rig rig = shipped("experiment.yaml");
    std::vector<Sensor> sensors;
    for (const Node& node : rig.nodes)
        sensors.insert(sensors.end(), node.sensors.begin(), node.sensors.end());
    ASSERT_EQ(sensors.size(), 34U);
    std::size_t index = 0;
    for (const Ring& ring : kRings) {
        for (int k = 0; k < ring.sensors; ++k, ++index) {
            const double azimuth = 2.0 * std::numbers::pi * (k + ring.phase_steps) / ring.sensors;
            const double tilt = ring.tilt_deg * std::numbers::pi / 180.0;
            const Eigen::Vector3d outward(std::cos(azimuth), std::sin(azimuth), 0.0);
            const Eigen::Vector3d origin = kRadiusM * outward + ring.z_m * Eigen::Vector3d::UnitZ();
            const Eigen::Vector3d beam = std::cos(tilt) * outward + std::sin(tilt) * Eigen::Vector3d::UnitZ();
            const Eigen::Isometry3d& T_flange_sensor = sensors[index].T_link_sensor;
            EXPECT_LT((T_flange_sensor.translation() - origin).norm(), 1e-11) << sensors[index].name;
            EXPECT_LT((T_flange_sensor.linear().col(2) - beam).norm(), 1e-11) << sensors[index].name;
            EXPECT_EQ(sensors[index].link, "panda_link8");
        }
    }
}

TEST(ShippedRigs, experiment_has_two_boards_of_17_sensors_on_buses_of_5_4_4_4) {
    const Rig rig = shipped("experiment.yaml");
    ASSERT_EQ(rig.nodes.size(), 2U);
    for (std::size_t n = 0; n < 2; ++n) {
        const NodeConfig& config = rig.nodes[n].config;
        EXPECT_EQ(config.node_id, n + 1);
        EXPECT_EQ(config.sensor_count, 17);
        std::array<int, 4> on_bus{};
        for (std::size_t i = 0; i < config.sensor_count; ++i) {
            const SensorConfig& sensor = config.sensors[i];
            ++on_bus[sensor.bus];
            EXPECT_EQ(sensor.distance_mode, DistanceMode::long_range);
            EXPECT_EQ(sensor.timing_budget_ms, 20);
            EXPECT_EQ(sensor.inter_measurement_ms, 33);
        }
        EXPECT_EQ(on_bus, (std::array<int, 4>{5, 4, 4, 4}));
    }
}

TEST(ShippedRigs, experiment_spreads_the_phases_of_each_bus_over_the_period) {
    const Rig rig = shipped("experiment.yaml");
    for (const Node& node : rig.nodes) {
        for (int bus = 0; bus < 4; ++bus) {
            std::set<int> phases_us;
            for (std::size_t i = 0; i < node.config.sensor_count; ++i) {
                if (node.config.sensors[i].bus == bus) phases_us.insert(node.config.sensors[i].phase_us);
            }
            int previous_us = *phases_us.rbegin() - 33'000;
            for (const int phase_us : phases_us) {
                EXPECT_GE(phase_us - previous_us, 6600 - 1) << node.name << " bus " << bus;
                previous_us = phase_us;
            }
        }
    }
}

TEST(ShippedRigs, experiment_has_the_bus_camera_joints_and_limits_of_the_experiment) {
    const Rig rig = shipped("experiment.yaml");
    EXPECT_TRUE(rig.bus.uses_can_fd);
    EXPECT_EQ(rig.bus.nominal_bitrate, 1'000'000U);
    EXPECT_EQ(rig.bus.data_bitrate, 5'000'000U);
    EXPECT_EQ(rig.joint_sources.at(0).node_id, 3);
    EXPECT_EQ(rig.joint_sources.at(0).rate_hz, 100.0);
    EXPECT_EQ(rig.joint_names().size(), 7U);
    ASSERT_EQ(rig.cameras.size(), 1U);
    EXPECT_EQ(rig.cameras.front().width, 512U);
    EXPECT_EQ(rig.cameras.front().height, 424U);
    EXPECT_EQ(rig.cameras.front().fx, 365.0);
    EXPECT_EQ(rig.cameras.front().fy, 365.0);
    EXPECT_EQ(rig.cameras.front().cx, 256.0);
    EXPECT_EQ(rig.cameras.front().cy, 212.0);
    EXPECT_EQ(rig.cameras.front().rate_hz, 10.0);
    EXPECT_EQ(rig.range_limits.min_m, 0.04);
    EXPECT_EQ(rig.range_limits.max_m, 4.0);
    EXPECT_TRUE(rig.T_map_base.isApprox(Eigen::Isometry3d::Identity(), 0.0));
    EXPECT_EQ(rig.links_ignored_by_sensors, (std::vector<std::string>{"panda_link7", "panda_link8"}));
}

TEST(ShippedRigs, camera_looks_at_its_point_with_the_picture_upright) {
    for (const auto& [name, height_m] :
         {std::pair{"experiment.yaml", 1.8}, std::pair{"experiment_low_camera.yaml", 0.6}}) {
        const Rig rig = shipped(name);
        const Eigen::Isometry3d& T_base_camera = rig.cameras.front().T_link_camera;
        EXPECT_TRUE(T_base_camera.translation().isApprox(Eigen::Vector3d(2.7, 0.0, height_m))) << name;
        const Eigen::Vector3d p_camera_target = T_base_camera.inverse() * Eigen::Vector3d(0.4, 0.0, 0.45);
        EXPECT_NEAR(p_camera_target.x(), 0.0, 1e-12) << name;
        EXPECT_NEAR(p_camera_target.y(), 0.0, 1e-12) << name;
        EXPECT_GT(p_camera_target.z(), 2.0) << name;
        // Seen from +x, the world's +y is on the right and its +z up, which is -y of the picture.
        EXPECT_TRUE(T_base_camera.linear().col(0).isApprox(Eigen::Vector3d::UnitY())) << name;
        EXPECT_LT(T_base_camera.linear().col(1).z(), -0.8) << name;
        EXPECT_NEAR(T_base_camera.linear().determinant(), 1.0, 1e-12) << name;
    }
}

TEST(ShippedRigs, classical_twin_differs_in_its_bus_only) {
    const Rig fd = shipped("experiment.yaml");
    Rig classical = shipped("experiment_classical.yaml");
    EXPECT_FALSE(classical.bus.uses_can_fd);
    classical.name = fd.name;
    classical.bus = fd.bus;
    for (Node& node : classical.nodes) node.config.uses_can_fd = true;
    EXPECT_EQ(canonical_text(classical, "robot.urdf"), canonical_text(fd, "robot.urdf"));
}

TEST(ShippedRigs, bench_rig_has_four_sensors_on_one_board) {
    const Rig rig = shipped("bench_one_board.yaml");
    ASSERT_EQ(rig.nodes.size(), 1U);
    EXPECT_EQ(rig.nodes[0].sensors.size(), 4U);
    EXPECT_TRUE(rig.cameras.empty());
    EXPECT_EQ(rig.nodes[0].config.sensors[3].inter_measurement_ms, 20);
}

// What tests/board/image_test.cpp holds the image to.
TEST(ShippedRigs, one_board_17_is_a_full_board_at_50_hz) {
    const Rig rig = shipped("one_board_17.yaml");
    ASSERT_EQ(rig.nodes.size(), 1U);
    const NodeConfig& config = rig.nodes[0].config;
    EXPECT_EQ(rig.nodes[0].board.name, "nucleo_g474re");
    ASSERT_EQ(config.sensor_count, 17);
    std::array<int, 4> on_bus{};
    std::set<int> lines;
    std::set<int> addresses;
    for (std::size_t i = 0; i < config.sensor_count; ++i) {
        const SensorConfig& sensor = config.sensors[i];
        ++on_bus[sensor.bus];
        lines.insert(sensor.xshut_line);
        addresses.insert(sensor.address);
        EXPECT_EQ(sensor.distance_mode, DistanceMode::short_range);
        EXPECT_EQ(sensor.timing_budget_ms, 15);
        EXPECT_EQ(sensor.inter_measurement_ms, 20);
    }
    EXPECT_EQ(on_bus, (std::array<int, 4>{5, 4, 4, 4}));
    EXPECT_EQ(lines.size(), 17U);
    EXPECT_EQ(addresses.size(), 17U);
    EXPECT_NEAR(i2c_load(config, 0), 518.0 * 5 * 50.0 / 283'000.0, 1e-12);
    EXPECT_NEAR(can_load(rig), 0.352, 0.001);
    // The rings are those of the experiment's second board.
    const Rig experiment = shipped("experiment.yaml");
    for (std::size_t i = 0; i < 17; ++i) {
        EXPECT_TRUE(rig.nodes[0].sensors[i].T_link_sensor.isApprox(
            experiment.nodes[1].sensors[i].T_link_sensor, 1e-11))
            << i;
    }
}

TEST(ShippedRigs, i2c_load_equals_the_count_of_bits) {
    // 518 bits a reading, 5 sensors, 1000 / 33 readings a second, 283 kbit/s.
    const Rig rig = shipped("experiment.yaml");
    EXPECT_NEAR(i2c_load(rig.nodes[0].config, 0), 518.0 * 5 * (1000.0 / 33.0) / 283'000.0, 1e-12);
    EXPECT_NEAR(i2c_load(rig.nodes[0].config, 1), 518.0 * 4 * (1000.0 / 33.0) / 283'000.0, 1e-12);
}

/// cupboard_zones.yaml is not among them: it keeps the phases that are made for a period of 40 ms.
TEST(ShippedRigs, sensors_take_turns_on_every_bus_and_in_the_light) {
    for (const char* name : {"experiment.yaml", "experiment_classical.yaml", "experiment_low_camera.yaml",
                             "experiment_eye_in_hand.yaml", "bench_one_board.yaml", "one_board_17.yaml",
                             "cell.yaml", "cupboard.yaml", "experiment_cone.yaml", "cell_cone.yaml",
                             "cupboard_cone.yaml", "experiment_zones.yaml", "cell_zones.yaml"}) {
        const Rig rig = shipped(name);
        for (const Node& node : rig.nodes) {
            for (std::uint8_t bus = 0; bus < node.board.i2c_bus_count; ++bus) {
                const PhaseSpread spread = phase_spread(node.config, bus);
                EXPECT_TRUE(spread.is_even()) << name << ' ' << node.name << ' ' << int{bus} << ": "
                                              << spread.peak << " of " << spread.mean;
            }
            for (const auto& [first, second] : pairs_ranging_together(node)) {
                ADD_FAILURE() << name << ": " << node.sensors[first].name << " and "
                              << node.sensors[second].name;
            }
        }
    }
}

TEST(ShippedRigs, can_load_stays_far_below_the_limit) {
    EXPECT_NEAR(can_load(shipped("experiment.yaml")), 0.149, 0.001);
    EXPECT_NEAR(can_load(shipped("experiment_classical.yaml")), 0.205, 0.001);
}

TEST(ShippedRigs, can_load_of_34_sensors_at_half_a_megabit_equals_the_count_of_frames) {
    // Frames of 8 bytes take 135 bits at worst: readings, 100 Hz x 4 joint frames, 3 heartbeats at 10 Hz, and
    // each second 34 health frames, 3 x 7 pages, SYNC, FOLLOW_UP and 3 reports, of which SYNC alone is
    // shorter.
    Rig rig = shipped("experiment_classical.yaml");
    rig.bus.nominal_bitrate = 500'000;
    const double frames = 34 * (1000.0 / 33.0) + 400 + 30 + 34 + 21 + 5;
    EXPECT_NEAR(can_load(rig), frames * 135 / 500'000, 0.0005);
    for (Node& node : rig.nodes) node.config.aux_every = 2;
    EXPECT_NEAR(can_load(rig), (frames + 17 * (1000.0 / 33.0)) * 135 / 500'000, 0.0005);
}

TEST(ShippedRigs, blocks_of_all_nodes_compile_and_read_back) {
    for (const auto& entry : std::filesystem::directory_iterator(kRigs)) {
        if (entry.path().extension() != ".yaml") continue;
        for (const Node& node : shipped(entry.path().filename().string()).nodes) {
            std::array<std::uint8_t, kNodeConfigBytesMax> block{};
            const auto decoded = decode_node_config(encode(node.config, block));
            ASSERT_TRUE(decoded) << entry.path() << " " << node.name;
            EXPECT_EQ(*decoded, node.config) << entry.path() << " " << node.name;
        }
    }
}

}  // namespace
}  // namespace octoskin::rig
