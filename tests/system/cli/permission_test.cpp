// Files that are there and may not be read: 77 and their name, wherever they are given; not "no such file".
#include <gmock/gmock.h>

#include "tests/support/data_set/written_data_set.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::code_is;
using testing_support::key_is;
using testing_support::remedy_is;
using testing_support::what_is;

/// The program as somebody who may not read what is not everybody's: root may read everything.
class PermissionTest : public ProgramTest {
  protected:
    void SetUp() override {
        record_short("rec");
        ASSERT_EQ(octoskin("replay " + path("rec") + " --out " + path("maps")).exit_code, 0);
        std::filesystem::copy(source("hw/robots/panda.urdf"), path("panda.urdf"));
        std::filesystem::copy(source("hw/worlds"), path("worlds"), std::filesystem::copy_options::recursive);
        write(path("scenario.yaml"), "extends: worlds/experiment.scenario.yaml\nname: mine\n");
        write(path("mapping.yaml"), "base: robust\n");
        write(path("rig.yaml"), "extends: rec/rig.yaml\nname: mine\n");
        ASSERT_EQ(
            run("cp -r $(dirname " OCTOSKIN_PROGRAM ") " + path("bin") + " && chmod -R a+rX,a+w " + path(""))
                .exit_code,
            0);
    }
    Said as_nobody(const std::string& arguments) const {
        const std::string who = ::geteuid() == 0 ? "setpriv --reuid 65534 --regid 65534 --clear-groups " : "";
        const std::string program = are_for_lab(arguments) ? "bin/octoskin-lab" : "bin/octoskin";
        return run("cd " + path("") + " && timeout 20 " + who + path(program) + " --json-errors " +
                   arguments);
    }
    [[nodiscard]] Failure fail_as_nobody(const std::string& arguments) const {
        return failure_in(as_nobody(arguments));
    }
    /// That each of them says of `file` that it may not be read, and does what it does once it may.
    void expect_refused(const std::string& file, const std::vector<std::string>& commands) const {
        const std::filesystem::perms before = std::filesystem::status(path(file)).permissions();
        std::filesystem::permissions(path(file), std::filesystem::perms::none);
        for (const std::string& command : commands) {
            EXPECT_THAT(fail_as_nobody(command),
                        fails_with(77, code_is(ErrorCode::no_permission), path_is(path(file)),
                                   what_is(HasSubstr("(Permission denied)")), remedy_is(HasSubstr("chmod"))))
                << command;
        }
        std::filesystem::permissions(path(file), before);
        for (const std::string& command : commands) EXPECT_NE(as_nobody(command).exit_code, 77) << command;
    }
    [[nodiscard]] std::string at(const std::string& file) const { return " " + path(file); }
};

TEST_F(PermissionTest, of_files_that_are_given) {
    expect_refused("rig.yaml",
                   {"rig" + at("rig.yaml"), "simulate" + at("new") + " --rig" + at("rig.yaml"),
                    "replay" + at("rec") + " --out" + at("out") + " --rig" + at("rig.yaml"),
                    "command all identify --can nocan9 --rig" + at("rig.yaml"),
                    "joints --can nocan9 --rig" + at("rig.yaml") + " < /dev/null",
                    "flash --dry-run --rig" + at("rig.yaml"),
                    "calibrate offset --can nocan9 --sensor a --target-mm 100 --rig" + at("rig.yaml"),
                    "evaluate" + at("maps/fused.ot") + " --rig" + at("rig.yaml"),
                    "run --can fd:0 --rig" + at("rig.yaml")});
    expect_refused("panda.urdf", {"rig" + at("rec/rig.yaml") + " --robot" + at("panda.urdf")});
    expect_refused("scenario.yaml", {"simulate" + at("new") + " --scenario" + at("scenario.yaml")});
    expect_refused("mapping.yaml", {"mapping" + at("mapping.yaml"),
                                    "replay" + at("rec") + " --configuration" + at("mapping.yaml")});
    expect_refused("maps/fused.ot", {"evaluate" + at("maps/fused.ot") + " --rig" + at("rec/rig.yaml")});
    expect_refused("rec/can.log", {"black-box" + at("rec/can.log")});
}

TEST_F(PermissionTest, of_files_that_others_speak_of) {
    expect_refused("rec/rig.yaml", {"rig" + at("rig.yaml")});
    for (const std::string file : {"rec/rig.yaml", "rec/robot.urdf", "rec/can.log", "rec/meta.yaml",
                                   "rec/depth.oni", "rec/depth.epoch.yaml"}) {
        ASSERT_TRUE(std::filesystem::exists(path(file))) << file;
        expect_refused(file,
                       {"replay" + at("rec") + " --out" + at("out"), "explain 0 0 1 --recording" + at("rec"),
                        "evaluate" + at("rec") + " --scenario" + at("scenario.yaml")});
    }
}

TEST_F(PermissionTest, of_what_is_in_a_folder_that_may_not_be_entered) {
    std::filesystem::permissions(path("rec"), std::filesystem::perms::none);
    for (const std::string& command :
         {"rig" + at("rec/rig.yaml"), "replay" + at("rec") + " --out" + at("out"), "evaluate" + at("rec"),
          "black-box" + at("rec/can.log"), "rig" + at("rig.yaml")}) {
        EXPECT_THAT(fail_as_nobody(command), fails_with(77, code_is(ErrorCode::no_permission),
                                                        what_is(HasSubstr("(Permission denied)"))))
            << command;
    }
    std::filesystem::permissions(path("rec"), std::filesystem::perms::all);
}

TEST_F(PermissionTest, of_an_image_of_a_data_set) {
    testing_support::WrittenDataSet data_set(path("set"));
    data_set.add_image("1.0", {640, 480, std::vector<std::uint16_t>(640 * 480, 10'000)});
    data_set.add_pose("1.0", "0 0 0 0 0 0 1");
    std::filesystem::permissions(path("set/depth/1.0.png"), std::filesystem::perms::none);
    EXPECT_THAT(fail_as_nobody("replay" + at("set") + " --out" + at("out")),
                fails_with(77, code_is(ErrorCode::no_permission), path_is(path("set/depth.txt")),
                           key_is("depth/1.0.png"), remedy_is(HasSubstr("permission"))));
}

TEST_F(PermissionTest, is_none_where_there_is_no_file) {
    for (const std::string command : {"rig", "replay"})
        EXPECT_THAT(fail_as_nobody(command + at("gone")),
                    fails_with(66, code_is(ErrorCode::not_found), path_is(path("gone"))));
}

}  // namespace
}  // namespace octoskin
