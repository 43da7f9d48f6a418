#include "host/io/robot/robot_fit.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "host/core/body_fit/coverage.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/hw/mesh/shape_files.hpp"

namespace octoskin {
namespace {

constexpr double kEdge_m = 0.001;

std::string link(const std::string& name, const std::string& content) {
    return "<link name=\"" + name + "\">" + content + "</link>\n";
}

std::string joint(const std::string& parent, const std::string& child, const std::string& type) {
    return "<joint name=\"to_" + child + "\" type=\"" + type + "\"><parent link=\"" + parent +
           "\"/><child link=\"" + child +
           "\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>\n";
}

std::string mesh(const std::string& tag, const std::string& file, const std::string& more = "") {
    return "<" + tag + ">" + more + "<geometry><mesh filename=\"" + file +
           "\" scale=\"0.2 0.2 0.2\"/></geometry></" + tag + ">";
}

Result<RobotFit, Error> fitted(const FilePlace& urdf, const std::string& base_link = {}) {
    const auto robot = read_robot_text(urdf, base_link);
    return robot ? fit_robot(*robot, {}) : unexpected(robot.error());
}

// HEBI's kits have a box of 1 mm where the tool's frame is.
TEST(RobotFit, takes_a_visual_mark_for_a_frame_but_no_collision) {
    const testing_support::ScratchFolder folder;
    folder.write("a.stl", testing_support::wedge_stl());
    const auto urdf_with = [&](const std::string& tag) {
        return folder.write(
            "arm.urdf", "<robot name=\"r\">" + link("base", "") + link("upper", mesh("collision", "a.stl")) +
                            link("tip", "<" + tag +
                                            "><geometry><box size=\"0.001 0.001 0.001\"/>"
                                            "</geometry></" +
                                            tag + ">") +
                            joint("base", "upper", "revolute") + joint("upper", "tip", "fixed") + "</robot>");
    };
    const auto mark = fitted(urdf_with("visual"));
    ASSERT_TRUE(mark) << mark.error().message();
    EXPECT_TRUE(mark->links.at(1).fit.has_value());
    EXPECT_FALSE(mark->links.at(2).fit.has_value());
    const auto body = fitted(urdf_with("collision"));
    ASSERT_FALSE(body);
    EXPECT_EQ(body.error().code, ErrorCode::out_of_range);
}

TEST(RobotFit, takes_collisions_and_the_visual_of_a_moving_link_without_one) {
    const testing_support::ScratchFolder folder;
    folder.write("a.stl", testing_support::wedge_stl());
    folder.write("b.dae", testing_support::wedge_dae("Z_UP", 0.001));
    const auto urdf = folder.write(
        "arm.urdf",
        "<robot name=\"r\">" + link("base", mesh("visual", "a.stl")) +
            link("upper", mesh("collision", "a.stl", "<origin xyz=\"0.1 0 0\" rpy=\"0 0 1\"/>") +
                              mesh("visual", "b.dae") +
                              "<collision><geometry><sphere radius=\"0.05\"/></geometry></collision>") +
            link("fore", mesh("visual", "b.dae")) + link("tip", "") + joint("base", "upper", "revolute") +
            joint("upper", "fore", "fixed") + joint("fore", "tip", "fixed") + "</robot>");
    const auto robot = fitted(urdf);
    ASSERT_TRUE(robot) << robot.error().message();
    ASSERT_EQ(robot->links.size(), 4U);
    EXPECT_EQ(robot->links[0].source, BodySource::nothing);  // it does not move
    EXPECT_EQ(robot->links[1].source, BodySource::collision);
    EXPECT_EQ(robot->links[1].kept, 1U);
    EXPECT_EQ(robot->links[1].shapes, "1 mesh, 1 sphere");
    EXPECT_EQ(robot->links[2].source, BodySource::visual);
    EXPECT_EQ(robot->links[3].source, BodySource::nothing);
    // The origin turns by one radian and moves, after the scale.
    const Eigen::Vector3d top = robot->links[1].mesh.vertices[robot->links[1].mesh.vertices.size() - 1];
    EXPECT_NEAR((top - Eigen::Vector3d(0.1, 0, 0)).norm(), 0.2 * std::hypot(0.125, 1.0), 1e-6);

    // The new file is a whole robot by itself, and its capsules cover the meshes.
    const auto alone = folder.write("fitted.urdf", robot->urdf);
    std::filesystem::remove(folder / "a.stl");
    std::filesystem::remove(folder / "b.dae");
    const auto capsules = rig::read_capsules(alone, {});
    ASSERT_TRUE(capsules) << capsules.error().message();
    for (const std::size_t i : {1U, 2U}) {
        std::vector<PosedCapsule> body;
        for (const rig::Capsule& capsule : *capsules)
            if (capsule.link == robot->links[i].link)
                body.push_back({capsule.p_link_a, capsule.p_link_b, capsule.radius_m});
        EXPECT_EQ(body.size(), robot->links[i].fit->capsules.size() + robot->links[i].kept);
        EXPECT_FALSE(first_uncovered(robot->links[i].mesh, body, kCoveredWithin_m, kEdge_m));
    }
}

TEST(RobotFit, names_all_meshes_that_are_missing_in_one_error) {
    const testing_support::ScratchFolder folder;
    const auto urdf = folder.write("arm.urdf", "<robot name=\"r\">" +
                                                   link("base", mesh("collision", "package://arm/a.stl")) +
                                                   link("upper", mesh("collision", "b.stl")) +
                                                   joint("base", "upper", "revolute") + "</robot>");
    const auto robot = fitted(urdf);
    ASSERT_FALSE(robot);
    EXPECT_EQ(robot.error().code, ErrorCode::not_found);
    EXPECT_EQ(robot.error().file, urdf);
    const std::string message = robot.error().message();
    for (const char* part :
         {"link base", "link upper", "package://arm/a.stl", "b.stl", "--package-path arm="})
        EXPECT_NE(message.find(part), std::string::npos) << part << " in " << message;
}

TEST(RobotFit, refuses_a_mesh_in_millimetres) {
    const testing_support::ScratchFolder folder;
    folder.write("a.stl", testing_support::wedge_stl());
    const auto urdf =
        folder.write("arm.urdf",
                     "<robot name=\"r\"><link name=\"l\"><collision><geometry><mesh filename=\"a.stl\" "
                     "scale=\"1000 1000 1000\"/></geometry></collision></link></robot>");
    EXPECT_EQ(fitted(urdf).error().code, ErrorCode::too_large);
}

TEST(RobotFit, refuses_a_mesh_that_is_scaled_twice_or_beyond_all_numbers) {
    const testing_support::ScratchFolder folder;
    folder.write("a.stl", testing_support::wedge_stl());
    for (const auto& [scale, code] :
         {std::pair{"1e-4", ErrorCode::out_of_range}, std::pair{"1e308", ErrorCode::too_large}}) {
        const std::string three = std::string(scale) + " " + scale + " " + scale;
        const auto urdf = folder.write(
            "arm.urdf",
            "<robot name=\"r\"><link name=\"l\"><collision><origin rpy=\"1 2 3\"/><geometry><mesh "
            "filename=\"a.stl\" scale=\"" +
                three + "\"/></geometry></collision></link></robot>");
        const auto robot = fitted(urdf);
        ASSERT_FALSE(robot) << scale;
        EXPECT_EQ(robot.error().code, code) << scale;
        EXPECT_EQ(robot.error().key, "link l") << scale;
    }
}

TEST(RobotFit, a_box_of_no_size_is_no_body_and_leaves_the_visual_to_be_compared) {
    const testing_support::ScratchFolder folder;
    folder.write("a.stl", testing_support::wedge_stl());
    const std::string empty = "<collision><geometry><box size=\"0 0 0\"/></geometry></collision>";
    const auto urdf = folder.write("arm.urdf", "<robot name=\"r\">" + link("base", "") +
                                                   link("upper", empty + mesh("visual", "a.stl")) +
                                                   link("frame", empty) + joint("base", "upper", "revolute") +
                                                   joint("upper", "frame", "fixed") + "</robot>");
    const auto robot = fitted(urdf);
    ASSERT_TRUE(robot) << robot.error().message();
    EXPECT_EQ(robot->links[1].source, BodySource::visual);
    EXPECT_EQ(robot->links[2].source, BodySource::nothing);
    const auto capsules = rig::read_capsules(folder.write("fitted.urdf", robot->urdf), {});
    ASSERT_TRUE(capsules) << capsules.error().message();
    EXPECT_EQ(capsules->size(), robot->links[1].fit->capsules.size());
}

TEST(RobotFit, fits_a_box_and_leaves_cylinders_as_they_are) {
    const testing_support::ScratchFolder folder;
    const auto urdf =
        folder.write("arm.urdf",
                     "<robot name=\"r\"><link name=\"l\"><collision><geometry><box size=\"0.1 0.1 0.3\"/>"
                     "</geometry></collision><collision><geometry><cylinder radius=\"0.1\" length=\"0.2\"/>"
                     "</geometry></collision></link></robot>");
    const auto robot = fitted(urdf, "l");
    ASSERT_TRUE(robot) << robot.error().message();
    EXPECT_EQ(robot->links[0].kept, 1U);
    EXPECT_EQ(robot->links[0].triangles, 12U);
    EXPECT_TRUE(robot->links[0].fit);
}

TEST(RobotFit, refuses_more_than_two_million_triangles_of_a_link_by_name) {
    const testing_support::ScratchFolder folder;
    std::string stl(80, '\0');
    const std::uint32_t count = 1'000'001;
    stl.append(reinterpret_cast<const char*>(&count), 4);
    const std::array<float, 12> triangle{0, 0, 1, 0, 0, 0, 0.1F, 0, 0, 0, 0.1F, 0};
    std::string record(reinterpret_cast<const char*>(triangle.data()), 48);
    record += std::string(2, '\0');
    for (std::uint32_t i = 0; i < count; ++i) stl += record;
    folder.write("a.stl", stl);
    const auto urdf = folder.write(
        "arm.urdf", "<robot name=\"r\">" +
                        link("l", mesh("collision", "a.stl") + mesh("collision", "a.stl")) + "</robot>");
    const auto robot = fitted(urdf);
    ASSERT_FALSE(robot);
    EXPECT_EQ(robot.error().code, ErrorCode::too_large);
    EXPECT_EQ(robot.error().key, "link l");
    EXPECT_EQ(robot.error().value, "2000002 or more");
}

TEST(RobotFit, gives_the_same_box_elsewhere_the_same_fit) {
    const testing_support::ScratchFolder folder;
    const auto box = [](const std::string& origin) {
        return "<collision>" + origin + "<geometry><box size=\"0.1 0.1 0.3\"/></geometry></collision>";
    };
    const auto urdf =
        folder.write("arm.urdf", "<robot name=\"r\">" + link("base", box("")) +
                                     link("upper", box("<origin xyz=\"0 0 1\" rpy=\"1 0 0\"/>")) +
                                     joint("base", "upper", "revolute") + "</robot>");
    const auto robot = fitted(urdf);
    ASSERT_TRUE(robot) << robot.error().message();
    ASSERT_EQ(robot->links[0].fit->capsules.size(), robot->links[1].fit->capsules.size());
    const Eigen::Isometry3d T_upper_box =
        Eigen::Translation3d(0, 0, 1) * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX());
    for (std::size_t i = 0; i < robot->links[0].fit->capsules.size(); ++i) {
        const PosedCapsule& first = robot->links[0].fit->capsules[i];
        const PosedCapsule& second = robot->links[1].fit->capsules[i];
        EXPECT_LT((T_upper_box * first.p_a - second.p_a).norm(), 1e-12);
        EXPECT_LT((T_upper_box * first.p_b - second.p_b).norm(), 1e-12);
        EXPECT_EQ(first.radius_m, second.radius_m);
    }
}

}  // namespace
}  // namespace octoskin
