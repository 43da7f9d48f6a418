// Mistakes in writing, as people make them: where they are, and in words that say what to mend.
#include "hw/rigfile/syntax_hint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/urdf_xml.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::is_no_error;
using testing_support::line_is;
using testing_support::no_error;
using testing_support::value_is;
using testing_support::what_is;

struct Mistake {
    const char* text;
    int line;
    int column;  ///< 0: not compared
    const char* hint;
};

Error yaml_error(const std::string& text) {
    const testing_support::ScratchFolder folder;
    try {
        static_cast<void>(load_document(folder.write("rig.yaml", text)));
    } catch (const Error& error) {
        return error;
    }
    return no_error();
}

TEST(YamlSyntax, mistakes_are_placed_and_explained) {
    const Mistake mistakes[] = {{"name: x\n\tbus: 1\n", 2, 1, "indented with a tab: YAML takes spaces only"},
                                {"name: x\nbus:\n\ta: 1\n", 3, 3, "indented with a tab"},
                                {"name: x\nbus:\n  a: 1\n  \tb: 1\n", 4, 0, "indented with a tab"},
                                {"name x\nbus: 1\n", 2, 4, "is one missing on the line above"},
                                {"a:\n  b: 1\n c: 2\n", 3, 2, "indented unlike those that it belongs to"},
                                {"a:\n  - x: 1\n   y: 2\n", 3, 4, "indented unlike those that it belongs to"},
                                {"a: [1, 2\nb: 3\n", 2, 2, "'[' above is not closed"},
                                {"a: {b: 1\nc: 2\n", 2, 2, "'{' above is not closed"}};
    for (const Mistake& mistake : mistakes) {
        const Error error = yaml_error(mistake.text);
        EXPECT_THAT(error, AllOf(code_is(ErrorCode::bad_syntax), file_is("rig.yaml"), line_is(mistake.line),
                                 what_is(HasSubstr(mistake.hint))))
            << mistake.text;
        EXPECT_EQ(error.column, mistake.column == 0 ? error.column : mistake.column) << mistake.text;
        EXPECT_TRUE(has_its_fields(error));
    }
}

TEST(YamlSyntax, a_merge_key_is_no_xml) {
    EXPECT_THAT(yaml_error("<<: {a: 1}\n"), is_no_error());
    const Error error = yaml_error("<<: *base\n");
    EXPECT_THAT(error, AllOf(code_is(ErrorCode::bad_syntax), file_is("rig.yaml"), line_is(1)));
    EXPECT_EQ(error.column, 5);
    for (const char* text : {"<robot/>", "<?xml version='1.0'?>", "<!-- a -->", " \n<sdf>"})
        EXPECT_THAT(yaml_error(text), AllOf(code_is(ErrorCode::foreign_format), value_is(HasSubstr("XML"))))
            << text;
}

TEST(XmlSyntax, mistakes_are_placed_and_explained) {
    const Mistake mistakes[] = {
        {"<robot>\n <link name=\"a\">\n <link name=\"b\"/>\n</robot>\n", 2, 0, "<link> is not closed"},
        {"<robot>\n <link name=\"a\"/>\n", 1, 0, "the element that begins here is not closed"},
        {"<robot>\n <link name=a/>\n</robot>", 2, 0, "attribute of <link> is not name=\"value\""},
        {"<robot>\n <link name=\"a\"\n</robot>", 2, 0, "no end '>'"},
        {"<robot>\n <!-- x \n</robot>", 2, 0, "comment is not closed"}};
    for (const Mistake& mistake : mistakes) {
        tinyxml2::XMLDocument xml;
        const auto robot = parse_robot("r.urdf", mistake.text, xml);
        ASSERT_FALSE(robot) << mistake.text;
        EXPECT_THAT(robot.error(), AllOf(code_is(ErrorCode::bad_syntax), file_is("r.urdf"),
                                         line_is(mistake.line), what_is(HasSubstr(mistake.hint))))
            << mistake.text;
        EXPECT_TRUE(has_its_fields(robot.error()));
    }
}

TEST(YamlSyntax, a_message_that_nobody_translates_stays_as_it_is) {
    EXPECT_EQ(yaml_syntax_hint("some new words", "a: 1\n", 1), "some new words");
    EXPECT_EQ(yaml_syntax_hint("some new words", "", 99), "some new words");
    EXPECT_EQ(xml_syntax_hint("XML_ERROR_NEW", ""), "XML_ERROR_NEW");
}

}  // namespace
}  // namespace octoskin::rig
