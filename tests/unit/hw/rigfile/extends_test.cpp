// `extends`, `sensor_defaults`, and the several ways to write an orientation.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {
namespace {

const std::filesystem::path kData = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/rigs";

class Folder : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  (std::string("octoskin-") + testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path write(const std::string& name, const std::string& text) {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }
    /// A rig that lays `overlay` over the correct one.
    Rig overlaid(const std::string& overlay) {
        auto rig =
            read_rig(write("rig.yaml", "extends: " + (kData / "one-sensor.yaml").string() + "\n" + overlay));
        EXPECT_TRUE(rig) << rig.error().message();
        return std::move(rig).value();
    }
    Eigen::Isometry3d pose(const std::string& text) {
        const Value document = load_document(write("pose.yaml", text));
        return read_pose(document, "pose", {});
    }

    std::filesystem::path folder_;
};

using Extends = Folder;
using Orientation = Folder;

TEST_F(Extends, tables_merge_key_by_key_and_the_rest_is_replaced) {
    const Rig rig = overlaid("name: heir\njoints:\n  rate_hz: 50\n");
    EXPECT_EQ(rig.name, "heir");
    EXPECT_EQ(rig.joint_sources.at(0).rate_hz, 50.0);
    EXPECT_EQ(rig.joint_sources.at(0).node_id, 9);
    EXPECT_EQ(rig.joint_names(), std::vector<std::string>{"elbow"});
}

TEST_F(Extends, paths_stay_relative_to_the_file_that_names_them) {
    const Rig rig = overlaid("name: heir\n");
    EXPECT_EQ(rig.urdf, std::filesystem::absolute(kData / "two-links.urdf"));
    EXPECT_EQ(rig.nodes[0].board.name, "small");
}

TEST_F(Extends, null_takes_an_inherited_key_away) {
    write("with-limits.yaml",
          "extends: " + (kData / "one-sensor.yaml").string() + "\nrange_limits: {min_m: 1, max_m: 2}\n");
    const auto rig = read_rig(write("without.yaml", "extends: with-limits.yaml\nrange_limits: ~\n"));
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_EQ(rig->range_limits.min_m, 0.04);
    EXPECT_EQ(read_rig(folder_ / "with-limits.yaml")->range_limits.min_m, 1.0);
}

TEST_F(Extends, nearer_file_wins_over_three_levels) {
    write("a.yaml",
          "extends: " + (kData / "one-sensor.yaml").string() + "\nname: a\njoints: {rate_hz: 10}\n");
    write("b.yaml", "extends: a.yaml\nname: b\n");
    const auto rig = read_rig(write("c.yaml", "extends: b.yaml\njoints: {node_id: 5}\n"));
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_EQ(rig->name, "b");
    EXPECT_EQ(rig->joint_sources.at(0).rate_hz, 10.0);
    EXPECT_EQ(rig->joint_sources.at(0).node_id, 5);
}

TEST_F(Extends, another_way_to_write_an_orientation_replaces_the_inherited_one) {
    const Rig rig = overlaid("sensor_defaults:\n  pose: {quaternion_wxyz: [1, 0, 0, 0]}\n");
    const Eigen::Isometry3d& T_link_sensor = rig.nodes[0].sensors[0].T_link_sensor;
    EXPECT_TRUE(T_link_sensor.linear().isIdentity());
    EXPECT_EQ(T_link_sensor.translation(), Eigen::Vector3d(0.05, 0.0, 0.02));
}

TEST_F(Extends, sensor_may_differ_from_the_defaults_and_shares_the_rest) {
    const Rig rig = overlaid(
        "nodes:\n  - name: board\n    node_id: 1\n    board: " + (kData / "small-board.yaml").string() +
        "\n    sensors:\n      - {name: a, bus: 0, xshut_line: 0, address: 0x30, timing_budget_ms: 20}\n"
        "      - {name: b, bus: 1, xshut_line: 1, address: 0x30, pose: {xyz_m: [0, 0, 0]}}\n");
    EXPECT_EQ(rig.nodes[0].config.sensors[0].timing_budget_ms, 20);
    EXPECT_EQ(rig.nodes[0].config.sensors[1].timing_budget_ms, 33);
    EXPECT_EQ(rig.nodes[0].sensors[1].T_link_sensor.translation(), Eigen::Vector3d::Zero());
    EXPECT_EQ(rig.nodes[0].sensors[1].T_link_sensor.linear(), rig.nodes[0].sensors[0].T_link_sensor.linear());
}

TEST_F(Extends, robot_given_instead_is_the_one_that_is_checked) {
    const auto panda = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/robots/panda.urdf";
    const auto rig = read_rig(kData / "one-sensor.yaml", panda);
    ASSERT_FALSE(rig);
    EXPECT_EQ(rig.error().code, ErrorCode::unknown_name);
    EXPECT_EQ(rig.error().key, "robot.base_link");
    const auto named_absent = write(
        "rig.yaml", "extends: " + (kData / "one-sensor.yaml").string() + "\nrobot: {urdf: gone.urdf}\n");
    const auto replaced = read_rig(named_absent, kData / "two-links.urdf");
    ASSERT_TRUE(replaced) << replaced.error().message();
    EXPECT_EQ(replaced->urdf.filename(), "two-links.urdf");
}

TEST_F(Orientation, roll_pitch_yaw_turn_about_the_fixed_axes_in_this_order) {
    // Roll 90 takes y to z, then yaw 90 takes x to y: x -> y, y -> z, z -> x.
    const Eigen::Isometry3d T = pose("{xyz_m: [1, 2, -2], rpy_deg: [90, 0, 90]}");
    EXPECT_TRUE((T.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
    EXPECT_TRUE((T.linear() * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ()));
    EXPECT_TRUE((T.linear() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));
    EXPECT_EQ(T.translation(), Eigen::Vector3d(1, 2, -2));
    // Pitch 90 takes z to x.
    EXPECT_TRUE(
        (pose("{xyz_m: [0, 0, 0], rpy_deg: [0, 90, 0]}").linear().col(2)).isApprox(Eigen::Vector3d::UnitX()));
}

TEST_F(Orientation, quaternion_rows_and_angles_of_one_turn_agree) {
    // 60 degrees about z.
    const Eigen::Isometry3d by_angles = pose("{xyz_m: [0, 0, 0], rpy_deg: [0, 0, 60]}");
    const Eigen::Isometry3d by_quaternion =
        pose("{xyz_m: [0, 0, 0], quaternion_wxyz: [0.8660254037844387, 0, 0, 0.5]}");
    const Eigen::Isometry3d by_rows = pose(
        "{xyz_m: [0, 0, 0], rotation_rows: [[0.5, -0.8660254037844386, 0], [0.8660254037844386, 0.5, 0], [0, "
        "0, 1]]}");
    EXPECT_TRUE(by_angles.isApprox(by_quaternion, 1e-15));
    EXPECT_TRUE(by_angles.isApprox(by_rows, 1e-15));
}

TEST_F(Orientation, nearly_unit_quaternion_is_normalised) {
    const Eigen::Isometry3d T = pose("{xyz_m: [0, 0, 0], quaternion_wxyz: [0.70710712, 0, 0, 0.70710712]}");
    EXPECT_NEAR(T.linear().determinant(), 1.0, 1e-14);
}

}  // namespace
}  // namespace octoskin::rig
