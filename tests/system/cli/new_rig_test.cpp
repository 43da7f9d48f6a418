// A rig that octoskin writes for a robot.
#include <gmock/gmock.h>

#include <regex>
#include <string>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;

class NewRigTest : public ProgramTest {
  protected:
    [[nodiscard]] Said rig(const std::string& arguments) const {
        return run("XDG_CACHE_HOME=" + path("cache") + " " OCTOSKIN_PROGRAM " rig " + arguments, "2>&1");
    }
    static std::size_t count_of(const std::string& word, const std::string& text) {
        std::size_t count = 0;
        for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
        return count;
    }
    const std::string panda_ = source("hw/robots/panda.urdf");
};

TEST_F(NewRigTest, loads_as_it_is_and_marks_what_is_to_be_measured) {
    for (const std::string more : {"", " --base panda_link0"}) {
        const Said written = rig("--new " + panda_ + more + " --out " + path("rig.yaml"));
        ASSERT_EQ(written.exit_code, 0) << written.output;
        const std::string text = content(path("rig.yaml"));
        EXPECT_EQ(count_of("# TO MEASURE", text), 4U);
        EXPECT_THAT(text,
                    HasSubstr("[\"panda_joint1\", \"panda_joint2\", \"panda_joint3\", \"panda_joint4\", "
                              "\"panda_joint5\", \"panda_joint6\", \"panda_joint7\"]"));
        const Said read = rig(path("rig.yaml"));
        EXPECT_EQ(read.exit_code, 0) << read.output;
        EXPECT_THAT(read.output, HasSubstr("4 sensors"));
        EXPECT_THAT(read.output, Not(HasSubstr("warning")));
        std::filesystem::remove(path("rig.yaml"));
    }
}

TEST_F(NewRigTest, has_rings_of_sensors_on_the_links) {
    const Said written =
        rig("--new " + panda_ + " --ring panda_link7,17,0.06 --ring panda_link4,17,0.0 --out " +
            path("rig.yaml"));
    ASSERT_EQ(written.exit_code, 0) << written.output;
    const std::string text = content(path("rig.yaml"));
    EXPECT_EQ(count_of("name: ring0_", text), 17U);
    EXPECT_EQ(count_of("name: ring1_", text), 17U);
    EXPECT_EQ(count_of("node_id:", text), 4U);  // three boards, and the sender of joints
    EXPECT_EQ(count_of("TO MEASURE", text), 0U);
    const Said read = rig(path("rig.yaml"));
    EXPECT_EQ(read.exit_code, 0) << read.output;
    EXPECT_THAT(read.output, Not(HasSubstr("warning")));
    EXPECT_THAT(read.output, Not(HasSubstr("could spread the readings better")));
    const Said drawn = rig(path("rig.yaml") + " --picture " + path("rig.svg"));
    EXPECT_EQ(drawn.exit_code, 0) << drawn.output;
    EXPECT_EQ(count_of("<circle", content(path("rig.svg"))), 3U * 34);
}

TEST_F(NewRigTest, names_its_files_from_where_it_is) {
    std::filesystem::create_directory(path("a"));
    std::filesystem::copy_file(panda_, path("a/my arm.urdf"));
    const Said relative =
        run("cd " + path("a") + " && " OCTOSKIN_PROGRAM " rig --new 'my arm.urdf' --out ../rig.yaml", "2>&1");
    ASSERT_EQ(relative.exit_code, 0) << relative.output;
    EXPECT_THAT(content(path("rig.yaml")), HasSubstr("urdf: \"a/my arm.urdf\""));
    EXPECT_EQ(rig(path("rig.yaml")).exit_code, 0);
    const Said printed = run(OCTOSKIN_PROGRAM " rig --new '" + path("a/my arm.urdf") + "'", "2>/dev/null");
    write(path("printed.yaml"), printed.output);
    EXPECT_EQ(rig(path("printed.yaml")).exit_code, 0);
}

TEST_F(NewRigTest, is_refused_with_a_reason) {
    write(path("rig.yaml"), "mine");
    EXPECT_EQ(rig("--new " + panda_ + " --out " + path("rig.yaml")).exit_code, 73);
    EXPECT_EQ(content(path("rig.yaml")), "mine");
    for (const char* ring : {"panda_link7", "panda_link7,0,0", "panda_link7,4,1.9", "no_link,4,0",
                             "panda_link7,34,0.06 --ring panda_link7,1,0.06"})
        EXPECT_EQ(rig("--new " + panda_ + " --ring " + ring).exit_code, 64) << ring;
    EXPECT_EQ(rig("").exit_code, 64);
    EXPECT_EQ(rig(source("hw/rigs/experiment.yaml") + " --new " + panda_).exit_code, 64);
    EXPECT_EQ(
        rig(source("hw/rigs/experiment.yaml") + " --picture " + path("p.svg") + " --joints 1,2").exit_code,
        64);
    EXPECT_EQ(rig(source("hw/rigs/experiment.yaml") + " --joints 1,2").exit_code, 64);
    write(path("still.urdf"), "<robot name=\"r\"><link name=\"base\"/></robot>");
    const Said still = rig("--new " + path("still.urdf"));
    EXPECT_EQ(still.exit_code, 78);
    EXPECT_THAT(still.output, HasSubstr("expected 1 to 32 moving joints below base, found 0"));
}

}  // namespace
}  // namespace octoskin
