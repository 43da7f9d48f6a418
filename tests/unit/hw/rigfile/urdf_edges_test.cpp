// Robot descriptions as people have them: what does not count refuses no robot, and what does is named with
// its line and the remedy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <urdf_model/joint.h>
#include <urdf_model/link.h>
#include <urdf_model/model.h>

#include <filesystem>
#include <string>

#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/rigfile/urdf_document.hpp"
#include "hw/rigfile/xacro_remedy.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::others_are;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

const std::filesystem::path kSource = OCTOSKIN_SOURCE_DIR;

class UrdfEdges : public testing::Test {
  protected:
    Result<UrdfDocument, Error> read(const std::string& text) {
        return UrdfDocument::read(folder_.write("arm.urdf", text));
    }
    /// Line 1, then link a with what is in it on line 2, then link b and the joint between them.
    static std::string arm(const std::string& in_link, const std::string& in_joint = "",
                           const std::string& in_robot = "") {
        return "<robot name=\"r\">" + in_robot + "\n<link name=\"a\">" + in_link +
               "</link>\n<link name=\"b\"/>\n<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/>"
               "<child link=\"b\"/>" +
               in_joint +
               "<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>"
               "\n</robot>\n";
    }

    testing_support::ScratchFolder folder_;
};

TEST_F(UrdfEdges, what_does_not_count_refuses_no_robot) {
    const char* const in_links[] = {
        "<inertial/>",
        "<inertial><mass value=\"1\"/></inertial>",
        "<inertial><mass value=\"heavy\"/><inertia ixx=\"nan\"/></inertial>",
        "<inertial><origin xyz=\"0,0,0\"/><mass value=\"${m}\"/></inertial>",
        "<inertial><xacro:mass/></inertial>",
        "<visual/>",
        "<visual><geometry/></visual>",
        "<visual><geometry><capsule radius=\"0.05\" length=\"0.3\"/></geometry></visual>",
        "<visual><geometry><mesh filename=\"a.stl\" scale=\"0.001\"/></geometry></visual>",
        "<visual><geometry><mesh/></geometry></visual>",
        "<visual><geometry><box size=\"0.1 0.1\"/></geometry></visual>",
        "<visual><geometry><box size=\"${s} 0.1 0.1\"/></geometry></visual>",
        "<visual><geometry><sphere radius=\"nan\"/></geometry></visual>",
        "<visual><geometry><cylinder radius=\"1\"/></geometry></visual>",
        "<visual><origin xyz=\"0 0\"/><geometry><sphere radius=\"1\"/></geometry></visual>",
        "<visual><origin rpy=\"0 0 x\"/><geometry><sphere radius=\"1\"/></geometry></visual>",
        "<visual><geometry><sphere radius=\"1\"/></geometry><material name=\"m\"/></visual>",
        "<contact/><self_collision_checking/><verbose value=\"x\"/>",
    };
    for (const char* in_link : in_links) {
        const auto document = read(arm(in_link));
        ASSERT_TRUE(document) << in_link << ": " << document.error().message();
        const bool has_visual = std::string_view(in_link).starts_with("<visual");
        EXPECT_EQ(document->model().getLink("a")->visual_array.size(), has_visual ? 1U : 0U) << in_link;
    }
    const std::string twice = "<material name=\"m\"><color rgba=\"1 1 1 1\"/></material>";
    for (const std::string& in_robot :
         {twice + twice, std::string("<material/>"), std::string("<transmission/>"),
          std::string("<gazebo><plugin name=\"${x}\"/></gazebo>")})
        EXPECT_TRUE(read(arm("", "", in_robot))) << in_robot;
    for (const char* in_joint : {"<dynamics damping=\"x\"/>", "<calibration rising=\"x\"/>",
                                 "<safety_controller k_velocity=\"x\"/>"})
        EXPECT_TRUE(read(arm("", in_joint))) << in_joint;
    EXPECT_TRUE(read("<robot name=\"r\" version=\"1.2\"><link name=\"a\"/></robot>"));
}

TEST_F(UrdfEdges, a_visual_keeps_the_size_that_it_has) {
    const auto document = read(arm(
        "<visual name=\"v\"><origin xyz=\"1 2 3\"/><geometry><box size=\"0.1 0.2 0.3\"/></geometry></visual>"
        "<visual><geometry><cylinder radius=\"0.1\" length=\"0.4\"/></geometry></visual>"));
    ASSERT_TRUE(document) << document.error().message();
    const auto& visuals = document->model().getLink("a")->visual_array;
    ASSERT_EQ(visuals.size(), 2U);
    EXPECT_EQ(visuals[0]->origin.position.z, 3.0);
    EXPECT_EQ(dynamic_cast<const urdf::Box&>(*visuals[0]->geometry).dim.y, 0.2);
    EXPECT_EQ(dynamic_cast<const urdf::Cylinder&>(*visuals[1]->geometry).length, 0.4);
}

TEST_F(UrdfEdges, what_counts_refuses_it_still) {
    const std::string box = "<geometry><box size=\"0.1 0.1\"/></geometry>";
    EXPECT_FALSE(read(arm("<collision>" + box + "</collision>")));
    EXPECT_FALSE(read(arm("", "<origin xyz=\"0 0\"/>")));
}

TEST_F(UrdfEdges, what_xacro_has_not_expanded_is_named_with_its_line) {
    struct Case {
        std::string text;
        int line;
    };
    const std::string sphere = "<geometry><sphere radius=\"${r}\"/></geometry>";
    for (const Case& each :
         {Case{arm("", "<origin xyz=\"${l1} 0 0\"/>"), 4},
          Case{arm("", "\n<origin xyz=\"0 0 $(arg h)\"/>"), 5},
          Case{arm("<collision>\n" + sphere + "</collision>"), 3}, Case{arm("<xacro:body length=\"1\"/>"), 2},
          Case{arm("<collision><geometry><xacro:box/></geometry></collision>"), 2}}) {
        const auto document = read(each.text);
        ASSERT_FALSE(document) << each.text;
        EXPECT_THAT(document.error(), AllOf(code_is(ErrorCode::unsupported), line_is(each.line),
                                            remedy_is(HasSubstr("run `xacro "))));
        EXPECT_TRUE(has_its_fields(document.error()));
    }
}

// Some vendors' URDFs have a definition of xacro that no element uses.
TEST_F(UrdfEdges, definitions_of_xacro_that_no_element_uses_are_left_out) {
    const std::string arm_text = arm("");
    const std::size_t end = arm_text.rfind("</robot>");
    ASSERT_NE(end, std::string::npos);
    const auto with = [&](const std::string& element) {
        return read(arm_text.substr(0, end) + element + arm_text.substr(end));
    };
    EXPECT_TRUE(with("<xacro:property name=\"width\" value=\".2\"/>"));
    EXPECT_TRUE(with("<xacro:arg name=\"prefix\" default=\"${a}\"/>"));
    for (const char* element :
         {"<xacro:include filename=\"a.xacro\"/>", "<xacro:arm/>", "<xacro:macro name=\"m\"/>"}) {
        const auto document = with(element);
        ASSERT_FALSE(document) << element;
        EXPECT_THAT(document.error(), code_is(ErrorCode::unsupported));
    }
    EXPECT_FALSE(read(arm("", "<origin xyz=\"${width} 0 0\"/><!-- --><xacro:property name=\"width\"/>")));
}

TEST(XacroRemedy, can_be_pasted_into_a_shell) {
    EXPECT_THAT(xacro_remedy("/a/arm.urdf.xacro"), HasSubstr("run `xacro /a/arm.urdf.xacro > arm.urdf`"));
    EXPECT_THAT(xacro_remedy("/a/my arm.urdf.xacro"),
                HasSubstr("run `xacro '/a/my arm.urdf.xacro' > 'my arm.urdf'`"));
    EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
    EXPECT_EQ(shell_word(""), "''");
}

TEST_F(UrdfEdges, a_file_in_utf_16_is_named_as_such) {
    const std::string text = arm("");
    for (const bool is_big_endian : {false, true}) {
        for (const bool has_mark : {false, true}) {
            std::string wide = !has_mark ? "" : is_big_endian ? "\xFE\xFF" : "\xFF\xFE";
            for (const char c : text) wide += is_big_endian ? std::string{'\0', c} : std::string{c, '\0'};
            const auto document = read(wide);
            ASSERT_FALSE(document);
            EXPECT_THAT(document.error(), AllOf(code_is(ErrorCode::unsupported), what_is(HasSubstr("UTF-16")),
                                                remedy_is(HasSubstr("iconv -f UTF-16 -t UTF-8"))));
        }
    }
    EXPECT_TRUE(read("\xEF\xBB\xBF" + text)) << "the mark of UTF-8";
}

TEST_F(UrdfEdges, what_is_before_the_xml_declaration_is_named) {
    const auto document = read("<!-- made by hand -->\n<?xml version=\"1.0\"?>\n" + arm(""));
    ASSERT_FALSE(document);
    EXPECT_THAT(document.error(), AllOf(code_is(ErrorCode::bad_syntax), line_is(2),
                                        what_is(HasSubstr("remove the text before it"))));
    EXPECT_TRUE(read("<?xml version=\"1.0\"?>\n<!-- made by hand -->\n" + arm("")));
}

TEST_F(UrdfEdges, every_link_whose_body_cannot_be_taken_is_in_one_message) {
    const auto link = [](const std::string& name, const std::string& shape) {
        return "<link name=\"" + name + "\"><collision><geometry>" + shape +
               "</geometry></collision></link>\n";
    };
    const std::string mesh = "<mesh filename=\"package://p/a.stl\" scale=\"0.001\"/>";
    const auto file = folder_.write(
        "arm.urdf", "<robot name=\"r\">\n" + link("z", mesh) + link("sound", "<sphere radius=\"0.1\"/>") +
                        link("y", "<box size=\"1 1 1\"/>") + link("a", mesh) +
                        "<joint name=\"1\" type=\"fixed\"><parent link=\"z\"/><child link=\"sound\"/></joint>"
                        "<joint name=\"2\" type=\"fixed\"><parent link=\"z\"/><child link=\"y\"/></joint>"
                        "<joint name=\"3\" type=\"fixed\"><parent link=\"z\"/><child link=\"a\"/></joint>"
                        "</robot>\n");
    const auto refused = read_capsules(file, {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error(),
                AllOf(line_is(2), key_is("link z"), value_is("a mesh"),
                      others_are("2 more refused: link y (line 4, box), link a (line 5, mesh)")));
    const auto fitted = read_capsules(file, {}, BoxRule::fitted);
    ASSERT_FALSE(fitted);
    EXPECT_EQ(fitted.error().others, "1 more refused: link a (line 5, mesh)");
}

TEST_F(UrdfEdges, of_many_links_whose_body_cannot_be_taken_the_first_are_named_and_all_are_counted) {
    std::string links;
    for (int i = 0; i < 1000; ++i)
        links += "<link name=\"" + std::string(2000, 'x') + std::to_string(i) +
                 "\"><collision><geometry><capsule radius=\"1\"/></geometry></collision></link>\n";
    const auto refused =
        read_capsules(folder_.write("arm.urdf", "<robot name=\"r\">\n" + links + "</robot>"), {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().others,
                AllOf(StartsWith("999 more refused: "), EndsWith(", and 979 further ones")));
    EXPECT_LT(refused.error().reason().size(), 10'000U);
}

TEST_F(UrdfEdges, a_capsule_is_the_body_that_a_cylinder_and_two_spheres_are) {
    const std::string at = "<origin xyz=\"0.1 0 0.2\" rpy=\"0 1 0\"/>";
    const auto body_of = [&](const std::string& in_link) {
        return read_capsules(folder_.write("arm.urdf", arm(in_link)), {});
    };
    const auto capsule = body_of(
        "<collision>" + at + "<geometry><capsule radius=\"0.05\" length=\"0.3\"/></geometry></collision>");
    const auto cylinder = body_of(
        "<collision>" + at + "<geometry><cylinder radius=\"0.05\" length=\"0.3\"/></geometry></collision>");
    ASSERT_TRUE(capsule) << capsule.error().message();
    ASSERT_EQ(capsule->size(), 1U);
    EXPECT_EQ(capsule->front().radius_m, 0.05);
    EXPECT_EQ(capsule->front().p_link_a, cylinder->front().p_link_a);
    EXPECT_EQ(capsule->front().p_link_b, cylinder->front().p_link_b);
    for (const char* numbers : {"radius=\"0.05\"", "length=\"0.3\"", "radius=\"x\" length=\"0.3\"",
                                "radius=\"0.05\" length=\"inf\"", "radius=\"0.05 1\" length=\"0.3\""}) {
        const auto refused =
            body_of("<collision>\n<geometry><capsule " + std::string(numbers) + "/></geometry></collision>");
        ASSERT_FALSE(refused) << numbers;
        EXPECT_THAT(refused.error(), AllOf(code_is(ErrorCode::bad_value), line_is(3), key_is("link a")))
            << numbers;
    }
    EXPECT_EQ(body_of("<collision><geometry><capsule radius=\"-1\" length=\"0.3\"/></geometry></collision>")
                  .error()
                  .key,
              "link a");
}

TEST_F(UrdfEdges, every_shape_that_is_none_is_in_one_message_with_its_line) {
    const auto link = [](const std::string& name, const std::string& shape) {
        return "<link name=\"" + name + "\"><collision><geometry>\n" + shape +
               "</geometry></collision></link>\n";
    };
    const auto refused = read_capsules(
        folder_.write("arm.urdf", "<robot name=\"r\">\n" + link("z", "<ellipsoid radii=\"1 1 1\"/>") +
                                      link("y", "<capsule radius=\"1\"/>") + link("x", "<plane/>") +
                                      "</robot>\n"),
        {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(
        refused.error(),
        AllOf(code_is(ErrorCode::unsupported), line_is(3), key_is("link z"), value_is("a <ellipsoid>"),
              others_are("2 more refused: link y (line 5, capsule), link x (line 7, plane)")));
}

TEST_F(UrdfEdges, an_axis_of_length_1_to_three_digits_is_made_exact) {
    const std::string text = arm("");
    const std::string axis = "xyz=\"0 0 1\"/><limit";
    std::string four_digits = text;
    four_digits.replace(text.find(axis), axis.size(), "xyz=\"0 0.7071 0.7071\"/><limit");
    const auto document = read(four_digits);
    ASSERT_TRUE(document) << document.error().message();
    const urdf::Vector3& read_axis = document->model().getJoint("j")->axis;
    EXPECT_DOUBLE_EQ(read_axis.y * read_axis.y + read_axis.z * read_axis.z, 1.0);
    std::string two_digits = text;
    two_digits.replace(text.find(axis), axis.size(), "xyz=\"0 0.7 0.7\"/><limit");
    EXPECT_EQ(read(two_digits)->model().getJoint("j")->axis.y, 0.7)
        << "refused later, with what it should be";
}

class ElementNames : public testing::TestWithParam<std::string> {};

TEST_P(ElementNames, of_links_and_joints_work_in_a_rig) {
    const std::string& name = GetParam();
    const testing_support::ScratchFolder folder;
    const std::string joint = "joint " + name;
    folder.write("arm.urdf",
                 "<robot name=\"r\"><link name=\"base\"/><link name=\"" + name +
                     "\"><collision><geometry><sphere radius=\"0.05\"/></geometry></collision></link>"
                     "<joint name=\"" +
                     joint + "\" type=\"revolute\"><parent link=\"base\"/><child link=\"" + name +
                     "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" "
                     "velocity=\"1\"/></joint></robot>\n");
    const std::string base = (kSource / "tests/data/rigs/one-sensor.yaml").string();
    const auto file = folder.write(
        "rig.yaml", "extends: " + base + "\nname: named\nrobot: {urdf: arm.urdf, base_link: base, " +
                        "links_ignored_by_sensors: [\"" + name + "\"], link_padding_m: {\"" + name +
                        "\": 0.01}}\njoints: {names: [\"" + joint + "\"]}\nsensor_defaults: {link: \"" +
                        name + "\"}\n");
    const auto rig = read_rig(file);
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_EQ(rig->joint_names(), std::vector<std::string>{joint});
    EXPECT_EQ(rig->links_ignored_by_sensors, std::vector<std::string>{name});
    EXPECT_EQ(rig->link_padding_m.at(name), 0.01);
    const auto again = read_rig(folder.write("again.yaml", canonical_text(*rig, "arm.urdf")));
    ASSERT_TRUE(again) << again.error().message();
    EXPECT_EQ(rig_hash(*again), rig_hash(*rig));
}

INSTANTIATE_TEST_SUITE_P(AsFound, ElementNames,
                         testing::Values("robot::l2", "Part_1(2)", "l 2", "Gelenk_\xC3\xA4\xC3\xB6",
                                         "\xE8\x85\x95#1: a", "- [x]", "true", "~", "7",
                                         std::string(256 - 6, 'r')));

TEST(ElementName, with_a_control_character_or_without_end_is_refused) {
    const testing_support::ScratchFolder folder;
    const std::string base = (kSource / "tests/data/rigs/one-sensor.yaml").string();
    for (const std::string& name : {std::string("a\\x1b[2J"), std::string("a\\nb"), std::string("\\x7f"),
                                    std::string("\xC2\x9B"
                                                "2J"),
                                    std::string(), std::string(257, 'r')}) {
        const auto rig = read_rig(folder.write(
            "rig.yaml", "extends: " + base + "\nname: named\njoints: {names: [\"" + name + "\"]}\n"));
        ASSERT_FALSE(rig) << name;
        EXPECT_THAT(rig.error(), AllOf(code_is(ErrorCode::bad_name), key_is("joints.names"),
                                       what_is(HasSubstr("control characters"))));
    }
}

}  // namespace
}  // namespace octoskin::rig
