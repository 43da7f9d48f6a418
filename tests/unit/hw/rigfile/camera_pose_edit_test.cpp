// The pose that a program finds goes into the file that a person keeps, and nothing else of it changes.
#include "hw/rigfile/camera_pose_edit.hpp"

#include <gtest/gtest.h>

namespace octoskin::rig {
namespace {

CameraPose pose(double x_m, const std::string& link = {}) {
    CameraPose pose{.link = link};
    pose.T_link_camera.translation().x() = x_m;
    return pose;
}
constexpr const char* kAtOne =
    "{xyz_m: [1.000000, 0.000000, 0.000000], quaternion_wxyz: [1.000000000, 0.000000000, 0.000000000, "
    "0.000000000]}";

TEST(CameraPoseEdit, writes_the_pose_and_keeps_the_rest) {
    const std::string text =
        "extends: arm.yaml  # tf\n"
        "camera:\n"
        "  device: ros:/depth  # pose: tf\n"
        "  pose: tf  # of the hall's frames\n"
        "  rate_hz: 30\n";
    EXPECT_EQ(cameras_with_pose_of_frames(text), std::vector<std::size_t>{0});
    EXPECT_EQ(with_camera_poses(text, {{0, pose(1)}}).value(),
              std::string("extends: arm.yaml  # tf\n"
                          "camera:\n"
                          "  device: ros:/depth  # pose: tf\n"
                          "  pose: ") +
                  kAtOne +
                  "  # of the hall's frames\n"
                  "  rate_hz: 30\n");
}

TEST(CameraPoseEdit, writes_the_link_beside_the_pose) {
    EXPECT_EQ(with_camera_poses("camera:\n  pose: tf\n  rate_hz: 30\n", {{0, pose(1, "hand")}}).value(),
              std::string("camera:\n  link: \"hand\"\n  pose: ") + kAtOne + "\n  rate_hz: 30\n");
    EXPECT_EQ(with_camera_poses("cameras:\n- pose: 'tf'\n  name: a\n", {{0, pose(1, "a \"b\": c")}}).value(),
              std::string("cameras:\n- link: \"a \\\"b\\\": c\"\n  pose: ") + kAtOne + "\n  name: a\n");
    EXPECT_EQ(with_camera_poses("camera: {rate_hz: 30, pose: \"tf\"}", {{0, pose(1, "hand")}}).value(),
              std::string("camera: {rate_hz: 30, link: \"hand\", pose: ") + kAtOne + "}");
}

TEST(CameraPoseEdit, finds_each_of_several_cameras_by_its_place) {
    const std::string text =
        "cameras:\n"
        "  - {name: a, pose: tf}\n"
        "  - {name: b, pose: {xyz_m: [0, 0, 0], rpy_deg: [0, 0, 0]}}\n"
        "  - name: tf\n"
        "    pose: tf";
    EXPECT_EQ(cameras_with_pose_of_frames(text), (std::vector<std::size_t>{0, 2}));
    const std::string posed = with_camera_poses(text, {{0, pose(1)}, {2, pose(1, "c")}}).value();
    EXPECT_EQ(posed, std::string("cameras:\n  - {name: a, pose: ") + kAtOne +
                         "}\n"
                         "  - {name: b, pose: {xyz_m: [0, 0, 0], rpy_deg: [0, 0, 0]}}\n"
                         "  - name: tf\n"
                         "    link: \"c\"\n"
                         "    pose: " +
                         kAtOne);
    EXPECT_TRUE(cameras_with_pose_of_frames(posed).empty());
    EXPECT_EQ(with_camera_poses(text, {{1, pose(1)}}), std::nullopt);
}

TEST(CameraPoseEdit, finds_nothing_where_nothing_is) {
    for (const char* text : {"", "camera: tf", "camera: {pose: tff}", "camera: {pose: [tf]}", "cameras: [tf]",
                             "cameras: {pose: tf}", "{", "- pose: tf", "pose: tf",
                             "camera:\n  pose:\n    tf: 1", "camera: &a {pose: *a}"}) {
        EXPECT_TRUE(cameras_with_pose_of_frames(text).empty()) << text;
        EXPECT_EQ(with_camera_poses(text, {{0, pose(1)}}), std::nullopt) << text;
    }
}

}  // namespace
}  // namespace octoskin::rig
