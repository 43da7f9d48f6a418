// Robot descriptions in the wrong units, or not expanded: refused with line, element and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "hw/rigfile/robot_description.hpp"
#include "hw/rigfile/urdf_document.hpp"
#include "tests/support/errors/error_fields.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::has_its_fields;
using testing_support::is_no_error;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::others_are;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class UrdfUnits : public testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(file_); }
    /// A robot with two links and, on line 3, what joins them.
    Error error_of(const std::string& joint) {
        std::ofstream(file_) << "<robot name=\"r\">\n<link name=\"a\"/><link name=\"b\"/>\n"
                             << joint << "\n</robot>\n";
        return error_in(UrdfDocument::read(file_));
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
    EXPECT_THAT(error_of(joint("revolute", "0 0 0.45", "-2.8", "2.8")), is_no_error());
    EXPECT_THAT(error_of(joint("revolute", "0 0 10", "-12.5", "12.5")), is_no_error());
    EXPECT_THAT(error_of(joint("prismatic", "0 0 -10", "0", "10")), is_no_error());
}

TEST_F(UrdfUnits, millimetres_in_an_origin_are_refused) {
    for (const char* xyz : {"0 0 450", "10.1 0 0", "0 -450 0", "0 0 1e30"}) {
        const Error error = error_of(joint("revolute", xyz, "-1", "1"));
        EXPECT_THAT(error, AllOf(code_is(ErrorCode::out_of_range), line_is(3), key_is("joint j"),
                                 remedy_is(HasSubstr("millimetres"))))
            << xyz;
        EXPECT_TRUE(has_its_fields(error));
    }
}

TEST_F(UrdfUnits, degrees_in_a_limit_are_refused) {
    EXPECT_THAT(error_of(joint("revolute", "0 0 0", "-160", "160")),
                AllOf(code_is(ErrorCode::out_of_range), line_is(3), key_is("joint j"),
                      value_is("-160 to 160"), remedy_is(HasSubstr("degrees"))));
    EXPECT_THAT(error_of(joint("revolute", "0 0 0", "0", "90")), remedy_is(HasSubstr("degrees")));
}

TEST_F(UrdfUnits, wrong_ones_of_several_joints_are_in_one_message) {
    const std::string second =
        "\n<link name=\"c\"/><joint name=\"k\" type=\"fixed\"><parent link=\"b\"/>"
        "<child link=\"c\"/>\n<origin ";
    EXPECT_THAT(
        error_of(joint("revolute", "0 0 450", "-1", "1") + second + "xyz=\"0 500 0\"/></joint>"),
        AllOf(line_is(3), key_is("joint j"), others_are(StartsWith("1 more refused: joint k (line 4"))));
    EXPECT_THAT(
        error_of("<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/>"
                 "<origin rpy=\"0 90 0\"/></joint>" +
                 second + "rpy=\"0 0 90\"/></joint>"),
        AllOf(line_is(3), key_is("joint j"), others_are(StartsWith("1 more refused: joint k (line 5"))));
}

TEST_F(UrdfUnits, millimetres_in_a_sliding_limit_are_refused) {
    EXPECT_THAT(error_of(joint("prismatic", "0 0 0", "0", "500")),
                AllOf(code_is(ErrorCode::out_of_range), remedy_is(HasSubstr("millimetres"))));
}

TEST_F(UrdfUnits, degrees_in_a_turn_are_refused_wherever_it_counts) {
    const std::string joint = "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/>\n";
    EXPECT_THAT(error_of(joint + "<origin rpy=\"6.2832 -6.2832 0\"/></joint>"), is_no_error());
    for (const char* rpy : {"0 0 90", "-45 0 0", "0 6.3 0", "1e300 0 0", "inf 0 0"}) {
        EXPECT_THAT(error_of(joint + "<origin rpy=\"" + rpy + "\"/></joint>"),
                    AnyOf(AllOf(code_is(ErrorCode::out_of_range), line_is(4), key_is("joint j"),
                                value_is(HasSubstr(rpy)), remedy_is(HasSubstr("degrees"))),
                          what_is(HasSubstr("not a usable URDF"))))
            << rpy;
    }
    const std::string link = "<link name=\"c\"><collision/>\n<collision>\n<origin rpy=\"0 180 0\"/>";
    EXPECT_THAT(error_of(link + "</collision></link>"),
                AllOf(line_is(5), key_is("link c"), remedy_is(HasSubstr("degrees"))));
    // What the picture of a robot looks like is none of our business.
    EXPECT_THAT(
        error_of(joint + "</joint><link name=\"d\"><visual><origin rpy=\"0 180 0\"/></visual></link>"),
        Not(remedy_is(HasSubstr("degrees"))));
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
    EXPECT_THAT(error_of(chain_of(1998)), is_no_error());
    // 2 links and 1,999 more with their joints are 4,000 elements; then comes the one too many.
    EXPECT_THAT(error_of(chain_of(1999)),
                AllOf(code_is(ErrorCode::limit_exceeded), line_is(2002), key_is("joint"),
                      what_is(HasSubstr("4000 links and joints"))));
    EXPECT_THAT(error_of(chain_of(100'000)), code_is(ErrorCode::limit_exceeded));
}

TEST_F(UrdfUnits, a_link_of_more_shapes_than_any_has_is_refused) {
    std::string link = "<link name=\"c\">";
    for (int i = 0; i < 1001; ++i)
        link += "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>";
    const std::string joint =
        "<joint name=\"k\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>"
        "<joint name=\"j\" type=\"fixed\"><parent link=\"b\"/><child link=\"c\"/></joint>";
    EXPECT_THAT(error_of(joint + link + "</link>"), is_no_error());
    const auto capsules = read_capsules(file_, {});
    ASSERT_FALSE(capsules);
    EXPECT_THAT(capsules.error(),
                AllOf(code_is(ErrorCode::limit_exceeded), line_is(3), key_is("link c"), value_is("1001")));
}

TEST_F(UrdfUnits, a_macro_that_is_not_expanded_is_refused) {
    EXPECT_THAT(error_of("<xacro:arm name=\"x\"/>"),
                AllOf(code_is(ErrorCode::unsupported), line_is(3), key_is("xacro:arm"),
                      remedy_is(HasSubstr("run `xacro "))));
}

}  // namespace
}  // namespace octoskin::rig
