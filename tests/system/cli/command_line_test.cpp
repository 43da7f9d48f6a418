// What is typed wrongly: one exit code for each kind of mistake, and words that name the culprit and the way
// out.
#include <gmock/gmock.h>

#include <algorithm>
#include <regex>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::others_are;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class CommandLine : public ProgramTest {};

TEST_F(CommandLine, names_the_command_that_is_none_and_the_one_that_is_like_it) {
    EXPECT_THAT(failure_of("reply x"), fails_with(64, code_is(ErrorCode::unknown_word), value_is("'reply'"),
                                                  remedy_is(HasSubstr("did you mean 'replay'?"))));
    EXPECT_THAT(failure_of("frobnicate"),
                fails_with(64, code_is(ErrorCode::unknown_word), value_is("'frobnicate'"),
                           remedy_is(AllOf(HasSubstr("commands are replay"), HasSubstr("repair"),
                                           Not(HasSubstr("did you mean"))))));
    EXPECT_THAT(failure_in(run(OCTOSKIN_PROGRAM " --json-errors simulate x")),
                fails_with(64, code_is(ErrorCode::unknown_word), value_is("'simulate'"),
                           remedy_is(HasSubstr("octoskin-lab"))));
}

TEST_F(CommandLine, names_the_option_that_is_none_and_the_one_that_is_like_it) {
    const auto names = [](const std::string& word, const std::string& near) {
        return fails_with(64, code_is(ErrorCode::unknown_word), value_is("'" + word + "'"),
                          remedy_is(HasSubstr("did you mean '" + near + "'?")));
    };
    EXPECT_THAT(failure_of("run --rgi x"), names("--rgi", "--rig")) << "--rig is missing, too";
    EXPECT_THAT(failure_of("replay --ot=x y"), names("--ot", "--out")) << "y is no recording, either";
    EXPECT_THAT(failure_of("status --jsno"), names("--jsno", "--json"));
    EXPECT_THAT(failure_of("status --nothing-of-the-kind"),
                fails_with(64, code_is(ErrorCode::unknown_word), value_is("'--nothing-of-the-kind'"),
                           remedy_is(Not(HasSubstr("did you mean")))));
    EXPECT_EQ(octoskin("status --jsno --help").exit_code, 0);
}

TEST_F(CommandLine, helps_with_options_as_they_are_typed_and_with_exit_codes) {
    for (const std::string command : {"run", "joints"}) {
        const Said said = octoskin(command + " --help");
        EXPECT_EQ(said.exit_code, 0);
        EXPECT_THAT(said.output, AllOf(HasSubstr("Usage: octoskin " + command), HasSubstr("Exit codes: 0 "),
                                       Not(HasSubstr("{false}"))))
            << command;
    }
}

TEST_F(CommandLine, names_the_target_that_builds_emulated_boards) {
    std::filesystem::copy_file(OCTOSKIN_LAB_PROGRAM, path("octoskin-lab"));  // nothing lies beside it
    EXPECT_THAT(
        failure_in(run(path("octoskin-lab") + " --json-errors simulate " + path("out") +
                       " --board emulated --image " + source("README.md") + " --rig " +
                       source("hw/rigs/experiment.yaml") + " --scenario " +
                       source("hw/worlds/experiment.scenario.yaml"))),
        fails_with(69, code_is(ErrorCode::no_program), path_is(path("octoskin_board")),
                   remedy_is(HasSubstr("cmake --build --preset host-release --target octoskin_board")),
                   others_are(HasSubstr("--board"))));
}

TEST_F(CommandLine, says_what_a_seed_is) {
    for (const std::string seed : {"-1", "abc", "1.5", "18446744073709551616"}) {
        for (const std::string& command : {"simulate " + path("out") + " --seed " + seed,
                                           "experiment --out " + path("out") + " --seeds " + seed}) {
            const bool is_experiment = command.starts_with("experiment");
            EXPECT_THAT(
                failure_of(command),
                fails_with(64, code_is(ErrorCode::bad_argument), key_is(is_experiment ? "--seeds" : "--seed"),
                           value_is("'" + seed + "'"), what_is(HasSubstr("from 0 to 2^64 - 1"))));
            EXPECT_LT(octoskin(command).output.size(), 300U) << command;
        }
    }
}

TEST_F(CommandLine, takes_each_seed_and_each_configuration_once) {
    EXPECT_THAT(failure_of("experiment --seeds 3 0 3 --out " + path("out")),
                fails_with(64, code_is(ErrorCode::duplicate), key_is("--seeds"), value_is("3 again")));
    EXPECT_THAT(
        failure_of("experiment --configurations paper robust paper --out " + path("out")),
        fails_with(64, code_is(ErrorCode::duplicate), key_is("--configurations"), value_is("'paper' again")));
    EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(CommandLine, answers_64_to_what_can_be_no_interface_and_no_socket) {
    const std::string daemon =
        "run --no-camera --rig " + source("hw/rigs/experiment.yaml") + " --maps " + path("maps") + " --can ";
    for (const std::string& file : {std::string("/dev/null"), source("README.md")})
        EXPECT_THAT(failure_of(daemon + "fd:0 < " + file),
                    fails_with(64, code_is(ErrorCode::wrong_kind_of_file), path_is("fd:0"),
                               remedy_is(HasSubstr("raw CAN socket"))));
    const auto expect_bad_name = [](const std::string& arguments, const std::string& name) {
        EXPECT_THAT(failure_of(arguments),
                    fails_with(64, code_is(ErrorCode::bad_name), value_is("'" + name + "'")))
            << arguments;
    };
    for (const char* name : {"a_name_too_long_", "a b", "can#0", "123#00", "fd:0000000000000", ""})
        expect_bad_name(daemon + "'" + name + "'", name);
    for (const std::string& command :
         {"joints --rig " + source("hw/rigs/experiment.yaml"), std::string("command 1 stop")})
        expect_bad_name(command + " --can '123#00' < /dev/null", "123#00");
    const std::string long_path = path(std::string(120, 's'));
    for (const std::string& command : {daemon + "can0", std::string("status")})
        EXPECT_THAT(failure_of(command + " --socket " + long_path),
                    fails_with(64, code_is(ErrorCode::bad_name), path_is(long_path),
                               what_is(HasSubstr("1 to 107 bytes")),
                               value_is(std::to_string(long_path.size()) + " bytes")));
}

TEST_F(CommandLine, answers_66_wherever_a_file_is_not_there) {
    record_short("rec");
    const std::string nope = path("nope.yaml");
    for (const std::string& command :
         {"simulate " + path("o") + " --rig " + nope, "simulate " + path("o") + " --world " + nope,
          "simulate " + path("o") + " --scenario " + nope, "simulate " + path("o") + " --robot " + nope,
          "replay " + path("rec") + " --rig " + nope, "replay " + nope, "rig " + nope,
          "replay " + path("rec") + " --configuration " + nope, "mapping " + nope, "evaluate " + nope,
          "evaluate " + path("rec") + " --scenario " + nope,
          "experiment --out " + path("o") + " --rig " + nope,
          "experiment --out " + path("o") + " --configurations " + nope}) {
        const Failure failure = failure_of(command);
        EXPECT_THAT(failure, fails_with(66, code_is(ErrorCode::not_found))) << command;
        // A configuration may be a word, too.
        const bool is_word = failure.error.key == "configuration";
        EXPECT_EQ(is_word ? failure.error.value : failure.error.file.string(),
                  is_word ? "'" + nope + "'" : nope)
            << command;
    }
    EXPECT_FALSE(std::filesystem::exists(path("o")));
}

TEST_F(CommandLine, refuses_a_camera_that_nobody_would_use) {
    record_short("rec");
    const std::string run_on =
        "run --can fd:0 --maps " + path("maps") + " --socket " + path("socket") + " --rig ";
    for (const std::string& command :
         {run_on + source("hw/rigs/experiment.yaml") + " --no-camera --camera x",
          run_on + source("hw/rigs/bench_one_board.yaml") + " --camera /no/such.oni",
          "replay " + path("rec") + " --camera freiburg1",
          "explain 0 0 1 --camera freiburg1 --recording " + path("rec"),
          "replay " + path("rec") + " --camera freiburg1 --onto nocan9",
          "replay " + path("rec") + " --camera freiburg1 --rig " + path("rec/rig.yaml")}) {
        const Said said =
            run("python3 -c 'import os, socket, sys; a, b = socket.socketpair(socket.AF_UNIX, "
                "socket.SOCK_SEQPACKET); os.dup2(a.fileno(), 0); os.execvp(sys.argv[1], sys.argv[1:])' "
                "timeout 20 " +
                typed_for_error(command));
        const Failure failure = failure_in(said);
        EXPECT_THAT(failure, fails_with(64)) << command;
        // Of two options that exclude each other, CLI11 gives one sentence with both.
        EXPECT_THAT(failure.error,
                    AnyOf(AllOf(code_is(ErrorCode::bad_argument), what_is(HasSubstr("--camera"))),
                          AllOf(code_is(ErrorCode::conflict), key_is("--camera"))))
            << command;
    }
    EXPECT_FALSE(std::filesystem::exists(path("maps")));
    EXPECT_FALSE(std::filesystem::exists(path("rec/maps")));
}

TEST_F(CommandLine, tells_how_much_of_a_robot_the_self_filter_sees) {
    const Said whole = octoskin("rig " + source("hw/rigs/bench_one_board.yaml"));
    EXPECT_EQ(whole.exit_code, 0);
    EXPECT_THAT(whole.output,
                AllOf(HasSubstr("robot panda.urdf: 9 links at or below panda_link0, 8 capsules\n"),
                      Not(HasSubstr("<collision>"))));
    write(path("bare.urdf"), std::regex_replace(content(source("hw/robots/panda.urdf")),
                                                std::regex("(</?)collision"), "$1visual"));
    const Said bare =
        octoskin("rig " + source("hw/rigs/bench_one_board.yaml") + " --robot " + path("bare.urdf"));
    EXPECT_EQ(bare.exit_code, 0);
    EXPECT_THAT(bare.output, AllOf(HasSubstr("9 links at or below panda_link0, 0 capsules\n"),
                                   HasSubstr("no link at or below panda_link0 has a <collision>")));
    record_short("rec");
    const Said replayed = octoskin("replay " + path("rec") + " --robot " + path("bare.urdf"));
    EXPECT_THAT(replayed.output, HasSubstr("no link at or below panda_link0 has a <collision>"));
    // Before the work, whatever becomes of that; and once.
    write(path("rec/can.log"), "no log\n");
    for (const std::string& command :
         {"replay " + path("rec"), "explain 0 0 1 --recording " + path("rec"),
          "evaluate " + path("rec") + " --scenario " + source("tests/data/short/scenario.yaml")}) {
        const Said failed = octoskin(command + " --robot " + path("bare.urdf"));
        EXPECT_EQ(failed.exit_code, 65) << failed.output;
        EXPECT_THAT(failed.output,
                    ContainsRegex("warning no link at or below panda_link0 has a <collision>"
                                  "[^\n]*\n([^\n]* warning [^\n]*\n)?[^\n]* error [^\n]*can.log"));
    }
}

/// The first block of code in this language in docs/how-to/own-robot.md.
std::string snippet(const std::string& language) {
    const std::string text = content(source("docs/how-to/own-robot.md"));
    const std::string begin = "\n```" + language + "\n";
    const auto from = text.find(begin) + begin.size();
    return text.substr(from, text.find("\n```\n", from) + 1 - from);
}

TEST_F(CommandLine, takes_an_arm_with_a_hand_as_its_document_says) {
    const std::string rig = "rig " + source("hw/rigs/bench_one_board.yaml") + " --robot ";
    // As Franka's description is, with a mesh for each body, capsules beside it, and two fingers.
    const std::string mesh =
        "<collision><geometry><mesh filename=\"package://no/such.stl\"/></geometry></collision>";
    std::string vendors = content(source("hw/robots/panda.urdf"));
    vendors = std::regex_replace(vendors, std::regex("<link name=\"panda_link5\"/>"),
                                 "<link name=\"panda_link5\">" + mesh + "</link>");
    const auto finger = [&mesh](const std::string& number, const std::string& mimic) {
        return "<joint name=\"panda_finger_joint" + number +
               "\" type=\"prismatic\"><parent link=\"panda_link8\"/><child link=\"panda_finger" + number +
               "\"/><axis xyz=\"0 1 0\"/><limit lower=\"0\" upper=\"0.04\" velocity=\"0.2\" effort=\"20\"/>" +
               mimic + "</joint><link name=\"panda_finger" + number + "\">" + mesh + "</link>";
    };
    vendors.insert(vendors.rfind("</robot>"),
                   finger("1", "") + finger("2", "<mimic joint=\"panda_finger_joint1\"/>"));
    write(path("vendor.urdf"), vendors);
    EXPECT_THAT(failure_of(rig + path("vendor.urdf")),
                fails_with(78, code_is(ErrorCode::missing_key),
                           path_is(source("hw/rigs/bench_one_board.yaml")), key_is("joints.names"),
                           remedy_is(AllOf(HasSubstr("in another source"), HasSubstr("type=\"fixed\""))),
                           value_is("none named panda_finger_joint1")));
    write(path("fit.py"), snippet("python"));
    const Said fitted = run("python3 " + path("fit.py") + " " + path("vendor.urdf") + " " + path("my.urdf"));
    EXPECT_EQ(fitted.exit_code, 0) << fitted.output;
    const Said taken = octoskin(rig + path("my.urdf"));
    EXPECT_EQ(taken.exit_code, 0) << taken.output;
    EXPECT_THAT(taken.output, HasSubstr("11 links at or below panda_link0, 8 capsules"));

    std::string with_hand = content(source("hw/robots/panda.urdf"));
    with_hand.insert(with_hand.rfind("</robot>"), snippet("xml"));
    write(path("hand.urdf"), with_hand);
    const Said hand = octoskin(rig + path("hand.urdf"));
    EXPECT_EQ(hand.exit_code, 0) << hand.output;
    EXPECT_THAT(hand.output, HasSubstr("10 links at or below panda_link0, 10 capsules"));
}

TEST_F(CommandLine, knows_the_same_configurations_in_every_command) {
    EXPECT_THAT(failure_of("mapping robsut"),
                fails_with(66, code_is(ErrorCode::not_found), key_is("configuration"), value_is("'robsut'"),
                           what_is(HasSubstr("paper, paper_noise_free_robot_seen, robust, fast")),
                           remedy_is(HasSubstr("did you mean robust?"))));
    const Said seen = octoskin("mapping paper_noise_free_robot_seen");
    EXPECT_EQ(seen.exit_code, 0);
    EXPECT_THAT(seen.output,
                AllOf(HasSubstr("removes_robot_from_depth: false"), HasSubstr("depth_update: paper")));

    write(path("mine.yaml"), "base: paper\n");
    write(path("coarse.yaml"), "map: {resolution_m: 0.08}\n");
    write(path("run.yaml"), "base: paper\n");
    const std::string experiment = "experiment --rig " + source("tests/data/short/rig.yaml") +
                                   " --scenario " + source("tests/data/short/scenario.yaml") + " --out " +
                                   path("out") + " --configurations ";
    EXPECT_THAT(failure_of(experiment + "robust " + path("coarse.yaml")),
                fails_with(64, code_is(ErrorCode::conflict), key_is("--configurations"),
                           what_is(HasSubstr("'robust' and 'coarse'")), value_is("0.04 m and 0.08 m")));
    EXPECT_THAT(failure_of(experiment + path("run.yaml")),  // metrics.json's own key
                fails_with(64, code_is(ErrorCode::bad_name), path_is(path("run.yaml")), value_is("'run'"),
                           remedy_is(HasSubstr("rename"))));
    const Said both = octoskin(experiment + "paper " + path("mine.yaml"));
    ASSERT_EQ(both.exit_code, 0) << both.output;
    // The same equations under another name give the same figures.
    EXPECT_THAT(both.output, AllOf(HasSubstr("mine, one seed"), HasSubstr("paper, one seed")));
}

TEST_F(CommandLine, tells_the_version_with_its_commit) {
    const Said said = octoskin("--version");
    EXPECT_EQ(said.exit_code, 0);
    EXPECT_THAT(said.output, testing::ContainsRegex(
                                 "octoskin [0-9.]+ \\(commit ([0-9a-f]{12}|unknown)(, with changes)?\\)"));
}

TEST_F(CommandLine, tells_the_load_of_every_bus_of_a_rig) {
    const Said said = octoskin("rig " + source("hw/rigs/experiment.yaml"));
    EXPECT_EQ(said.exit_code, 0);
    EXPECT_THAT(said.output, testing::ContainsRegex("I2C bus 0 at [0-9]+ kHz: load [0-9.]+ %, at most 70 %"));
    EXPECT_THAT(said.output, testing::ContainsRegex("CAN FD .*load [0-9.]+ %"));
}

TEST_F(CommandLine, tells_of_sensors_in_one_light_by_groups_and_not_by_pairs) {
    std::string text = content(source("hw/rigs/one_board_17.yaml"));
    text = std::regex_replace(text, std::regex("phase_us: [0-9]+"), "phase_us: 0");
    text = std::regex_replace(text, std::regex("rpy_deg: \\[[^\\]]*\\]"), "rpy_deg: [0, 90, 0]");
    text = std::regex_replace(text, std::regex("bench_one_board"), source("hw/rigs/bench_one_board"));
    text = std::regex_replace(text, std::regex("\\.\\./boards"), source("hw/boards"));
    write(path("rig.yaml"), text);
    const Said said = octoskin("rig " + path("rig.yaml"));
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, HasSubstr("    side_0, side_1, side_2"));
    EXPECT_THAT(said.output, HasSubstr("front_7: neighbours among these see the same light"));
    EXPECT_LT(std::count(said.output.begin(), said.output.end(), '\n'), 12) << said.output;
}

/// That it fails for its standard output, which `redirection` replaces, with the reason of the system.
void expect_unwritten(const std::string& redirection, const std::string& arguments,
                      const std::string& reason) {
    EXPECT_THAT(
        failure_in(run("( " + typed_for_error(arguments) + " " + redirection + " )")),
        fails_with(74, code_is(ErrorCode::system_error), path_is("standard output"),
                   what_is(HasSubstr("(" + reason + ")")), others_are(HasSubstr("output is incomplete"))))
        << arguments;
}

TEST_F(CommandLine, a_standard_output_that_takes_nothing_is_a_failure_of_every_command) {
    const std::string short_files = " --rig " + source("tests/data/short/rig.yaml") + " --scenario " +
                                    source("tests/data/short/scenario.yaml");
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    for (const std::string& arguments :
         {std::string("--help"), std::string("--version"), std::string("replay --help"),
          std::string("mapping"), "rig " + source("hw/rigs/experiment.yaml"),
          "rig --canonical " + source("hw/rigs/experiment.yaml"), "simulate " + path("again") + short_files,
          "replay " + path("rec") + " --out " + path("maps")}) {
        expect_unwritten("> /dev/full", arguments, "No space left on device");
    }
    // What was to be written is written all the same.
    EXPECT_EQ(content(path("maps/fused.ot")), content(path("rec/maps/fused.ot")));
    EXPECT_EQ(content(path("again/can.log")), content(path("rec/can.log")));
}

TEST_F(CommandLine, a_reader_that_goes_away_is_no_failure) {
    const Said said = run("( ( " OCTOSKIN_PROGRAM " rig --canonical " + source("hw/rigs/experiment.yaml") +
                          "; echo code $? >&2 ) | true )");
    EXPECT_EQ(said.output, "code 0\n");
}

TEST_F(CommandLine, a_closed_standard_output_is_told_and_goes_into_no_file) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    expect_unwritten("<&- >&-", "replay " + path("rec") + " --out " + path("maps"), "Bad file descriptor");
    for (const char* file : {"fused.ot", "fused.bt", "fused.ply", "depth.ot", "proximity.ot"}) {
        EXPECT_EQ(content(path(std::string("maps/") + file)), content(path(std::string("rec/maps/") + file)));
    }
}

TEST_F(CommandLine, a_pipe_or_a_device_for_a_file_is_refused_instead_of_waited_for) {
    ASSERT_EQ(run("mkfifo " + path("pipe")).exit_code, 0);
    const std::string rig = source("tests/data/short/rig.yaml");
    const std::string base = "simulate " + path("rec") + " --rig " + rig + " ";
    for (const std::string& other : {path("pipe"), std::string("/dev/zero")}) {
        for (const std::string& arguments :
             {"rig " + other,
              "rig " + rig + " --robot " + other,
              "mapping " + other,
              "black-box " + other,
              "evaluate " + other + " --rig " + rig,
              "evaluate " + path("") + " --scenario " + other,
              "evaluate " + path("") + " --world " + other,
              "evaluate " + path("") + " --rig " + other,
              "replay " + other,
              "replay " + path("") + " --configuration " + other,
              "replay " + path("") + " --rig " + other,
              "replay " + path("") + " --robot " + other,
              "simulate " + path("rec") + " --rig " + other,
              base + "--robot " + other,
              base + "--scenario " + other,
              base + "--world " + other,
              base + "--board emulated --image " + other,
              "flash --dry-run --rig " + other,
              "flash --dry-run --rig " + rig + " --elf " + other,
              "experiment --out " + path("out") + " --rig " + other,
              "experiment --out " + path("out") + " --configurations " + other}) {
            const Failure failure = failure_in(run("timeout 20 " + typed_for_error(arguments)));
            EXPECT_TRUE(failure.exit_code >= 64 && failure.exit_code <= 78 && failure.exit_code != 70)
                << arguments << ": " << failure.exit_code << failure.output;
            EXPECT_THAT(failure.error, AllOf(code_is(ErrorCode::wrong_kind_of_file), path_is(other)))
                << arguments;
        }
    }
    // A scenario's world and a world's mesh are such files, too.
    write(path("my.scenario.yaml"),
          "extends: " + source("tests/data/short/scenario.yaml") + "\nworld: " + path("pipe") + "\n");
    EXPECT_THAT(
        failure_in(run("timeout 20 " + typed_for_error(base) + "--scenario " + path("my.scenario.yaml"))),
        fails_with(78, path_is(path("my.scenario.yaml")), line_is(2), key_is("world"),
                   value_is(HasSubstr(path("pipe")))));
}

}  // namespace
}  // namespace octoskin
