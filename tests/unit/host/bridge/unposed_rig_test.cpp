// Cameras whose poses come from the static frames of ROS 2, and the rig with these poses.
#include "host/bridge/received/unposed_rig.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "hw/rigfile/rig.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::bridge {
namespace {

/// The Panda a metre above a link `world`, turned by a quarter.
class UnposedRigTest : public testing::Test {
  protected:
    UnposedRigTest() {
        std::string panda = testing_support::ScratchFolder::read(OCTOSKIN_SOURCE_DIR "/hw/robots/panda.urdf");
        panda.insert(
            panda.find("<link"),
            "<link name=\"world\"/><joint name=\"mount\" type=\"fixed\"><parent link=\"world\"/>"
            "<child link=\"panda_link0\"/><origin xyz=\"0 0 1\" rpy=\"0 0 1.5707963267948966\"/></joint>\n");
        folder_.write("robot.urdf", panda);
    }
    static std::string camera(const std::string& keys) {
        return "{" + keys +
               ", width_px: 64, height_px: 48, fx_px: 60, fy_px: 60, cx_px: 32, cy_px: 24, rate_hz: 1}";
    }
    std::filesystem::path write(const std::string& cameras) {
        return folder_.write(
            "rig.yaml",
            fmt::format("extends: {}/hw/rigs/experiment.yaml  # kept\nrobot: {{urdf: robot.urdf}}\n"
                        "camera: ~\ncameras:\n{}",
                        OCTOSKIN_SOURCE_DIR, cameras));
    }
    Result<UnposedRig, Error> read(const std::string& cameras) { return UnposedRig::read(write(cameras)); }
    Error refused(const std::string& cameras) {
        const auto rig = read(cameras);
        EXPECT_FALSE(rig);
        return rig ? Error{} : rig.error();
    }
    static FrameOnLink frame(const std::string& link, double x_m) {
        FrameOnLink frame{.link = link};
        frame.T_link_frame.translation().x() = x_m;
        return frame;
    }
    testing_support::ScratchFolder folder_;
};

TEST_F(UnposedRigTest, has_the_cameras_whose_pose_is_to_be_taken) {
    const auto rig =
        read("  - " + camera("name: a, device: 'ros:/a/depth', pose: tf") + "\n  - " +
             camera("name: b, device: 'ros:/b/depth', pose: {xyz_m: [0, 0, 1], rpy_deg: [0, 0, 0]}") +
             "\n  - " + camera("name: c, device: 'ros:/c/depth', link: panda_link8, pose: tf"));
    ASSERT_TRUE(rig) << rig.error().message();
    ASSERT_EQ(rig->cameras().size(), 2U);
    EXPECT_EQ(rig->cameras()[0].topic, "/a/depth");
    EXPECT_EQ(rig->cameras()[0].link, "panda_link0");
    EXPECT_EQ(rig->cameras()[1].index, 2U);
    EXPECT_EQ(rig->cameras()[1].link, "panda_link8");
    EXPECT_EQ(rig->links().size(), 10U) << "base, eight links below it, and the root";
}

// A joint between the frame's link and the rig's link would make the pose wrong at the next movement.
TEST_F(UnposedRigTest, places_a_camera_on_the_link_of_the_rig_if_it_is_rigid) {
    const auto rig = read("  - " + camera("name: a, device: 'ros:/a', pose: tf") + "\n  - " +
                          camera("name: b, device: 'ros:/b', link: panda_link7, pose: tf"));
    ASSERT_TRUE(rig) << rig.error().message();
    const UnposedCamera& a = rig->cameras()[0];
    const UnposedCamera& b = rig->cameras()[1];
    const auto on_base = rig->pose_of(a, frame("panda_link0", 0.5));
    EXPECT_EQ(on_base.value().link, "");
    EXPECT_EQ(on_base->T_link_camera.translation().x(), 0.5);
    // 0.5 m along the root's x is to the right of the base, which is turned by a quarter, a metre below it.
    const auto on_root = rig->pose_of(a, frame("world", 0.5));
    EXPECT_EQ(on_root.value().link, "");
    EXPECT_TRUE(on_root->T_link_camera.translation().isApprox(Eigen::Vector3d(0, -0.5, -1), 1e-12));
    const auto on_hand = rig->pose_of(a, frame("panda_link8", 0.5));
    EXPECT_EQ(on_hand.value().link, "panda_link8");
    EXPECT_EQ(on_hand->T_link_camera.translation().x(), 0.5);
    // The flange, panda_link8, is 0.107 m along the z of panda_link7.
    const auto on_flange = rig->pose_of(b, frame("panda_link8", 0.5));
    EXPECT_EQ(on_flange.value().link, "");
    EXPECT_TRUE(on_flange->T_link_camera.translation().isApprox(Eigen::Vector3d(0.5, 0, 0.107), 1e-12));
    const auto moved = rig->pose_of(b, frame("panda_link6", 0.5));
    ASSERT_FALSE(moved);
    EXPECT_EQ(moved.error().code, ErrorCode::conflict);
    EXPECT_EQ(moved.error().value, "'panda_link7' and 'panda_link6'");
}

TEST_F(UnposedRigTest, makes_a_rig_that_is_read_with_these_poses) {
    const std::string cameras = "  - " + camera("name: a, device: 'ros:/a', pose: tf") +
                                "\n  # the hand's\n  - " + camera("name: b, device: 'ros:/b', pose: tf");
    const auto rig = read(cameras);
    ASSERT_TRUE(rig) << rig.error().message();
    rig::CameraPose on_base;
    on_base.T_link_camera =
        Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized());
    const rig::CameraPose on_hand{.link = "panda_link8"};
    const auto text = rig->text_with(std::array{on_base, on_hand});
    ASSERT_TRUE(text) << text.error().message();
    EXPECT_NE(text->find("\n  # the hand's\n"), std::string::npos);
    const auto posed = rig::read_rig(folder_.write("posed.yaml", *text));
    ASSERT_TRUE(posed) << posed.error().message();
    EXPECT_TRUE(posed->cameras[0].T_link_camera.isApprox(on_base.T_link_camera, 1e-6));
    EXPECT_EQ(posed->cameras[0].link, "");
    EXPECT_EQ(posed->cameras[1].link, "panda_link8");
    on_base.T_link_camera.translation().x() = 1e4;
    const auto far = rig->text_with(std::array{on_base, on_hand});
    ASSERT_FALSE(far);
    EXPECT_EQ(far.error().code, ErrorCode::out_of_range);
    EXPECT_EQ(far.error().key, "cameras[0].pose.xyz_m");
}

TEST_F(UnposedRigTest, is_refused_without_such_a_camera_or_its_topic) {
    const std::string posed = "pose: {xyz_m: [0, 0, 1], rpy_deg: [0, 0, 0]}";
    EXPECT_EQ(refused("  - " + camera("name: a, " + posed)).code, ErrorCode::no_content);
    const Error no_topic = refused("  - " + camera("name: a, device: '1d27/0601@1/5', pose: tf"));
    EXPECT_EQ(no_topic.code, ErrorCode::conflict);
    EXPECT_EQ(no_topic.key, "device");
    EXPECT_EQ(no_topic.value, "'1d27/0601@1/5'");
    const Error other = refused("  - " + camera("name: a, device: 'ros:/a', pose: tf, colour: red"));
    EXPECT_EQ(other.code, ErrorCode::unknown_key);
    EXPECT_EQ(other.line, 5);
    EXPECT_EQ(UnposedRig::read(folder_ / "none.yaml").error().code, ErrorCode::not_found);
    write("  - " + camera("name: a, device: 'ros:/a', pose: tf"));
    const auto extended = UnposedRig::read(folder_.write("more.yaml", "extends: rig.yaml\nname: more\n"));
    ASSERT_FALSE(extended);
    EXPECT_EQ(extended.error().file.filename(), "rig.yaml") << "the file with `pose: tf` is to be given";
    EXPECT_EQ(extended.error().key, "cameras[0].pose");
}

}  // namespace
}  // namespace octoskin::bridge
