// The answer to `describe`, compared with the files that it is made of.
#include "host/apps/daemon/description.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "host/apps/daemon/settings.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kHardware = OCTOSKIN_SOURCE_DIR "/hw";

/// The Panda a metre above a link `world`, turned by a quarter; its base is 2 m along the map's x.
class Description : public testing::Test {
  protected:
    Json read(const std::string& more_keys = "", bool reads_cameras = true, bool has_joint_socket = false) {
        std::string panda =
            testing_support::ScratchFolder::read(std::string(kHardware) + "/robots/panda.urdf");
        panda.insert(
            panda.find("<link"),
            "<link name=\"world\"/><joint name=\"mount\" type=\"fixed\"><parent link=\"world\"/>"
            "<child link=\"panda_link0\"/><origin xyz=\"0 0 1\" rpy=\"0 0 1.5707963267948966\"/></joint>\n");
        folder_.write("robot.urdf", panda);
        folder_.write("rig.yaml", fmt::format("extends: {}/rigs/experiment_zones.yaml\nname: turned\n"
                                              "robot: {{urdf: robot.urdf}}\n"
                                              "T_map_base: {{xyz_m: [2, 0, 0], rpy_deg: [0, 0, 0]}}\n{}",
                                              kHardware, more_keys));
        DaemonRequest request;
        request.rig = folder_ / "rig.yaml";
        if (has_joint_socket) request.joint_socket = "any";
        settings_ = read_settings(request);
        EXPECT_TRUE(settings_) << settings_.error().error.message();
        return settings_ ? description_json(settings_->host, reads_cameras, 3) : Json();
    }
    static void expect_pose(const Json& pose, const std::array<double, 7>& expected) {
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(pose["p"][i].get<double>(), expected[i], 1e-12) << i;
        for (std::size_t i = 0; i < 4; ++i)
            EXPECT_NEAR(pose["q"][i].get<double>(), expected[3 + i], 1e-12) << i;
        EXPECT_EQ(pose["q"].size(), 4U);
    }
    testing_support::ScratchFolder folder_;
    Result<Settings, AppError> settings_ = fail(ExitCode::usage, {ErrorCode::bad_value, "not read"});
};

TEST_F(Description, has_the_frames_of_the_robot_from_its_root_on) {
    const Json described = read();
    EXPECT_EQ(described["ok"], true);
    EXPECT_EQ(described["rig"], "turned");
    EXPECT_EQ(described["rig_hash"], fmt::format("{:08x}", settings_->recorded.rig_hash));
    EXPECT_EQ(described["reloads"], 3);
    EXPECT_EQ(described["root_link"], "world");
    EXPECT_EQ(described["base_link"], "panda_link0");
    const double half = std::numbers::sqrt2 / 2.0;
    expect_pose(described["T_root_base"], {0, 0, 1, 0, 0, half, half});
    // The map's origin is 2 m behind the base, whose x is the root's y.
    expect_pose(described["T_root_map"], {0, -2, 1, 0, 0, half, half});
    EXPECT_EQ(described["links"].size(), 10U) << described["links"].dump();
    EXPECT_EQ(std::ranges::count(described["links"], "world"), 1);
}

TEST_F(Description, has_the_joints_and_the_body_from_which_the_kinematics_are_made) {
    const Json described = read();
    const auto& frames = settings_->host.frames;
    ASSERT_EQ(described["joints"].size(), frames.joints.size());
    ASSERT_EQ(described["joints"].size(), 8U);
    EXPECT_EQ(described["joints"][3]["name"], "panda_joint4");
    EXPECT_EQ(described["joints"][3]["parent"], "panda_link3");
    EXPECT_EQ(described["joints"][3]["kind"], "revolute");
    EXPECT_EQ(described["joints"][3]["min"], frames.joints[3].limits.min);
    EXPECT_EQ(described["joints"][3]["axis"][2], frames.joints[3].axis.z());
    EXPECT_EQ(described["joints"][7]["kind"], "fixed");
    EXPECT_TRUE(described["joints"][3]["mimic"].is_null());
    const auto& body = settings_->host.rig.body;
    ASSERT_EQ(described["body"].size(), body.size());
    EXPECT_EQ(described["body"][0]["link"], body[0].link);
    EXPECT_EQ(described["body"][0]["radius_m"], body[0].radius_m);
    EXPECT_EQ(described["body"][0]["b"][2], body[0].p_link_b.z());
}

TEST_F(Description, has_each_joint_source_and_sensor) {
    const Json described = read();
    ASSERT_EQ(described["joint_sources"].size(), 1U);
    const Json& joints = described["joint_sources"][0];
    EXPECT_EQ(joints["node"], 3);
    EXPECT_EQ(joints["via"], "can");
    EXPECT_EQ(joints["rate_hz"], 100.0);
    EXPECT_EQ(joints["joints"].size(), 7U);
    EXPECT_EQ(joints["joints"][6], "panda_joint7");
    ASSERT_EQ(described["sensors"].size(), 34U);
    const Json& sensor = described["sensors"][9];
    EXPECT_EQ(sensor["node"], 1);
    EXPECT_EQ(sensor["sensor"], 9);
    EXPECT_EQ(sensor["name"], "ring1_1");
    EXPECT_EQ(sensor["node_name"], settings_->host.rig.nodes[0].name);
    EXPECT_EQ(sensor["link"], "panda_link8");
    EXPECT_NEAR(sensor["fov_rad"].get<double>(), 27.0 * std::numbers::pi / 180.0, 1e-12);
    EXPECT_EQ(sensor["range_min_m"], 0.04);
    EXPECT_EQ(sensor["range_max_m"], 4.0);
    EXPECT_EQ(sensor["zones"], 9);
    const Eigen::Isometry3d& pose = settings_->host.rig.nodes[0].sensors[9].T_link_sensor;
    const auto& q = sensor["T_link_sensor"]["q"];
    const Eigen::Quaterniond turned(q[3].get<double>(), q[0].get<double>(), q[1].get<double>(),
                                    q[2].get<double>());
    EXPECT_NEAR(turned.norm(), 1.0, 1e-15);
    EXPECT_TRUE(turned.toRotationMatrix().isApprox(pose.linear(), 1e-12));
    EXPECT_EQ(sensor["T_link_sensor"]["p"][0].get<double>(), pose.translation().x()) << "to the last bit";
    EXPECT_EQ(Json::parse(described.dump())["sensors"][9], sensor) << "the text has all digits";
    EXPECT_EQ(read("", true, true)["joint_sources"][0]["via"], "socket") << "with --joints";
}

TEST_F(Description, has_the_cameras_and_which_of_them_are_fed) {
    const Json described = read("camera: {device: \"ros:/camera/depth/image_rect_raw\"}\n");
    ASSERT_EQ(described["cameras"].size(), 1U);
    const Json& camera = described["cameras"][0];
    const HostCamera& of_rig = settings_->host.rig.cameras[0];
    EXPECT_EQ(camera["name"], "");
    EXPECT_EQ(camera["device"], "ros:/camera/depth/image_rect_raw");
    EXPECT_EQ(camera["is_fed"], true);
    EXPECT_EQ(camera["link"], "panda_link0") << "the base link";
    EXPECT_EQ(camera["width"], of_rig.intrinsics.width);
    EXPECT_EQ(camera["height"], of_rig.intrinsics.height);
    EXPECT_EQ(camera["fx"], of_rig.intrinsics.fx);
    EXPECT_EQ(camera["cy"], of_rig.intrinsics.cy);
    EXPECT_EQ(camera["depth_min_m"], of_rig.depth_min_m);
    EXPECT_EQ(camera["depth_max_m"], of_rig.depth_max_m);
    EXPECT_EQ(camera["rate_hz"], of_rig.rate_hz);
    EXPECT_EQ(camera["T_link_camera"]["p"][2].get<double>(), of_rig.T_link_camera.translation().z());
    EXPECT_EQ(read()["cameras"][0]["is_fed"], false);
    EXPECT_TRUE(read("", false)["cameras"].empty()) << "with --no-camera";
}

}  // namespace
}  // namespace octoskin
