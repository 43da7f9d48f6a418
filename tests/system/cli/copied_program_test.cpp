// A program away from where it was built and installed: it has no helpers and no data, and takes none from
// anywhere else.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

class CopiedProgram : public ProgramTest {
  protected:
    /// The program there, and a helper that leaves a mark in `helpers`.
    void copy(const std::string& folder, const std::string& helpers) {
        std::filesystem::create_directories(path(folder));
        std::filesystem::create_directories(path(helpers));
        std::filesystem::copy_file(OCTOSKIN_PROGRAM, path(folder + "/octoskin"));
        const std::string helper = helpers + "/octoskin-camera";
        write(path(helper), "#!/bin/sh\ntouch " + path("was_run") + "\n");
        std::filesystem::permissions(path(helper), std::filesystem::perms::owner_all);
    }
    bool runs_it(const std::string& folder) {
        (void)run(path(folder + "/octoskin") + " cameras");
        return std::filesystem::exists(path("was_run"));
    }
};

TEST_F(CopiedProgram, has_no_helpers_and_no_data) {
    std::filesystem::create_directories(path("away/bin"));
    std::filesystem::copy_file(OCTOSKIN_PROGRAM, path("away/bin/octoskin"));
    EXPECT_EQ(run(path("away/bin/octoskin cameras")).exit_code, 69);
    std::filesystem::copy_file(OCTOSKIN_LAB_PROGRAM, path("away/bin/octoskin-lab"));
    const std::string program = path("away/bin/octoskin-lab");
    const Said world =
        run(program + " simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
            " --scenario " + source("tests/data/short/scenario.yaml"));
    EXPECT_EQ(world.exit_code, 69);
    EXPECT_NE(world.output.find("octoskin-world-read"), std::string::npos) << world.output;
    const Said depth = run(path("away/bin/octoskin") + " replay " + source("tests/data/frozen/daemon") +
                           " --out " + path("maps"));
    EXPECT_EQ(depth.exit_code, 69) << depth.output;
    EXPECT_NE(depth.output.find("octoskin-oni-read"), std::string::npos) << depth.output;
    const Said data = run(program + " simulate " + path("rec"));
    EXPECT_EQ(data.exit_code, 78) << data.output;
    EXPECT_NE(data.output.find(path("away/share/octoskin")), std::string::npos) << data.output;
}

TEST_F(CopiedProgram, says_that_what_a_recording_began_with_is_not_there) {
    std::filesystem::copy(source("tests/data/frozen/daemon"), path("rec"),
                          std::filesystem::copy_options::recursive);
    std::filesystem::remove(path("rec/first.ot"));
    const Said said =
        run(std::string(OCTOSKIN_PROGRAM) + " replay " + path("rec") + " --out " + path("maps"));
    EXPECT_EQ(said.exit_code, 66) << said.output;
    EXPECT_NE(said.output.find("first.ot"), std::string::npos) << said.output;
}

TEST_F(CopiedProgram, has_its_data_where_a_link_leads_and_not_in_the_working_directory) {
    std::filesystem::create_directories(path("away/bin"));
    std::filesystem::create_directories(path("away/share"));
    std::filesystem::create_directories(path("away/data"));
    std::filesystem::create_directories(path("data"));  // as the link has it, seen from here
    std::filesystem::create_directories(path("here"));
    std::filesystem::create_symlink("../data", path("away/share/octoskin"));
    std::filesystem::copy_file(OCTOSKIN_LAB_PROGRAM, path("away/bin/octoskin-lab"));
    const Said data = run("cd " + path("here") + " && ../away/bin/octoskin-lab simulate " + path("rec"));
    EXPECT_EQ(data.exit_code, 78) << data.output;
    EXPECT_NE(data.output.find(path("away/data/hw")), std::string::npos) << data.output;
}

TEST_F(CopiedProgram, has_the_helpers_beside_it) {
    copy("there", "there");
    EXPECT_TRUE(runs_it("there"));
}

TEST_F(CopiedProgram, has_the_helpers_of_its_installation) {
    copy("there/bin", "there/libexec/octoskin");
    EXPECT_TRUE(runs_it("there/bin"));
}

TEST_F(CopiedProgram, has_none_above_a_folder_that_is_no_installation) {
    copy("there/mine", "there/libexec/octoskin");
    EXPECT_FALSE(runs_it("there/mine"));
}

}  // namespace
}  // namespace octoskin
