// Mistakes in writing, as people make them: where they are, and in words that say what to mend.
#include "hw/rigfile/syntax_hint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/urdf_xml.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::HasSubstr;

struct Mistake {
    const char* text;
    const char* place;  ///< ":line:column: " in YAML, ":line: " in XML
    const char* hint;
};

std::string yaml_error(const std::string& text) {
    const testing_support::ScratchFolder folder;
    try {
        static_cast<void>(load_document(folder.write("rig.yaml", text)));
    } catch (const Fault& fault) {
        return fault.error.message();
    }
    return "no error";
}

TEST(YamlSyntax, mistakes_are_placed_and_explained) {
    const Mistake mistakes[] = {
        {"name: x\n\tbus: 1\n", "rig.yaml:2:1: ", "indented with a tab: YAML takes spaces only"},
        {"name: x\nbus:\n\ta: 1\n", "rig.yaml:3:3: ", "indented with a tab"},
        {"name: x\nbus:\n  a: 1\n  \tb: 1\n", "rig.yaml:4:", "indented with a tab"},
        {"name x\nbus: 1\n", "rig.yaml:2:4: ", "is one missing on the line above"},
        {"a:\n  b: 1\n c: 2\n", "rig.yaml:3:2: ", "indented unlike those that it belongs to"},
        {"a:\n  - x: 1\n   y: 2\n", "rig.yaml:3:4: ", "indented unlike those that it belongs to"},
        {"a: [1, 2\nb: 3\n", "rig.yaml:2:2: ", "'[' above is not closed"},
        {"a: {b: 1\nc: 2\n", "rig.yaml:2:2: ", "'{' above is not closed"}};
    for (const Mistake& mistake : mistakes) {
        const std::string error = yaml_error(mistake.text);
        EXPECT_THAT(error, HasSubstr(mistake.place)) << mistake.text;
        EXPECT_THAT(error, HasSubstr("not YAML: ")) << mistake.text;
        EXPECT_THAT(error, HasSubstr(mistake.hint)) << mistake.text;
    }
}

TEST(YamlSyntax, a_merge_key_is_no_xml) {
    EXPECT_EQ(yaml_error("<<: {a: 1}\n"), "no error");
    EXPECT_THAT(yaml_error("<<: *base\n"), HasSubstr("rig.yaml:1:5: not YAML: "));
    for (const char* text : {"<robot/>", "<?xml version='1.0'?>", "<!-- a -->", " \n<sdf>"})
        EXPECT_THAT(yaml_error(text), HasSubstr("expected YAML, found XML")) << text;
}

TEST(XmlSyntax, mistakes_are_placed_and_explained) {
    const Mistake mistakes[] = {
        {"<robot>\n <link name=\"a\">\n <link name=\"b\"/>\n</robot>\n",
         "r.urdf:2: ", "<link> is not closed"},
        {"<robot>\n <link name=\"a\"/>\n", "r.urdf:1: ", "the element that begins here is not closed"},
        {"<robot>\n <link name=a/>\n</robot>", "r.urdf:2: ", "attribute of <link> is not name=\"value\""},
        {"<robot>\n <link name=\"a\"\n</robot>", "r.urdf:2: ", "no end '>'"},
        {"<robot>\n <!-- x \n</robot>", "r.urdf:2: ", "comment is not closed"}};
    for (const Mistake& mistake : mistakes) {
        tinyxml2::XMLDocument xml;
        const auto robot = parse_robot("r.urdf", mistake.text, xml);
        ASSERT_FALSE(robot) << mistake.text;
        EXPECT_THAT(robot.error().message(), HasSubstr(mistake.place)) << mistake.text;
        EXPECT_THAT(robot.error().message(), HasSubstr(mistake.hint)) << mistake.text;
    }
}

TEST(YamlSyntax, a_message_that_nobody_translates_stays_as_it_is) {
    EXPECT_EQ(yaml_syntax_hint("some new words", "a: 1\n", 1), "some new words");
    EXPECT_EQ(yaml_syntax_hint("some new words", "", 99), "some new words");
    EXPECT_EQ(xml_syntax_hint("XML_ERROR_NEW", ""), "XML_ERROR_NEW");
}

}  // namespace
}  // namespace octoskin::rig
