#include "hw/rigfile/fitted_urdf.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <string>

#include "hw/rigfile/link_shapes.hpp"
#include "hw/rigfile/urdf_rotation.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using Eigen::Vector3d;
using testing_support::ScratchFolder;

constexpr const char* kArm = R"(<robot name="r">
<link name="base"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.1"/>
  <axis xyz="0 0 1"/><limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
<link name="upper">
  <collision><origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><geometry><mesh filename="package://arm/a.stl" scale="0.001 0.001 -0.001"/></geometry></collision>
  <collision><geometry><cylinder radius="0.05" length="0.2"/></geometry></collision>
  <collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>
  <collision><geometry><capsule radius="0.02" length="0.1"/></geometry></collision>
  <visual><geometry><mesh filename="a.dae"/></geometry></visual>
  <visual><geometry><sphere radius="0.1"/></geometry></visual>
</link>
<joint name="fix" type="fixed"><parent link="upper"/><child link="tool"/></joint>
<link name="tool"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>
</robot>)";

TEST(LinkShapes, are_what_the_file_says) {
    const ScratchFolder folder;
    const auto robot = read_link_shapes(folder.write("arm.urdf", kArm), "");
    ASSERT_TRUE(robot) << robot.error().message();
    EXPECT_EQ(robot->base_link, "base");
    ASSERT_EQ(robot->links.size(), 3U);
    EXPECT_FALSE(robot->links[0].is_moving);
    EXPECT_TRUE(robot->links[2].is_moving);  // behind a fixed joint behind a moving one
    const auto& shapes = robot->links[1].collisions;
    ASSERT_EQ(shapes.size(), 4U);
    EXPECT_EQ(shapes[0].kind, ShapeKind::mesh);
    EXPECT_EQ(shapes[0].mesh, "package://arm/a.stl");
    EXPECT_EQ(shapes[0].size, Vector3d(0.001, 0.001, -0.001));
    EXPECT_EQ(shapes[0].T_link_shape.translation(), Vector3d(1, 2, 3));
    EXPECT_EQ(shapes[2].size, Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(shapes[3].kind, ShapeKind::capsule);
    EXPECT_EQ(shapes[3].length_m, 0.1);
    EXPECT_EQ(robot->links[1].visuals.size(), 2U);
    ASSERT_EQ(robot->joints.size(), 1U);
    EXPECT_EQ(robot->joints[0].upper, 2.0);
}

TEST(LinkShapes, refuse_a_place_or_a_size_that_is_no_number) {
    const ScratchFolder folder;
    for (const auto& [good, bad] : std::vector<std::pair<std::string, std::string>>{
             {"xyz=\"1 2 3\"", "xyz=\"1 2\""},
             {"0.1 0.2 0.3\"/></geometry>", "0.1 -0.2 0.3\"/></geometry>"},
             {"-0.001\"", "0\""}}) {
        std::string text = kArm;
        text.replace(text.find(good), good.size(), bad);
        const auto robot = read_link_shapes(folder.write("bad.urdf", text), "");
        ASSERT_FALSE(robot) << bad;
    }
    EXPECT_EQ(read_link_shapes(folder.write("arm.urdf", kArm), "none").error().code, ErrorCode::unknown_name);
}

TEST(LinkShapes, refuse_a_visual_that_cannot_be_read_where_the_body_is_made_of_it) {
    const ScratchFolder folder;
    const auto read = [&](const std::string& collision, const std::string& geometry) {
        return read_link_shapes(
            folder.write("arm.urdf",
                         "<robot name=\"r\"><link name=\"b\"/><joint name=\"j\" type=\"revolute\"><parent "
                         "link=\"b\"/><child link=\"l\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" "
                         "velocity=\"1\"/></joint>\n<link name=\"l\">" +
                             collision + "\n<visual><geometry>" + geometry +
                             "</geometry></visual></link></robot>"),
            "");
    };
    const std::string empty_box = "<collision><geometry><box size=\"0 0 0\"/></geometry></collision>";
    for (const std::string bad :
         {"<mesh filename=\"a.stl\" scale=\"nan 1 1\"/>", "<mesh/>", "<torus/>", ""}) {
        for (const std::string& collision : {std::string(), empty_box}) {
            const auto refused = read(collision, bad);
            ASSERT_FALSE(refused) << bad;
            EXPECT_EQ(refused.error().code, ErrorCode::bad_value) << bad;
            EXPECT_EQ(refused.error().line, 3) << bad;
        }
        EXPECT_TRUE(read("<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>", bad)) << bad;
    }
}

TEST(LinkShapes, xacro_gets_the_command_that_expands_it) {
    const ScratchFolder folder;
    const auto file =
        folder.write("arm.urdf.xacro", R"(<robot name="r"><xacro:include filename="x"/></robot>)");
    const auto robot = read_link_shapes(file, "");
    ASSERT_FALSE(robot);
    EXPECT_EQ(robot.error().code, ErrorCode::unsupported);
    EXPECT_NE(robot.error().remedy.find("`xacro " + file.string() + " > arm.urdf`"), std::string::npos);
}

TEST(UrdfRotation, of_a_quaternion_is_the_same_everywhere) {
    std::mt19937 random(6);
    std::normal_distribution<double> normal;
    for (int run = 0; run < 500; ++run) {
        Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
        if (run % 5 == 0)  // straight up and down: roll and yaw are one
            q = Eigen::AngleAxisd(normal(random), Vector3d::UnitZ()) *
                Eigen::AngleAxisd((run % 2 == 0 ? 0.5 : -0.5) * std::numbers::pi, Vector3d::UnitY()) *
                Eigen::AngleAxisd(normal(random), Vector3d::UnitX());
        const Eigen::Matrix3d rotation = q.normalized().toRotationMatrix();
        EXPECT_LT((rotation_of_rpy(rpy_of(rotation)) - rotation).norm(), 1e-7) << run;
    }
}

TEST(UrdfRotation, quat_xyzw_turns_a_body_and_is_refused_beside_rpy_or_without_length_one) {
    const ScratchFolder folder;
    const auto with = [&](const std::string& origin) {
        return read_capsules(
            folder.write("q.urdf", "<robot name=\"r\" version=\"1.2\"><link name=\"l\"><collision><origin " +
                                       origin +
                                       "/><geometry><cylinder radius=\"0.1\" "
                                       "length=\"2\"/></geometry></collision></link></robot>"),
            {});
    };
    const auto turned = with("quat_xyzw=\"0.70710678 0 0 0.70710678\"");  // 90 degrees about x
    ASSERT_TRUE(turned) << turned.error().message();
    EXPECT_LT((turned->front().p_link_b - Vector3d(0, -1, 0)).norm(), 1e-6);
    for (const char* bad : {"quat_xyzw=\"0 0 0 1\" rpy=\"0 0 0\"", "quat_xyzw=\"0 0 0 2\"",
                            "quat_xyzw=\"0 0 1\"", "quat_xyzw=\"nan 0 0 1\""}) {
        const auto refused = with(bad);
        ASSERT_FALSE(refused) << bad;
        EXPECT_EQ(refused.error().code, ErrorCode::bad_value);
        EXPECT_EQ(refused.error().line, 1);
    }
}

TEST(FittedUrdf, comes_back_as_the_capsules_that_were_written) {
    const ScratchFolder folder;
    std::mt19937 random(8);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    for (int run = 0; run < 50; ++run) {
        std::vector<Capsule> body;
        for (int i = 0; i < 5; ++i) {
            const Vector3d a(uniform(random), uniform(random), uniform(random));
            const Vector3d b(uniform(random), uniform(random), uniform(random));
            body.push_back({"upper", a, i == 0 ? a : b, 0.05 + 0.01 * i});
        }
        const auto text = urdf_with_bodies("arm.urdf", kArm, {{"upper", {body}}});
        ASSERT_TRUE(text);
        EXPECT_EQ(text->find("a.stl"), std::string::npos);
        EXPECT_NE(text->find("a.dae"), std::string::npos);  // a <visual>, with which the body is compared
        const auto read = read_capsules(folder.write("fitted.urdf", *text), {});
        ASSERT_TRUE(read) << read.error().message();
        // And the cylinder, the capsule and the tool's sphere, which stay.
        ASSERT_EQ(read->size(), body.size() + 3);
        for (const Capsule& wanted : body) {
            const bool is_found = std::ranges::any_of(*read, [&](const Capsule& found) {
                const double grown_m = found.radius_m - wanted.radius_m;
                return (found.p_link_a - wanted.p_link_a).norm() < 1e-6 &&
                       (found.p_link_b - wanted.p_link_b).norm() < 1e-6 && grown_m >= 1e-6 - 1e-12 &&
                       grown_m < 3e-6;
            });
            EXPECT_TRUE(is_found) << "run " << run;
        }
        // Fitted capsules reach beyond the link: only the tool's sphere is certain.
        EXPECT_EQ(read_inner_capsules(folder / "fitted.urdf")->size(), 1U);
    }
}

TEST(FittedUrdf, makes_a_collision_of_the_visuals_that_the_body_is_made_of) {
    const ScratchFolder folder;
    std::string text = kArm;
    for (auto at = text.find("<collision>"); at < text.find("<visual>"); at = text.find("<collision>"))
        text.erase(at, text.find("</collision>", at) + 12 - at);
    const std::vector<Capsule> body{{"upper", {0, 0, 0.5}, {0, 0, 1}, 0.2}};
    const auto fitted = urdf_with_bodies("arm.urdf", text, {{"upper", {body, true}}});
    ASSERT_TRUE(fitted);
    EXPECT_EQ(fitted->find("a.dae"), std::string::npos);
    const auto read = read_capsules(folder.write("fitted.urdf", *fitted), {});
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->size(), 3U);  // with the sphere, and that of the tool
}

}  // namespace
}  // namespace octoskin::rig
