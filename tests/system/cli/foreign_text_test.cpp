// What others have named reaches the terminal and the log as marks, never as orders to the terminal: title,
// colours, a line of its own. JSON is exact.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "host/core/text/printable.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::code_is;

/// Sets the title, turns red, turns the writing, and makes up a line of a log.
constexpr const char* kYaml = R"("\e]0;owned\a\e[31m\u009b1m\u202Etxt\n12:00:00 error forged")";
constexpr const char* kShown = R"(\x1b]0;owned\x07\x1b[31m\x9b1m\u202etxt\x0a12:00:00 error forged)";

class ForeignText : public ProgramTest {
  protected:
    static void expect_harmless(const Said& said) {
        EXPECT_EQ(printable_lines(said.output), said.output);
        EXPECT_THAT(said.output, testing::Not(HasSubstr("\n12:00:00 error forged")));
    }
};

TEST_F(ForeignText, a_key_or_value_of_a_file_is_shown_in_marks) {
    write(path("key.yaml"), std::string(kYaml) + ": 1\n");
    const Said key = octoskin("rig " + path("key.yaml"));
    EXPECT_EQ(key.exit_code, 78);
    expect_harmless(key);
    EXPECT_THAT(key.output, HasSubstr(kShown));
    write(path("value.yaml"), "extends: " + source("tests/data/short/rig.yaml") + "\nname: " + kYaml + "\n");
    const Said value = octoskin("rig " + path("value.yaml"));
    EXPECT_EQ(value.exit_code, 78);
    expect_harmless(value);
    EXPECT_THAT(value.output, HasSubstr("\\x1b]0;owned"));
}

TEST_F(ForeignText, a_node_or_sensor_name_is_shown_in_marks) {
    const std::string rig = content(source("tests/data/short/rig.yaml"));
    for (const char* key : {"node", "sensor"}) {
        write(path("rig.yaml"),
              "extends: " + source("hw/rigs/bench_one_board.yaml") +
                  (key == std::string("node")
                       ? std::string("\nnodes: [{name: ") + kYaml + "}]\n"
                       : std::string("\nnodes: [{name: a, sensors: [{name: ") + kYaml + "}]}]\n"));
        const Said said = octoskin("rig " + path("rig.yaml"));
        EXPECT_EQ(said.exit_code, 78) << key;
        expect_harmless(said);
    }
}

TEST_F(ForeignText, a_link_of_a_robot_is_shown_in_marks) {
    write(path("robot.urdf"),
          "<robot name=\"r\"><link name=\"&#27;]0;owned&#7;&#155;&#10;12:00:00 error forged\"/></robot>");
    const Said said =
        octoskin("rig " + source("tests/data/short/rig.yaml") + " --robot " + path("robot.urdf"));
    EXPECT_EQ(said.exit_code, 78);
    expect_harmless(said);
    EXPECT_THAT(said.output, HasSubstr("\\x1b]0;owned\\x07"));
}

TEST_F(ForeignText, a_recordings_folder_is_shown_in_marks) {
    const std::string name = "rec\x1b[31m\u009b\u202e\n12:00:00 error forged\xff";
    record_short("rec");
    std::filesystem::rename(path("rec"), path(name));
    const std::string quoted = "'" + path(name) + "'";
    for (const std::string& command :
         {"replay " + quoted, "evaluate " + quoted, "simulate " + quoted, "black-box " + quoted + "/can.log",
          "replay " + quoted + " --rig " + quoted}) {
        const Said said = octoskin(command);
        expect_harmless(said);
        EXPECT_THAT(said.output, HasSubstr("rec\\x1b[31m\\x9b\\u202e\\x0a12:00:00 error forged\\xff"))
            << command;
    }
    // These name the folder only where something is wrong with it.
    for (const std::string& command :
         {"explain 0 0 1 --recording " + quoted, "query " + quoted + "/maps/fused.ot --stands 0,0,0,0,0,0,0"})
        expect_harmless(octoskin(command));
    write(path(name + "/meta.yaml"), std::string(kYaml) + ": 1\n");
    const Said meta = octoskin("replay " + quoted);
    EXPECT_EQ(meta.exit_code, 65);
    expect_harmless(meta);
    EXPECT_THAT(meta.output, HasSubstr(kShown));
}

TEST_F(ForeignText, is_harmless_in_the_journal_too) {
    write(path("key.yaml"), std::string(kYaml) + ": 1\n");
    const Said said = run("JOURNAL_STREAM=1:2 " OCTOSKIN_PROGRAM " run --rig " + path("key.yaml") +
                          " --can can99 --maps " + path("maps") + " --socket " + path("s"));
    EXPECT_EQ(said.exit_code, 78) << said.output;
    expect_harmless(said);
    EXPECT_THAT(said.output, AllOf(StartsWith("<3>"), HasSubstr(kShown)));
}

TEST_F(ForeignText, is_exact_in_the_fields_of_an_error_and_its_line_is_harmless) {
    const std::string file = path("no\x1b[31m\u009b\u202esuch.yaml\n12:00:00 error forged");
    const Failure failure = failure_of("rig '" + file + "'");
    EXPECT_THAT(failure, fails_with(66, code_is(ErrorCode::not_found), path_is(file)));
    expect_harmless({failure.exit_code, failure.output});
}

TEST_F(ForeignText, is_exact_in_json) {
    const std::string name = path("no\x1b[31m\u009b\u202esuch.ot");
    const Said said = run(OCTOSKIN_PROGRAM " query --json --rig " + source("tests/data/short/rig.yaml") +
                              " '" + name + "' --stands 0,0,0,0,0,0,0",
                          "2>/dev/null");
    const auto answer = nlohmann::json::parse(said.output, nullptr, false);
    ASSERT_TRUE(answer.is_object()) << said.output;
    EXPECT_EQ(answer.at("exit"), 66);
    EXPECT_EQ(answer.at("error").at("file"), name);
    EXPECT_THAT(answer.at("error").at("message").get<std::string>(), HasSubstr(name));
}

}  // namespace
}  // namespace octoskin
