// What is typed wrongly: one exit code for each kind of mistake, and words that name the culprit and the way
// out.
#include <gmock/gmock.h>

#include <algorithm>
#include <regex>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class CommandLine : public ProgramTest {};

TEST_F(CommandLine, names_the_command_that_is_none_and_the_one_that_is_like_it) {
    const Said near = octoskin("reply x");
    EXPECT_EQ(near.exit_code, 64);
    EXPECT_THAT(near.output, AllOf(HasSubstr("'reply'"), HasSubstr("did you mean 'replay'?")));
    const Said far = octoskin("frobnicate");
    EXPECT_EQ(far.exit_code, 64);
    EXPECT_THAT(far.output, HasSubstr("'frobnicate'. The commands are replay"));
    EXPECT_THAT(far.output,
                AllOf(HasSubstr("'frobnicate'"), Not(HasSubstr("did you mean")), HasSubstr("repair")));
    const Said of_lab = run(OCTOSKIN_PROGRAM " simulate x");
    EXPECT_EQ(of_lab.exit_code, 64);
    EXPECT_THAT(of_lab.output, HasSubstr("octoskin-lab"));
}

TEST_F(CommandLine, helps_with_options_as_they_are_typed_and_with_exit_codes) {
    for (const std::string command : {"run", "joints"}) {
        const Said said = octoskin(command + " --help");
        EXPECT_EQ(said.exit_code, 0);
        EXPECT_THAT(said.output, AllOf(HasSubstr("Exit codes: 0 "), Not(HasSubstr("{false}")))) << command;
    }
}

TEST_F(CommandLine, names_the_target_that_builds_emulated_boards) {
    std::filesystem::copy_file(OCTOSKIN_LAB_PROGRAM, path("octoskin-lab"));  // nothing lies beside it
    const Said said = run(path("octoskin-lab") + " simulate " + path("out") + " --board emulated --image " +
                          source("README.md") + " --rig " + source("hw/rigs/experiment.yaml") +
                          " --scenario " + source("hw/worlds/experiment.scenario.yaml"));
    EXPECT_EQ(said.exit_code, 69) << said.output;
    EXPECT_THAT(said.output, HasSubstr("cmake --build --preset host-release --target octoskin_board"));
}

TEST_F(CommandLine, says_what_a_seed_is) {
    for (const std::string seed : {"-1", "abc", "1.5", "18446744073709551616"}) {
        for (const std::string& command : {"simulate " + path("out") + " --seed " + seed,
                                           "experiment --out " + path("out") + " --seeds " + seed}) {
            const Said said = octoskin(command);
            EXPECT_EQ(said.exit_code, 64) << said.output;
            EXPECT_THAT(said.output, AllOf(HasSubstr("whole number from 0 to 2^64 - 1"), HasSubstr(seed)))
                << command;
            EXPECT_LT(said.output.size(), 300U) << said.output;
        }
    }
}

TEST_F(CommandLine, takes_each_seed_and_each_configuration_once) {
    const Said seeds = octoskin("experiment --seeds 3 0 3 --out " + path("out"));
    EXPECT_EQ(seeds.exit_code, 64) << seeds.output;
    EXPECT_THAT(seeds.output, HasSubstr("3 is given twice"));
    const Said names = octoskin("experiment --configurations paper robust paper --out " + path("out"));
    EXPECT_EQ(names.exit_code, 64) << names.output;
    EXPECT_THAT(names.output, HasSubstr("'paper' is given twice"));
    EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(CommandLine, answers_64_to_what_can_be_no_interface_and_no_socket) {
    const std::string daemon =
        "run --no-camera --rig " + source("hw/rigs/experiment.yaml") + " --maps " + path("maps") + " --can ";
    const auto expect = [](const std::string& arguments, const std::string& why) {
        const Said said = octoskin(arguments);
        EXPECT_EQ(said.exit_code, 64) << arguments << ": " << said.output;
        EXPECT_NE(said.output.find(why), std::string::npos) << arguments << ": " << said.output;
    };
    expect(daemon + "fd:0 < /dev/null", "fd:0 is not a socket");
    expect(daemon + "fd:0 < " + source("README.md"), "fd:0 is not a socket");
    for (const char* name : {"a_name_too_long_", "a b", "can#0", "123#00", "fd:0000000000000", ""})
        expect(daemon + "'" + name + "'", "'" + std::string(name) + "': a CAN interface's name");
    for (const std::string& command :
         {"joints --rig " + source("hw/rigs/experiment.yaml"), std::string("command 1 stop")})
        expect(command + " --can '123#00' < /dev/null", "'123#00': a CAN interface's name");
    const std::string long_path = path(std::string(120, 's'));
    expect(daemon + "can0 --socket " + long_path, "1 to 107 bytes");
    expect("status --socket " + long_path, "1 to 107 bytes");
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
        const Said said = octoskin(command);
        EXPECT_EQ(said.exit_code, 66) << command << ": " << said.output;
        EXPECT_THAT(said.output, HasSubstr(nope)) << command;
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
                typed(command));
        EXPECT_EQ(said.exit_code, 64) << command << ": " << said.output;
        EXPECT_THAT(said.output, HasSubstr("--camera")) << command;
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
    const Said refused = octoskin(rig + path("vendor.urdf"));
    EXPECT_EQ(refused.exit_code, 78);
    EXPECT_THAT(refused.output,
                HasSubstr("expected at most 7 moving joints, found 9 in vendor.urdf; not named "
                          "are panda_finger_joint1, panda_finger_joint2"));
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
    const Said near = octoskin("mapping robsut");
    EXPECT_EQ(near.exit_code, 66);
    EXPECT_THAT(near.output, AllOf(HasSubstr("paper, paper_noise_free_robot_seen, robust, fast"),
                                   HasSubstr("did you mean robust?")));
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
    const Said coarse = octoskin(experiment + "robust " + path("coarse.yaml"));
    EXPECT_EQ(coarse.exit_code, 64) << coarse.output;
    EXPECT_THAT(coarse.output, AllOf(HasSubstr("0.04 m and 0.08 m"), HasSubstr("'coarse'")));
    EXPECT_EQ(octoskin(experiment + path("run.yaml")).exit_code, 64);  // metrics.json's own key
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

/// With standard output as `redirection` says; only standard error is kept.
Said octoskin_into(const std::string& redirection, const std::string& arguments) {
    return run("( " + typed(arguments) + " " + redirection + " )");
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
        const Said said = octoskin_into("> /dev/full", arguments);
        EXPECT_EQ(said.exit_code, 74) << arguments << ": " << said.output;
        EXPECT_THAT(said.output, HasSubstr("standard output: cannot write (No space left on device)"));
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
    const Said said = octoskin_into("<&- >&-", "replay " + path("rec") + " --out " + path("maps"));
    EXPECT_EQ(said.exit_code, 74) << said.output;
    EXPECT_THAT(said.output, HasSubstr("standard output: cannot write (Bad file descriptor)"));
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
            const Said said = run("timeout 20 " + typed(arguments));
            EXPECT_TRUE(said.exit_code >= 64 && said.exit_code <= 78 && said.exit_code != 70)
                << arguments << ": " << said.exit_code << said.output;
            EXPECT_THAT(said.output, HasSubstr(other)) << arguments;
            EXPECT_THAT(said.output, testing::ContainsRegex("pipe|device|regular file|directory"))
                << arguments;
        }
    }
    // A scenario's world and a world's mesh are such files, too.
    write(path("my.scenario.yaml"),
          "extends: " + source("tests/data/short/scenario.yaml") + "\nworld: " + path("pipe") + "\n");
    const Said world = run("timeout 20 " + typed(base) + "--scenario " + path("my.scenario.yaml"));
    EXPECT_EQ(world.exit_code, 78) << world.output;
    EXPECT_THAT(world.output, HasSubstr("my.scenario.yaml:2: world"));
}

}  // namespace
}  // namespace octoskin
