// A program away from where it was built and installed: it has no helpers and no data, and takes none from
// anywhere else.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::code_is;
using testing_support::remedy_is;
using testing_support::what_is;

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
    EXPECT_THAT(failure_in(run(program + " --json-errors simulate " + path("rec") + " --rig " +
                               source("tests/data/short/rig.yaml") + " --scenario " +
                               source("tests/data/short/scenario.yaml"))),
                fails_with(69, code_is(ErrorCode::no_program), what_is(HasSubstr("octoskin-world-read")),
                           remedy_is(HasSubstr("octoskin_programs"))));
    EXPECT_THAT(failure_in(run(path("away/bin/octoskin") + " --json-errors replay " +
                               source("tests/data/frozen/daemon") + " --out " + path("maps"))),
                fails_with(69, code_is(ErrorCode::no_program), what_is(HasSubstr("octoskin-oni-read"))));
    EXPECT_THAT(failure_in(run(program + " --json-errors simulate " + path("rec"))),
                fails_with(78, code_is(ErrorCode::not_found),
                           path_is(path("away/share/octoskin/hw/worlds/experiment.scenario.yaml"))));
}

TEST_F(CopiedProgram, names_the_package_of_a_command_that_is_another_program) {
    std::filesystem::create_directories(path("away/bin"));
    std::filesystem::copy_file(OCTOSKIN_PROGRAM, path("away/bin/octoskin"));
    for (const std::string command :
         {"view --port 8000", "view --help", "bridge --unknown-box 0", "export a b --frce"})
        EXPECT_THAT(failure_in(run(path("away/bin/octoskin") + " --json-errors " + command)),
                    fails_with(69, code_is(ErrorCode::no_program), what_is(HasSubstr("octoskin-bridge"))))
            << command;
}

TEST_F(CopiedProgram, says_that_what_a_recording_began_with_is_not_there) {
    std::filesystem::copy(source("tests/data/frozen/daemon"), path("rec"),
                          std::filesystem::copy_options::recursive);
    std::filesystem::remove(path("rec/first.ot"));
    EXPECT_THAT(failure_of("replay " + path("rec") + " --out " + path("maps")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("rec/first.ot")),
                           remedy_is(HasSubstr("--by-capture-time"))));
}

TEST_F(CopiedProgram, has_its_data_where_a_link_leads_and_not_in_the_working_directory) {
    std::filesystem::create_directories(path("away/bin"));
    std::filesystem::create_directories(path("away/share"));
    std::filesystem::create_directories(path("away/data"));
    std::filesystem::create_directories(path("data"));  // as the link has it, seen from here
    std::filesystem::create_directories(path("here"));
    std::filesystem::create_symlink("../data", path("away/share/octoskin"));
    std::filesystem::copy_file(OCTOSKIN_LAB_PROGRAM, path("away/bin/octoskin-lab"));
    EXPECT_THAT(failure_in(run("cd " + path("here") + " && ../away/bin/octoskin-lab --json-errors simulate " +
                               path("rec"))),
                fails_with(78, code_is(ErrorCode::not_found),
                           path_is(path("away/data/hw/worlds/experiment.scenario.yaml"))));
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
