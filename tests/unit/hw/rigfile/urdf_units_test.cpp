// Robot descriptions in the wrong units, or not expanded: refused with line, element and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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

TEST_F(UrdfUnits, millimetres_in_a_sliding_limit_are_refused) {
    EXPECT_THAT(error_of(joint("prismatic", "0 0 0", "0", "500")),
                HasSubstr("are they written in millimetres?"));
}

TEST_F(UrdfUnits, a_macro_that_is_not_expanded_is_refused) {
    EXPECT_THAT(error_of("<xacro:arm name=\"x\"/>"),
                testing::AllOf(HasSubstr(":3: xacro:arm"), HasSubstr("run xacro first")));
}

}  // namespace
}  // namespace octoskin::rig
