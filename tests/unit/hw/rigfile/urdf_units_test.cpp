// Robot descriptions in the wrong units, or not expanded: refused with line, element and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "hw/rigfile/robot_description.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {
namespace {

using testing::HasSubstr;

class UrdfUnits : public testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(file_); }
    /// A robot with two links and, on line 3, what joins them.
    std::string error_of(const std::string& joint) {
        std::ofstream(file_) << "<robot name=\"r\">\n<link name=\"a\"/><link name=\"b\"/>\n"
                             << joint << "\n</robot>\n";
        const auto document = UrdfDocument::read(file_);
        return document ? "" : document.error().message();
    }
    static std::string joint(const std::string& type, const std::string& xyz, const std::string& lower,
                             const std::string& upper) {
        return "<joint name=\"j\" type=\"" + type +
               "\"><parent link=\"a\"/><child link=\"b\"/><origin xyz=\"" + xyz +
               "\"/><axis xyz=\"0 0 1\"/><limit lower=\"" + lower + "\" upper=\"" + upper +
               "\" effort=\"1\" velocity=\"1\"/></joint>";
    }
    std::filesystem::path file_ =
        std::filesystem::path(testing::TempDir()) /
        (std::string("octoskin-") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".urdf");
};

TEST_F(UrdfUnits, of_an_arm_are_accepted) {
    EXPECT_EQ(error_of(joint("revolute", "0 0 0.45", "-2.8", "2.8")), "");
    EXPECT_EQ(error_of(joint("revolute", "0 0 10", "-12.5", "12.5")), "");
    EXPECT_EQ(error_of(joint("prismatic", "0 0 -10", "0", "10")), "");
}

TEST_F(UrdfUnits, millimetres_in_an_origin_are_refused) {
    for (const char* xyz : {"0 0 450", "10.1 0 0", "0 -450 0", "0 0 1e30"}) {
        EXPECT_THAT(error_of(joint("revolute", xyz, "-1", "1")),
                    testing::AllOf(HasSubstr(":3: joint j"), HasSubstr("is it written in millimetres?")))
            << xyz;
    }
}

TEST_F(UrdfUnits, degrees_in_a_limit_are_refused) {
    EXPECT_THAT(error_of(joint("revolute", "0 0 0", "-160", "160")),
                testing::AllOf(HasSubstr(":3: joint j"), HasSubstr("limits -160 to 160"),
                               HasSubstr("are they written in degrees?")));
    EXPECT_THAT(error_of(joint("revolute", "0 0 0", "0", "90")), HasSubstr("degrees"));
}

TEST_F(UrdfUnits, wrong_ones_of_several_joints_are_in_one_message) {
    const std::string second =
        "\n<link name=\"c\"/><joint name=\"k\" type=\"fixed\"><parent link=\"b\"/>"
        "<child link=\"c\"/>\n<origin ";
    EXPECT_THAT(error_of(joint("revolute", "0 0 450", "-1", "1") + second + "xyz=\"0 500 0\"/></joint>"),
                testing::AllOf(HasSubstr(":3: joint j"), HasSubstr("1 more refused: joint k (line 4")));
    EXPECT_THAT(error_of("<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/>"
                         "<origin rpy=\"0 90 0\"/></joint>" +
                         second + "rpy=\"0 0 90\"/></joint>"),
                testing::AllOf(HasSubstr(":3: joint j"), HasSubstr("1 more refused: joint k (line 5")));
}

TEST_F(UrdfUnits, millimetres_in_a_sliding_limit_are_refused) {
    EXPECT_THAT(error_of(joint("prismatic", "0 0 0", "0", "500")),
                HasSubstr("are they written in millimetres?"));
}

TEST_F(UrdfUnits, degrees_in_a_turn_are_refused_wherever_it_counts) {
    const std::string joint = "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/>\n";
    EXPECT_EQ(error_of(joint + "<origin rpy=\"6.2832 -6.2832 0\"/></joint>"), "");
    for (const char* rpy : {"0 0 90", "-45 0 0", "0 6.3 0", "1e300 0 0", "inf 0 0"}) {
        EXPECT_THAT(error_of(joint + "<origin rpy=\"" + rpy + "\"/></joint>"),
                    testing::AnyOf(testing::AllOf(HasSubstr(":4: joint j"), HasSubstr(rpy),
                                                  HasSubstr("is it written in degrees?")),
                                   HasSubstr("not a usable URDF")))
            << rpy;
    }
    const std::string link = "<link name=\"c\"><collision/>\n<collision>\n<origin rpy=\"0 180 0\"/>";
    EXPECT_THAT(error_of(link + "</collision></link>"),
                testing::AllOf(HasSubstr(":5: link c"), HasSubstr("is it written in degrees?")));
    // What the picture of a robot looks like is none of our business.
    EXPECT_THAT(
        error_of(joint + "</joint><link name=\"d\"><visual><origin rpy=\"0 180 0\"/></visual></link>"),
        testing::Not(HasSubstr("written in degrees")));
}

/// Below link b, a line for each.
std::string chain_of(int links) {
    std::ostringstream text;
    for (int i = 0; i < links; ++i) {
        text << "<link name=\"n" << i << "\"/><joint name=\"j" << i << "\" type=\"fixed\"><parent link=\"";
        if (i == 0) text << "b";
        if (i > 0) text << "n" << i - 1;
        text << "\"/><child link=\"n" << i << "\"/></joint>\n";
    }
    text << "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>";
    return text.str();
}

TEST_F(UrdfUnits, a_robot_of_more_links_than_any_has_is_refused_at_once) {
    EXPECT_EQ(error_of(chain_of(1998)), "");
    // 2 links and 1,999 more with their joints are 4,000 elements; then comes the one too many.
    EXPECT_THAT(error_of(chain_of(1999)),
                testing::AllOf(HasSubstr(":2002: joint: "), HasSubstr("at most 4000 links and joints")));
    EXPECT_THAT(error_of(chain_of(100'000)), HasSubstr("at most 4000 links and joints"));
}

TEST_F(UrdfUnits, a_link_of_more_shapes_than_any_has_is_refused) {
    std::string link = "<link name=\"c\">";
    for (int i = 0; i < 1001; ++i)
        link += "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>";
    const std::string joint =
        "<joint name=\"k\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>"
        "<joint name=\"j\" type=\"fixed\"><parent link=\"b\"/><child link=\"c\"/></joint>";
    EXPECT_EQ(error_of(joint + link + "</link>"), "");
    const auto capsules = read_capsules(file_, {});
    ASSERT_FALSE(capsules);
    EXPECT_THAT(capsules.error().message(), testing::AllOf(HasSubstr(":3: link c"), HasSubstr("found 1001")));
}

TEST_F(UrdfUnits, a_macro_that_is_not_expanded_is_refused) {
    EXPECT_THAT(error_of("<xacro:arm name=\"x\"/>"),
                testing::AllOf(HasSubstr(":3: xacro:arm"), HasSubstr("run xacro first")));
}

}  // namespace
}  // namespace octoskin::rig
