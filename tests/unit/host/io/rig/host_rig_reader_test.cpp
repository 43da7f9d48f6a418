// From the shipped rig file to the host's view of it.
#include "host/io/rig/host_rig_reader.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/config/node_config.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

const std::filesystem::path kSource = OCTOSKIN_SOURCE_DIR;

rig::Rig experiment() {
    auto rig = rig::read_rig(kSource / "hw/rigs/experiment.yaml");
    EXPECT_TRUE(rig) << rig.error().message();
    return std::move(rig).value();
}

TEST(HostRigReader, takes_over_everything_the_host_needs) {
    rig::Rig rig = experiment();
    rig.nodes[1].pinned_build_id = 0x1234ABCD;
    rig.T_map_base.translation() << 0.1, 0.2, 0.3;
    const auto setup = make_host_setup(rig);
    ASSERT_TRUE(setup) << setup.error().message();
    const HostRig& host = setup->rig;
    EXPECT_EQ(host.name, "experiment");
    EXPECT_EQ(host.rig_hash, rig::rig_hash(rig));
    EXPECT_TRUE(host.T_map_base.matrix() == rig.T_map_base.matrix());
    ASSERT_EQ(host.nodes.size(), 2U);
    EXPECT_EQ(host.nodes[1].node_id, 2);
    EXPECT_EQ(host.nodes[1].name, "front_rings");
    EXPECT_EQ(host.nodes[1].node_hash, node_hash(rig.nodes[1].config));
    EXPECT_NE(host.nodes[1].node_hash, host.nodes[0].node_hash);
    EXPECT_EQ(host.nodes[1].pinned_build_id, 0x1234ABCDU);
    EXPECT_FALSE(host.nodes[0].pinned_build_id);
    ASSERT_EQ(host.nodes[0].sensors.size(), 17U);
    const HostSensor& sensor = host.nodes[0].sensors[9];
    EXPECT_EQ(sensor.name, "ring1_1");
    EXPECT_EQ(sensor.link, "panda_link8");
    EXPECT_TRUE(sensor.T_link_sensor.matrix() == rig.nodes[0].sensors[9].T_link_sensor.matrix());
    EXPECT_EQ(sensor.timing_budget, Microseconds(20'000));
    EXPECT_EQ(sensor.period, Microseconds(33'000));
    ASSERT_EQ(sensor.zones.size(), 1U);
    EXPECT_EQ(sensor.zones[0].offset_m, 0.0);
    EXPECT_TRUE(sensor.zones[0].direction_sensor == Eigen::Vector3d::UnitZ());
    EXPECT_EQ(host.joint_sources.at(0).node_id, 3);
    EXPECT_EQ(host.joint_names().front(), "panda_joint1");
    EXPECT_EQ(host.joint_sources.at(0).rate_hz, 100.0);
    EXPECT_EQ(host.bit_rates.nominal, 1'000'000U);
    EXPECT_EQ(host.bit_rates.data, 5'000'000U);
    EXPECT_EQ(host.links_ignored_by_sensors, (std::vector<std::string>{"panda_link7", "panda_link8"}));
    EXPECT_EQ(host.depth_self_margin_m, 0.09);
    EXPECT_EQ(host.range_self_margin_m, 0.12);
    EXPECT_EQ(host.range_limits.min_m, 0.04);
    EXPECT_EQ(host.range_limits.max_m, 4.0);
    EXPECT_EQ(host.range_limits.sigma_max_m, 0.2);
    EXPECT_EQ(host.range_limits.time_uncertainty_max, std::chrono::milliseconds(5));
}

/// The optics of the first sensor's zones, of one of the rigs that ship.
std::vector<BeamOptics> optics_in(const std::string& file) {
    const auto rig = rig::read_rig(kSource / "hw/rigs" / file);
    EXPECT_TRUE(rig) << rig.error().message();
    const auto setup = make_host_setup(*rig);
    EXPECT_TRUE(setup) << setup.error().message();
    std::vector<BeamOptics> optics;
    for (const HostZone& zone : setup->rig.nodes[0].sensors[0].zones) optics.push_back(zone.optics);
    return optics;
}

TEST(HostRigReader, gives_each_zone_its_own_part_of_the_cone) {
    constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
    EXPECT_EQ(optics_in("experiment.yaml"), std::vector{BeamOptics{}});
    EXPECT_EQ(optics_in("experiment_cone.yaml"),
              (std::vector{BeamOptics{13.5 * kRadPerDeg, 7.0 * kRadPerDeg, false}}));
    const auto zones = optics_in("experiment_zones.yaml");
    ASSERT_EQ(zones.size(), 9U);
    for (const BeamOptics& zone : zones) {
        EXPECT_TRUE(zone.is_zone);
        // 6 SPADs of 1.193 degrees: half their diagonal, and one and a half blurs of 2.5 degrees.
        EXPECT_NEAR(zone.half_angle_rad, (5.0625 + 3.75) * kRadPerDeg, 1e-9);
        // 1 / (1 / (7.159^2 / 12 + 2.5^2) + 1 / 7^2) is 2.9431 squared.
        EXPECT_NEAR(zone.sigma_rad, 2.9431 * kRadPerDeg, 1e-3 * kRadPerDeg);
    }
}

/// The field of view of the first sensor of one of the rigs that ship.
double fov_deg_in(const std::string& file) {
    const auto rig = rig::read_rig(kSource / "hw/rigs" / file);
    EXPECT_TRUE(rig) << rig.error().message();
    return make_host_setup(*rig)->rig.nodes[0].sensors[0].fov_rad * 180.0 / 3.14159265358979323846;
}

TEST(HostRigReader, gives_a_sensor_the_view_of_its_only_zone_or_of_its_whole_array) {
    EXPECT_EQ(fov_deg_in("experiment.yaml"), 0.0) << "an ideal ray";
    EXPECT_NEAR(fov_deg_in("experiment_cone.yaml"), 27.0, 1e-9);
    EXPECT_NEAR(fov_deg_in("experiment_zones.yaml"), 27.0, 1e-9);
    rig::Rig rig = experiment();
    rig.nodes[0].sensors[0].cone = rig::Cone{};
    rig.nodes[0].config.sensors[0].zones[0] = {.centre_spad = 199, .width = 4, .height = 4};
    const HostSensor sensor = make_host_setup(rig)->rig.nodes[0].sensors[0];
    EXPECT_EQ(sensor.fov_rad, 2.0 * sensor.zones[0].optics.half_angle_rad);
    EXPECT_LT(sensor.fov_rad, 0.4);
}

TEST(HostRigReader, more_than_half_of_the_array_is_no_zone) {
    rig::Rig rig = experiment();
    auto& sensor = rig.nodes[0].sensors[0];
    auto& config = rig.nodes[0].config.sensors[0];
    sensor.cone = rig::Cone{};
    config.zone_count = 2;
    config.zones[0] = {.centre_spad = 199, .width = 16, .height = 8};
    config.zones[1] = {.centre_spad = 199, .width = 12, .height = 12};
    sensor.zone_offset_m = {0.0, 0.0};
    const auto setup = make_host_setup(rig);
    ASSERT_TRUE(setup) << setup.error().message();
    const auto& zones = setup->rig.nodes[0].sensors[0].zones;
    EXPECT_TRUE(zones[0].optics.is_zone);
    EXPECT_FALSE(zones[1].optics.is_zone);
}

TEST(HostRigReader, counts_signal_messages_on_a_classical_bus_alone) {
    rig::Rig rig = experiment();
    rig.nodes[0].config.aux_every = 5;
    rig.nodes[0].config.uses_can_fd = false;
    EXPECT_EQ(make_host_setup(rig)->rig.nodes[0].aux_every, 5);
    rig.nodes[0].config.uses_can_fd = true;
    EXPECT_EQ(make_host_setup(rig)->rig.nodes[0].aux_every, 0);
}

TEST(HostRigReader, takes_over_the_camera_or_its_absence) {
    rig::Rig rig = experiment();
    rig.cameras.front().lens = {.k1 = 0.1, .k2 = 0.2, .p1 = 0.003, .p2 = 0.004, .k3 = 0.5};
    const auto with = make_host_setup(rig);
    ASSERT_EQ(with->rig.cameras.size(), 1U);
    const HostCamera& camera = with->rig.cameras.front();
    EXPECT_EQ(camera.name, "");
    EXPECT_EQ(camera.intrinsics.lens, rig.cameras.front().lens);
    EXPECT_EQ(camera.intrinsics.width, 512U);
    EXPECT_EQ(camera.intrinsics.height, 424U);
    EXPECT_EQ(camera.intrinsics.fx, 365.0);
    EXPECT_EQ(camera.intrinsics.cy, 212.0);
    EXPECT_EQ(camera.depth_min_m, 0.5);
    EXPECT_EQ(camera.depth_max_m, 4.5);
    EXPECT_EQ(camera.rate_hz, 10.0);
    EXPECT_TRUE(camera.T_link_camera.matrix() == rig.cameras.front().T_link_camera.matrix());
    rig.cameras.clear();
    EXPECT_TRUE(make_host_setup(rig)->rig.cameras.empty());
}

TEST(HostRigReader, takes_over_each_camera_with_its_name_and_noise) {
    rig::Rig rig = experiment();
    rig.cameras.push_back(rig.cameras.front());
    rig.cameras[0].name = "left";
    rig.cameras[1].name = "right";
    rig.cameras[1].noise =
        rig::CameraNoise{.noise_m = 0.002, .noise_per_m = 0.0015, .noise_from_m = 0.4, .bias_per_m = 0.001};
    const auto setup = make_host_setup(rig);
    ASSERT_TRUE(setup);
    ASSERT_EQ(setup->rig.cameras.size(), 2U);
    EXPECT_EQ(setup->rig.cameras[0].name, "left");
    EXPECT_FALSE(setup->rig.cameras[0].noise);
    EXPECT_EQ(setup->rig.cameras[1].name, "right");
    ASSERT_TRUE(setup->rig.cameras[1].noise);
    EXPECT_EQ(setup->rig.cameras[1].noise->constant_m, 0.002);
    EXPECT_EQ(setup->rig.cameras[1].noise->quadratic_per_m, 0.0015);
    EXPECT_EQ(setup->rig.cameras[1].noise->bias_per_m, 0.001);
}

TEST(HostRigReader, reads_the_body_and_the_kinematics_from_the_urdf) {
    rig::Rig rig = experiment();
    rig.link_padding_m["panda_link2"] = 0.02;
    const auto setup = make_host_setup(rig);
    ASSERT_TRUE(setup);
    ASSERT_EQ(setup->rig.body.size(), 8U);
    EXPECT_EQ(setup->rig.body[2].link, "panda_link2");
    EXPECT_DOUBLE_EQ(setup->rig.body[2].radius_m, 0.09);
    EXPECT_EQ(setup->robot.link_count(), 9U);
    EXPECT_EQ(setup->robot.joint_count(), 7U);
}

TEST(HostRigReader, refuses_a_body_outside_the_kinematic_tree) {
    rig::Rig rig = experiment();
    rig.base_link = "panda_link4";
    rig.joint_sources = {{.joints = {"panda_joint5", "panda_joint6", "panda_joint7"}}};
    const auto setup = make_host_setup(rig);
    ASSERT_FALSE(setup);
    EXPECT_EQ(setup.error().code, ErrorCode::conflict);
    EXPECT_EQ(setup.error().key, "link panda_link0");
}

TEST(HostRigReader, warns_of_a_robot_without_a_body) {
    rig::Rig rig = experiment();
    const auto whole = make_host_setup(rig);
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->warnings, std::vector<std::string>());
    EXPECT_FALSE(whole->rig.body.empty());
    std::string text = testing_support::ScratchFolder::read(rig.urdf.shown());
    for (std::size_t at = 0; (at = text.find("<collision", at)) != std::string::npos;) {
        constexpr std::string_view kEnd = "</collision>";
        text.erase(at, text.find(kEnd, at) + kEnd.size() - at);
    }
    const testing_support::ScratchFolder folder;
    rig.urdf = folder.write("no_body.urdf", text);
    const auto bare = make_host_setup(rig);
    ASSERT_TRUE(bare) << bare.error().message();
    EXPECT_EQ(bare->warnings,
              std::vector<std::string>{"no link at or below panda_link0 has a <collision>: the robot is "
                                       "not removed from images and ranges"});
}

TEST(HostRigReader, warns_of_joint_states_so_rare_that_the_gap_of_a_lost_one_is_not_bridged) {
    rig::Rig rig = experiment();
    const auto warnings_at = [&rig](double rate_hz) {
        rig.joint_sources.at(0).rate_hz = rate_hz;
        const auto setup = make_host_setup(rig);
        return setup ? setup->warnings : std::vector<std::string>{"refused"};
    };
    EXPECT_EQ(warnings_at(20.0), std::vector<std::string>());
    for (const auto& [rate_hz, begin] : {std::pair(19.9, "joints.rate_hz 19.9: at most 100 ms"),
                                         std::pair(1.0, "joints.rate_hz 1: at most 100 ms")}) {
        const auto warnings = warnings_at(rate_hz);
        ASSERT_EQ(warnings.size(), 1U);
        EXPECT_EQ(warnings[0].rfind(begin, 0), 0U) << warnings[0];
    }
}

HostSetup partial(const std::string& file) {
    const auto rig = rig::read_rig(kSource / "tests/data/partial_body" / file);
    EXPECT_TRUE(rig) << rig.error().message();
    auto setup = make_host_setup(*rig);
    EXPECT_TRUE(setup) << setup.error().message();
    return std::move(setup).value();
}

TEST(HostRigReader, names_a_link_that_moves_and_has_no_body_unless_the_rig_lists_it) {
    const HostSetup unlisted = partial("rig.yaml");
    ASSERT_EQ(unlisted.rig.links_without_body.size(), 1U);
    EXPECT_EQ(unlisted.rig.links_without_body[0].link, "upper");
    EXPECT_FALSE(unlisted.rig.links_without_body[0].is_listed);
    ASSERT_EQ(unlisted.warnings.size(), 1U);
    EXPECT_EQ(unlisted.warnings[0].rfind("upper: this link moves", 0), 0U) << unlisted.warnings[0];
    const HostSetup listed = partial("listed.yaml");
    ASSERT_EQ(listed.rig.links_without_body.size(), 1U);
    EXPECT_TRUE(listed.rig.links_without_body[0].is_listed);
    EXPECT_EQ(listed.warnings, std::vector<std::string>());
    EXPECT_NE(listed.rig.rig_hash, unlisted.rig.rig_hash);
}

TEST(HostRigReader, notes_whose_body_stands_for_a_link_without_its_own) {
    const HostSetup setup = partial("rig.yaml");
    ASSERT_EQ(setup.rig.links_with_borrowed_body.size(), 1U);
    EXPECT_EQ(setup.rig.links_with_borrowed_body[0].link, "fore");
    EXPECT_EQ(setup.rig.links_with_borrowed_body[0].body_of, "tool");
    ASSERT_EQ(setup.notes.size(), 1U);
    EXPECT_EQ(setup.notes[0].rfind("fore: this link moves", 0), 0U) << setup.notes[0];
}

}  // namespace
}  // namespace octoskin
