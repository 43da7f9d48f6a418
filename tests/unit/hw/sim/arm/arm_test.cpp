// Forward and inverse kinematics. Oracle: the closed form of the Panda's modified Denavit-Hartenberg
// parameters (Craig's convention), written out here from Franka's published table.
#include "hw/sim/arm/arm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/hw/sim/arm/panda.hpp"

namespace octoskin::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::is_no_error;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::others_are;
using testing_support::what_is;

Arm read_panda() {
    auto arm = Arm::read(kPandaUrdf, "panda_link0", kPandaJoints);
    EXPECT_TRUE(arm) << arm.error().message();
    return std::move(*arm);
}

/// T_base_flange from a, d, alpha per joint: Rot_x(alpha) Trans_x(a) Rot_z(theta) Trans_z(d).
Eigen::Matrix4d denavit_hartenberg(const Eigen::VectorXd& q) {
    const double a[8] = {0, 0, 0, 0.0825, -0.0825, 0, 0.088, 0};
    const double d[8] = {0.333, 0, 0.316, 0, 0.384, 0, 0, 0.107};
    const int quarter_turns[8] = {0, -1, 1, 1, -1, 1, 1, 0};
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 8; ++i) {
        const double theta = i < 7 ? q[i] : 0.0;
        const double sin_alpha = quarter_turns[i], cos_alpha = quarter_turns[i] == 0 ? 1.0 : 0.0;
        const double c = std::cos(theta), s = std::sin(theta);
        Eigen::Matrix4d step;
        step << c, -s, 0, a[i],                                           //
            s * cos_alpha, c * cos_alpha, -sin_alpha, -d[i] * sin_alpha,  //
            s * sin_alpha, c * sin_alpha, cos_alpha, d[i] * cos_alpha, 0, 0, 0, 1;
        T = T * step;
    }
    return T;
}

TEST(ArmForward, equals_the_denavit_hartenberg_closed_form_in_random_postures) {
    const Arm arm = read_panda();
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> angle(-3.0, 3.0);
    for (int i = 0; i < 1000; ++i) {
        const Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(7, [&] { return angle(random); });
        const auto poses = arm.forward(q);
        EXPECT_LE((poses.at("panda_link8").matrix() - denavit_hartenberg(q)).cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_LE((arm.forward(q, "panda_link8").matrix() - denavit_hartenberg(q)).cwiseAbs().maxCoeff(),
                  1e-14);
    }
}

TEST(ArmForward, puts_the_upright_arm_where_its_link_lengths_add_up) {
    const Arm arm = read_panda();
    const auto poses = arm.forward(Eigen::VectorXd::Zero(7));
    EXPECT_EQ(poses.size(), 9u);
    EXPECT_NEAR((poses.at("panda_link0").translation() - Eigen::Vector3d(0, 0, 0)).norm(), 0.0, 1e-15);
    EXPECT_NEAR((poses.at("panda_link4").translation() - Eigen::Vector3d(0.0825, 0, 0.649)).norm(), 0.0,
                1e-14);
    EXPECT_NEAR((poses.at("panda_link8").translation() - Eigen::Vector3d(0.088, 0, 0.926)).norm(), 0.0,
                1e-14);
}

TEST(ArmForward, a_joint_that_mimics_another_moves_with_it) {
    const testing_support::ScratchFolder folder;
    const auto urdf = folder.write(
        "gripper.urdf",
        "<robot name=\"gripper\"><link name=\"base\"/><link name=\"hand\"/><link name=\"left\"/><link "
        "name=\"right\"/>"
        "<joint name=\"turn\" type=\"revolute\"><parent link=\"base\"/><child link=\"hand\"/><axis xyz=\"0 0 "
        "1\"/><limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>"
        "<joint name=\"open\" type=\"prismatic\"><parent link=\"hand\"/><child link=\"left\"/><axis xyz=\"0 "
        "1 "
        "0\"/><limit lower=\"0\" upper=\"0.1\" effort=\"1\" velocity=\"1\"/></joint>"
        "<joint name=\"mirrored\" type=\"prismatic\"><parent link=\"hand\"/><child link=\"right\"/><axis "
        "xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/><mimic joint=\"open\" "
        "multiplier=\"-1\" offset=\"-0.01\"/></joint></robot>");
    const auto arm = Arm::read(urdf, "base", {"open", "turn"});
    ASSERT_TRUE(arm) << arm.error().message();
    EXPECT_EQ(arm->joint_count(), 2U);
    const auto poses = arm->forward(Eigen::Vector2d(0.05, 1.0));
    const Eigen::Vector3d across(-std::sin(1.0), std::cos(1.0), 0.0);
    EXPECT_NEAR((poses.at("left").translation() - 0.05 * across).norm(), 0.0, 1e-15);
    EXPECT_NEAR((poses.at("right").translation() + 0.06 * across).norm(), 0.0, 1e-15);
    // The inverse goes through the joint that is followed.
    Eigen::Isometry3d goal = Eigen::Isometry3d::Identity();
    goal.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    goal.translation() = -0.08 * Eigen::Vector3d(-std::sin(0.5), std::cos(0.5), 0.0);
    const auto position = arm->inverse("right", goal, Eigen::Vector2d(0.02, 0.3));
    ASSERT_TRUE(position);
    EXPECT_NEAR((*position)[0], 0.07, 1e-6);
    EXPECT_NEAR((*position)[1], 0.5, 1e-6);
}

TEST(ArmForward, starts_at_the_base_link_it_is_given) {
    const auto arm = Arm::read(kPandaUrdf, "panda_link6", {"panda_joint7"});
    ASSERT_TRUE(arm) << arm.error().message();
    const auto poses = arm->forward(Eigen::VectorXd::Zero(1));
    EXPECT_EQ(poses.size(), 3u);
    EXPECT_NEAR((poses.at("panda_link8").translation() - Eigen::Vector3d(0.088, -0.107, 0)).norm(), 0.0,
                1e-14);
}

TEST(ArmInverse, reaches_random_reachable_poses_from_a_posture_nearby) {
    const Arm arm = read_panda();
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> offset(-0.15, 0.15);
    Eigen::VectorXd start(7);
    start << 0.1, -0.785, 0.2, -2.356, 0.1, 1.571, 0.785;
    for (int i = 0; i < 200; ++i) {
        const Eigen::VectorXd goal = start + Eigen::VectorXd::NullaryExpr(7, [&] { return offset(random); });
        const Eigen::Matrix4d wanted = denavit_hartenberg(goal);
        const auto q = arm.inverse("panda_link8", Eigen::Isometry3d(wanted), start);
        ASSERT_TRUE(q);
        EXPECT_LE((denavit_hartenberg(*q) - wanted).cwiseAbs().maxCoeff(), 2e-7);
    }
}

TEST(ArmInverse, has_no_answer_for_a_pose_out_of_reach_or_a_link_that_is_not_there) {
    const Arm arm = read_panda();
    Eigen::VectorXd start(7);
    start << 0, -0.785, 0, -2.356, 0, 1.571, 0.785;
    Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
    far.translation().x() = 2.0;
    EXPECT_FALSE(arm.inverse("panda_link8", far, start));
    EXPECT_FALSE(arm.inverse("panda_hand", Eigen::Isometry3d::Identity(), start));
}

TEST(ArmLimits, names_the_first_joint_outside_its_limits) {
    const Arm arm = read_panda();
    Eigen::VectorXd q(7);
    q << 0, -0.785, 0, -2.356, 0, 1.571, 0.785;
    EXPECT_FALSE(arm.joint_outside_limits(q));
    q[3] = 0.0;
    EXPECT_EQ(arm.joint_outside_limits(q).value().joint, "panda_joint4");
    q[1] = std::nan("");
    EXPECT_EQ(arm.joint_outside_limits(q).value().joint, "panda_joint2");
}

TEST(ArmRead, refuses_a_base_link_or_joints_that_the_robot_does_not_have) {
    const auto no_base = Arm::read(kPandaUrdf, "table", kPandaJoints);
    ASSERT_FALSE(no_base);
    EXPECT_THAT(no_base.error(), AllOf(code_is(ErrorCode::unknown_name), what_is(HasSubstr("link 'table'"))));
    auto joints = kPandaJoints;
    joints[2] = "elbow";
    const auto no_joint = Arm::read(kPandaUrdf, "panda_link0", joints);
    ASSERT_FALSE(no_joint);
    EXPECT_THAT(no_joint.error(), AllOf(key_is("joint panda_joint3"), others_are("")));
    joints = kPandaJoints;
    joints.push_back("panda_flange_joint");
    EXPECT_FALSE(Arm::read(kPandaUrdf, "panda_link0", joints));
    joints.back() = "panda_joint1";
    EXPECT_FALSE(Arm::read(kPandaUrdf, "panda_link0", joints)) << "a joint named twice";
    const auto no_file = Arm::read("no-such.urdf", "panda_link0", kPandaJoints);
    ASSERT_FALSE(no_file);
    EXPECT_THAT(no_file.error(), AllOf(code_is(ErrorCode::not_found), file_is("no-such.urdf")));
}

TEST(ArmRead, refuses_joints_it_cannot_move_by_name_and_line) {
    const testing_support::ScratchFolder scratch;
    const auto file = scratch / "joints.urdf";
    const auto read = [&](const std::string& joint) {
        std::ofstream(file) << "<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"b\"/>\n"
                            << joint << "\n</robot>\n";
        return error_in(Arm::read(file, "a", {"j"}));
    };
    EXPECT_THAT(read(R"(<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>)"),
                is_no_error());
    EXPECT_THAT(read(R"(<joint name="j" type="prismatic"><parent link="a"/><child link="b"/>
                      <limit lower="0" upper="1" effort="1" velocity="1"/></joint>)"),
                is_no_error());
    EXPECT_THAT(read(R"(<joint name="j" type="planar"><parent link="a"/><child link="b"/></joint>)"),
                AllOf(code_is(ErrorCode::unsupported), file_is("joints.urdf"), line_is(4),
                      what_is(HasSubstr("revolute"))));
    EXPECT_THAT(read(R"(<joint name="j" type="continuous"><parent link="a"/><child link="b"/>
                        <axis xyz="0 0 2"/></joint>)"),
                AllOf(code_is(ErrorCode::bad_value), key_is("joint j"), what_is(HasSubstr("length 1"))));
    EXPECT_THAT(
        read(R"(<link name="c"/><joint name="j" type="planar"><parent link="a"/><child link="b"/></joint>
                        <joint name="k" type="continuous"><parent link="b"/><child link="c"/></joint>)"),
        AllOf(file_is("joints.urdf"), line_is(4), key_is("joint j"),
              others_are("1 more refused: joint k (line 5, not named)")));
}

TEST(ArmForward, slides_a_prismatic_joint_along_its_axis) {
    const testing_support::ScratchFolder scratch;
    const auto file = scratch / "slide.urdf";
    std::ofstream(file) << R"(<robot name="r"><link name="a"/><link name="b"/>
        <joint name="j" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/>
        <axis xyz="1 0 0"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>)";
    const auto arm = Arm::read(file, "a", {"j"});
    ASSERT_TRUE(arm) << arm.error().message();
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.25);
    EXPECT_NEAR((arm->forward(q, "b").translation() - Eigen::Vector3d(1.0, 0.25, 0.0)).norm(), 0.0, 1e-15);
    Eigen::Isometry3d wanted = arm->forward(q, "b");
    const auto found = arm->inverse("b", wanted, Eigen::VectorXd::Zero(1));
    ASSERT_TRUE(found);
    EXPECT_NEAR((*found)[0], 0.25, 2e-7);
}

}  // namespace
}  // namespace octoskin::sim
