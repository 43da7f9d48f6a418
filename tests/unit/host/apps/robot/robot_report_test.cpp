#include "host/apps/robot/robot_report.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <nlohmann/json.hpp>
#include <string>

#include "host/apps/robot/body_picture.hpp"

namespace octoskin {
namespace {

/// One link with a mesh of a triangle and two capsules, one without a shape.
RobotFit robot() {
    RobotFit robot;
    robot.shapes.base_link = "base";
    robot.shapes.joints = {{"turn", "revolute", -1.0, 2.0}, {"spin", "continuous", {}, {}}};
    LinkBody arm{.link = "<arm> & co", .is_moving = true, .source = BodySource::visual, .shapes = "1 mesh"};
    arm.mesh = {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.2, 0}}, {{0, 1, 2}}};
    arm.fit = BodyFit{
        {{{0, 0, 0}, {0, 0.2, 0}, 0.01}, {{0, 0, 0}, {0.1, 0, 0}, 0.02}},
        {.excess_ratio = 0.25, .protrusion_p95_m = 0.01, .protrusion_p99_m = 0.02, .protrusion_max_m = 0.03}};
    robot.links = {{.link = "base"}, arm, {.link = "tip", .is_moving = true}};
    return robot;
}

TEST(RobotReport, has_each_joint_link_and_measure_as_json) {
    const auto json = robot_json(robot());
    EXPECT_EQ(json["joints"].size(), 2U);
    EXPECT_EQ(json["joints"][0]["upper"], 2.0);
    EXPECT_TRUE(json["joints"][1]["upper"].is_null());
    ASSERT_EQ(json["links"].size(), 3U);
    const auto& arm = json["links"][1];
    EXPECT_EQ(arm["body"], "visual");
    EXPECT_EQ(arm["capsules"], 2);
    EXPECT_EQ(arm["excess_ratio"], 0.25);
    EXPECT_EQ(arm["protrusion_max_m"], 0.03);
    EXPECT_TRUE(json["links"][0]["protrusion_max_m"].is_null());
    EXPECT_EQ(json["missing"], nlohmann::ordered_json::array({"tip"}));
}

TEST(RobotReport, has_a_line_for_each_link_with_a_body) {
    const std::string text = robot_text(robot());
    for (const char* part : {"joint turn: revolute from -1 to 2 rad", "joint spin: continuous", "2 capsules",
                             "0.25", "10 mm", "30 mm", "link tip"})
        EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(BodyPicture, is_xml_with_each_capsule_in_three_views) {
    const std::string svg = body_picture(robot());
    tinyxml2::XMLDocument xml;
    ASSERT_EQ(xml.Parse(svg.data(), svg.size()), tinyxml2::XML_SUCCESS);
    int meshes = 0;
    int capsules = 0;
    for (const auto* path = xml.FirstChildElement("svg")->FirstChildElement("path"); path != nullptr;
         path = path->NextSiblingElement("path"))
        (std::string(path->Attribute("class")) == "fit" ? capsules : meshes) += 1;
    EXPECT_EQ(meshes, 3);
    EXPECT_EQ(capsules, 6);
}

}  // namespace
}  // namespace octoskin
