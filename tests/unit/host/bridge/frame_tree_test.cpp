// The pose of a camera from static transforms.
#include "host/bridge/received/frame_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/bridge/received/robot_description.hpp"

namespace octoskin::bridge {
namespace {

ros::geometry_msgs::TransformStamped edge(const std::string& parent, const std::string& child, double x,
                                          double turn_z = 0.0) {
    return {{{}, parent}, child, {{x, 0, 0}, {0, 0, std::sin(turn_z / 2.0), std::cos(turn_z / 2.0)}}};
}

const std::vector<std::string> kLinks = {"base", "hand"};

TEST(FrameTree, gives_the_pose_on_the_nearest_link) {
    FrameTree tree;
    tree.take({{edge("hand", "camera_link", 1.0, std::numbers::pi / 2.0), edge("world", "base", 9.0)}});
    tree.take({{edge("camera_link", "camera_optical", 2.0)}});
    const auto pose = tree.from_link("camera_optical", kLinks);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->link, "hand");
    EXPECT_TRUE(pose->T_link_frame.translation().isApprox(Eigen::Vector3d(1.0, 2.0, 0.0)));
    EXPECT_EQ(rig_text(*pose),
              "link: \"hand\"\npose: {xyz_m: [1.000000, 2.000000, 0.000000], quaternion_wxyz: "
              "[0.707106781, 0.000000000, 0.000000000, 0.707106781]}\n");
}

TEST(FrameTree, says_why_there_is_none) {
    FrameTree tree;
    EXPECT_EQ(tree.why("camera"), "nothing publishes /tf_static");
    tree.take({{edge("table", "stand", 1.0), edge("stand", "camera", 1.0)}});
    EXPECT_FALSE(tree.from_link("camera", kLinks));
    EXPECT_NE(tree.why("camera").find("'table'"), std::string::npos);
    EXPECT_NE(tree.why("other").find("no frame 'other'"), std::string::npos);
}

TEST(FrameTree, ends_in_a_loop_and_leaves_out_what_is_not_finite) {
    FrameTree tree;
    tree.take({{edge("a", "b", 1.0), edge("b", "a", 1.0)}});
    EXPECT_FALSE(tree.from_link("a", kLinks));
    EXPECT_FALSE(tree.why("a").empty());
    tree.take({{edge("hand", "c", std::nan("")), edge("hand", "d", 1.0, std::nan(""))}});
    EXPECT_FALSE(tree.from_link("c", kLinks));
    EXPECT_FALSE(tree.from_link("d", kLinks));
}

TEST(RobotDescription, is_compared_by_its_links) {
    RobotFacts robot;
    robot.links = {"base", "hand"};
    EXPECT_EQ(description_differs(R"(<robot name="a"><link name="hand"/><link name="base"/></robot>)", robot),
              "");
    EXPECT_NE(description_differs(R"(<robot><link name="base"/><link name="tool"/></robot>)", robot)
                  .find("lacks the links hand, it has in addition tool"),
              std::string::npos);
    robot.joints = {{.name = "wrist",
                     .parent_link = "base",
                     .child_link = "hand",
                     .kind = JointKind::revolute,
                     .limits = {}}};
    robot.joints[0].T_parent_joint.translation().x() = 0.5;
    const auto with_joint = [](const std::string& kind, const std::string& inner) {
        return "<robot><link name=\"hand\"/><link name=\"base\"/><joint name=\"wrist\" type=\"" + kind +
               "\"><parent link=\"base\"/><child link=\"hand\"/>" + inner + "</joint></robot>";
    };
    const auto differs = [&](const std::string& kind, const std::string& inner) {
        return description_differs(with_joint(kind, inner), robot);
    };
    EXPECT_EQ(differs("revolute", "<origin xyz=\"0.5 0 0\"/><axis xyz=\"0 0 1\"/>"), "");
    EXPECT_NE(differs("revolute", "<origin xyz=\"0.6 0 0\"/><axis xyz=\"0 0 1\"/>").find("another origin"),
              std::string::npos);
    EXPECT_NE(differs("revolute", "<origin xyz=\"0.5 0\"/><axis xyz=\"0 0 1\"/>").find("another origin"),
              std::string::npos);
    EXPECT_NE(differs("revolute", "<origin xyz=\"0.5 0 0\" rpy=\"0.1 0 0\"/>").find("another origin"),
              std::string::npos);
    EXPECT_NE(differs("revolute", "<origin xyz=\"0.5 0 0\"/>").find("another axis"), std::string::npos);
    EXPECT_NE(differs("fixed", "<origin xyz=\"0.5 0 0\"/>").find("another kind"), std::string::npos);
    robot.joints[0].name = "elbow";
    EXPECT_NE(differs("revolute", "").find("lacks the joint elbow"), std::string::npos);
    EXPECT_EQ(description_differs("no XML", robot), "/robot_description is no URDF");
    EXPECT_EQ(description_differs("<robot><link/></robot>", robot), "/robot_description is no URDF");
}

}  // namespace
}  // namespace octoskin::bridge
