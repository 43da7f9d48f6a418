// Two libraries read a robot description: what one of them passes over, the other must not find in it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hw/rigfile/urdf_document.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::ElementsAre;

const std::string kRobot = "<robot name=\"r\"><link name=\"a\"/></robot>\n";

std::vector<std::string> links_of(const std::string& text) {
    const testing_support::ScratchFolder folder;
    const auto document = UrdfDocument::read(folder.write("robot.urdf", text));
    return document ? document->link_names() : std::vector<std::string>{document.error().message()};
}

TEST(UrdfReaders, find_the_same_robot_behind_a_declaration) {
    const std::string other = "<robot name=\"other\"><link name=\"b\"/></robot>";
    EXPECT_THAT(links_of("<?xml version=\"1.0\" >" + other + "?>\n" + kRobot), ElementsAre("a"));
    EXPECT_THAT(links_of("<?xml version=\"1.0\"?>\n<?more >" + other + "?>\n" + kRobot), ElementsAre("a"));
    EXPECT_THAT(links_of("<!--->" + other + "-->" + kRobot), ElementsAre("a"));
}

TEST(UrdfReaders, descend_nowhere_that_was_not_looked_at) {
    std::string deep;
    for (int i = 0; i < 100'000; ++i) deep += "<a>";  // each a call in the other one
    EXPECT_THAT(links_of("<?xml version=\"1.0\" >" + deep + "?>\n" + kRobot), ElementsAre("a"));
}

TEST(UrdfReaders, end_an_attribute_in_the_same_place) {
    const std::string declared = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    EXPECT_THAT(links_of(declared + "<robot name=\"r\"><link name=\"a\" x=\"\xF0\"/></robot>"),
                ElementsAre("a"));
    EXPECT_THAT(
        links_of(declared + "<robot name='r'><link name='a' x='&lt;\"&gt;&amp;&#38;&apos;'/></robot>"),
        ElementsAre("a"));
    EXPECT_THAT(links_of(declared + "<robot name='r'><link name='&lt;\"&apos;&amp;lt;\xC3\xA9'/></robot>"),
                ElementsAre("<\"'&lt;\xC3\xA9"));
}

}  // namespace
}  // namespace octoskin::rig
