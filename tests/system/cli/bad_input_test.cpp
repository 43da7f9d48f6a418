// Bad input through the program: a clear error with its exit code, or a counter; never a crash, a hang, or a
// changed voxel.
#include <gmock/gmock.h>

#include <random>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::others_are;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class BadInput : public ProgramTest {
  protected:
    /// Replays `rec` as it now is, expects success, and hands back the fused map's bytes.
    std::string replayed_map() {
        const Said said = octoskin("replay " + path("rec") + " --out " + path("maps"));
        EXPECT_EQ(said.exit_code, 0) << said.output;
        said_ = said.output;
        return content(path("maps/fused.ot"));
    }
    std::string said_;
};

TEST_F(BadInput, the_command_line_is_refused_with_a_hint) {
    EXPECT_EQ(octoskin("").exit_code, 64);
    EXPECT_EQ(octoskin("reply").exit_code, 64);
    EXPECT_THAT(failure_of("replay somewhere --fast"),
                fails_with(64, code_is(ErrorCode::unknown_word), value_is("'--fast'"),
                           remedy_is(HasSubstr("--help"))));
    EXPECT_THAT(failure_of("replay somewhere else"),
                fails_with(64, code_is(ErrorCode::bad_argument), what_is(HasSubstr("else")),
                           remedy_is(HasSubstr("--help"))));
    EXPECT_EQ(octoskin("simulate out --seed many").exit_code, 64);
    EXPECT_EQ(octoskin("simulate out --seed -1").exit_code, 64);
    EXPECT_EQ(octoskin("--help").exit_code, 0);
    EXPECT_EQ(octoskin("replay --help").exit_code, 0);
}

TEST_F(BadInput, a_missing_recording_or_a_missing_part_of_it_is_named) {
    EXPECT_THAT(failure_of("replay " + path("nowhere")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("nowhere")),
                           remedy_is(HasSubstr("`octoskin record`"))));
    EXPECT_THAT(failure_of("explain 0 0 1"),
                fails_with(64, code_is(ErrorCode::bad_argument), key_is("--recording"),
                           remedy_is(HasSubstr("`octoskin record`"))));
    std::filesystem::create_directory(path("empty"));
    EXPECT_THAT(failure_of("explain 0 0 1 --recording " + path("empty")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("empty/can.log")),
                           remedy_is(HasSubstr("`octoskin record`"))));
    record_short("rec");
    for (const char* file : {"can.log", "rig.yaml", "robot.urdf", "meta.yaml"}) {
        std::filesystem::rename(path(std::string("rec/") + file), path("aside"));
        const Failure failure = failure_of("replay " + path("rec"));
        EXPECT_THAT(failure, fails_with(66, code_is(ErrorCode::not_found)));
        if (file == std::string("robot.urdf")) {  // the rig names it
            EXPECT_THAT(failure.error, AllOf(path_is(path("rec/rig.yaml")), key_is("robot.urdf"),
                                             value_is(HasSubstr(path("rec/robot.urdf")))));
        } else {
            EXPECT_EQ(failure.error.file, path(std::string("rec/") + file));
        }
        std::filesystem::rename(path("aside"), path(std::string("rec/") + file));
    }
}

TEST_F(BadInput, a_rig_with_a_mistake_is_refused_by_file_line_and_key) {
    EXPECT_THAT(failure_of("rig " + source("tests/data/rigs/metres-for-millimetres.yaml")),
                fails_with(78, code_is(ErrorCode::out_of_range), file_is("metres-for-millimetres.yaml"),
                           line_is(3), key_is("nodes[0].sensors[0].pose.xyz_m"), value_is("(50, 0, 20)"),
                           remedy_is(HasSubstr("millimetres"))));
    EXPECT_THAT(failure_of("rig " + source("tests/data/rigs/can-overloaded.yaml")),
                fails_with(78, code_is(ErrorCode::overload), file_is("can-overloaded.yaml"), line_is(2),
                           key_is("bus"), what_is(HasSubstr("70 %")), value_is(HasSubstr("71.1 %")),
                           remedy_is(HasSubstr("inter_measurement_ms"))));
    EXPECT_THAT(failure_of("rig " + source("hw/rigs/experiment.yaml") + " --robot " +
                           source("tests/data/gantry/gantry.urdf")),
                fails_with(78, code_is(ErrorCode::unknown_name), key_is("robot.base_link"),
                           what_is(HasSubstr("gantry.urdf")), value_is("'panda_link0'")));
}

TEST_F(BadInput, an_unsupported_shape_in_a_world_is_named) {
    EXPECT_THAT(
        failure_of("simulate " + path("rec") + " --world " + source("tests/data/worlds/cone-element.sdf")),
        fails_with(65, path_is(source("tests/data/worlds/cone-element.sdf")), key_is(HasSubstr("pylon")),
                   what_is(HasSubstr("cone"))));
}

TEST_F(BadInput, a_mapping_file_with_an_unknown_key_is_refused) {
    record_short("rec");
    write(path("mapping.yaml"), "base: paper\nmodell:\n  miss_log_odds: -0.4\n");
    EXPECT_THAT(failure_of("replay " + path("rec") + " --configuration " + path("mapping.yaml")),
                fails_with(78, code_is(ErrorCode::unknown_key), path_is(path("mapping.yaml")), line_is(2),
                           key_is("modell"), remedy_is(HasSubstr("known here are base, map"))));
}

TEST_F(BadInput, foreign_lines_and_frames_in_the_log_are_counted_and_change_no_voxel) {
    record_short("rec");
    const std::string clean = replayed_map();
    const std::string log = content(path("rec/can.log"));
    std::string dirty;
    std::size_t line_number = 0;
    for (std::size_t begin = 0; begin < log.size();) {
        const std::size_t end = log.find('\n', begin) + 1;
        const std::string line = log.substr(begin, end - begin);
        const std::string stamp = line.substr(0, line.find(')') + 1) + " can0 ";
        dirty += line;
        switch (line_number++ % 400) {
            case 0:
                dirty += "\n";
                break;
            case 50:
                dirty += "(not a time) can0 123#00\n";
                break;
            case 100:
                dirty += stamp + "7FF#1122334455667788\n";
                break;  // an identifier of nobody
            case 150:
                dirty += stamp + "1FFFFFFF#00\n";
                break;  // extended
            case 200:
                dirty += stamp + "201#R\n";
                break;  // remote
            case 250:
                dirty += stamp + "201#0011223344556677\n";
                break;  // RANGE of node 1, wrong CRC
            case 300:
                dirty += stamp + "141#01\n";
                break;  // heartbeat, wrong length
            case 350:
                dirty += stamp + "02F##1zz\n";
                break;  // not hexadecimal
            default:
                break;
        }
        begin = end;
    }
    dirty += "(1750000009.000000) can0 201#0011223";  // the file ends in mid-line
    write(path("rec/can.log"), dirty);
    EXPECT_EQ(replayed_map(), clean);
    for (const char* counter : {"line_blank", "line_timestamp", "line_data", "line_truncated"}) {
        EXPECT_THAT(said_, HasSubstr(counter));
    }
    EXPECT_THAT(said_, Not(HasSubstr("log lines " + std::to_string(line_number) +
                                     " in = " + std::to_string(line_number))));
}

TEST_F(BadInput, random_bytes_in_the_log_never_crash_the_replay) {
    record_short("rec");
    const std::string log = content(path("rec/can.log"));
    for (const unsigned seed : {1U, 2U, 3U}) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        std::string broken = log;
        for (int i = 0; i < 2000; ++i) broken[random() % broken.size()] = static_cast<char>(random() % 256);
        write(path("rec/can.log"), broken);
        // Done, or done with an empty map; never a signal, a defect, or an account that do not balance.
        const Said said = octoskin("replay " + path("rec"));
        EXPECT_TRUE(said.exit_code == 0 || said.exit_code == 1) << said.exit_code;
        EXPECT_THAT(said.output, Not(HasSubstr("do not balance")));
        EXPECT_THAT(said.output, HasSubstr("log lines"));
    }
}

TEST_F(BadInput, a_recording_without_joints_maps_nothing_and_says_why) {
    record_short("rec");
    // Joint states of node 3 have the identifier (6 << 6) | 3 = 0x183.
    ASSERT_EQ(run("sed -i '/ can0 183#/d' " + path("rec/can.log")).exit_code, 0);
    const Said said = octoskin("replay " + path("rec"));
    EXPECT_EQ(said.exit_code, 1);
    EXPECT_THAT(said.output, HasSubstr("joints_missing"));
    EXPECT_THAT(said.output, HasSubstr("part of the log is missing"));
    EXPECT_THAT(said.output, HasSubstr("no measurement entered the map"));
}

TEST_F(BadInput, a_start_mark_more_than_a_second_off_is_told_and_leaves_no_map_empty) {
    record_short("rec");
    // The recording's START, sent 1.25 s later than the time that it names: MARK of the host is 0x100.
    ASSERT_EQ(
        run("awk '/ 100#/ && !seen { held = $3; seen = 1; match($1, /[0-9.]+/); due = "
            "substr($1, RSTART, RLENGTH) + 1.25; next } held { match($1, /[0-9.]+/); if (substr($1, RSTART, "
            "RLENGTH) + 0 >= due) { print $1, $2, held; held = \"\" } } { print }' " +
            path("rec/can.log") + " > " + path("moved.log") + " && mv " + path("moved.log") + " " +
            path("rec/can.log"))
            .exit_code,
        0);
    const std::string map = replayed_map();
    EXPECT_GT(map.size(), 1000U);
    EXPECT_THAT(said_, HasSubstr("mark_ignored"));
    EXPECT_THAT(said_, testing::ContainsRegex("START not used.* -1\\.2[0-9]+ s from its arrival"));
    EXPECT_THAT(said_, HasSubstr("the map begins at the first usable reading"));
}

TEST_F(BadInput, a_node_with_another_configuration_is_refused_by_name) {
    record_short("rec");
    // Another period on node 1's sensors: another node_hash than the one that the recording's nodes told.
    ASSERT_EQ(run("sed -i '0,/inter_measurement_ms: 33/s//inter_measurement_ms: 40/' " + path("rec/rig.yaml"))
                  .exit_code,
              0);
    const Said said = octoskin("replay " + path("rec"));
    EXPECT_EQ(said.exit_code, 1) << said.output;  // most readings are lost
    EXPECT_THAT(said.output, HasSubstr("node_info_mismatch"));
    EXPECT_THAT(said.output,
                testing::ContainsRegex(
                    "  1 rear_rings .*info_mismatch: .*node_hash [0-9a-f]+, the rig has [0-9a-f]+"));
    EXPECT_THAT(said.output, testing::ContainsRegex("  2 front_rings .* 0  usable"));
}

TEST_F(BadInput, the_same_bus_logged_twice_gives_the_same_map) {
    record_short("rec");
    const std::string clean = replayed_map();
    ASSERT_EQ(run("sed -i 'p; s/ can0 / can1 /' " + path("rec/can.log")).exit_code, 0);
    EXPECT_EQ(replayed_map(), clean);
    EXPECT_THAT(said_, HasSubstr("other_interface"));
}

TEST_F(BadInput, a_broken_meta_file_is_named) {
    record_short("rec");
    for (const char* text : {"", "schema: other\n", "schema: octoskin-recording/1\nseed: nan\n", "a: [\n"}) {
        write(path("rec/meta.yaml"), text);
        EXPECT_THAT(failure_of("replay " + path("rec")), fails_with(65, path_is(path("rec/meta.yaml"))))
            << text;
    }
    for (const char* file : {"meta.yaml", "depth.epoch.yaml", "can.log"}) {
        std::filesystem::remove_all(path("rec"));
        record_short("rec");
        std::filesystem::remove(path(std::string("rec/") + file));
        std::filesystem::create_directory(path(std::string("rec/") + file));
        EXPECT_THAT(
            failure_of("replay " + path("rec")),
            fails_with(66, code_is(ErrorCode::wrong_kind_of_file), path_is(path(std::string("rec/") + file)),
                       remedy_is(HasSubstr("move it away"))));
        std::filesystem::remove(path(std::string("rec/") + file));
    }
}

TEST_F(BadInput, a_map_that_runs_out_of_room_says_so_and_fails) {
    record_short("rec");
    write(path("mapping.yaml"), "base: robust\nmap: {memory_max_mib: 1}\n");
    EXPECT_THAT(failure_of("replay " + path("rec") + " --configuration " + path("mapping.yaml")),
                fails_with(1, code_is(ErrorCode::too_large), remedy_is(HasSubstr("map.memory_max_mib"))));
}

// A few lines of a foreign recording must not take all memory of the machine.
TEST_F(BadInput, a_recordings_own_mapping_must_fit_the_machine_unless_it_is_named) {
    record_short("rec");
    write(path("rec/mapping.yaml"), "base: robust\nmap: {memory_max_mib: 1000000}\n");
    EXPECT_THAT(failure_of("replay " + path("rec")),
                fails_with(78, code_is(ErrorCode::no_resources), path_is(path("rec/mapping.yaml")),
                           key_is(HasSubstr("map.memory_max_mib")), value_is(HasSubstr("1000000")),
                           remedy_is(HasSubstr("--configuration"))));
    const Said named = octoskin("replay " + path("rec") + " --configuration " + path("rec/mapping.yaml"));
    EXPECT_EQ(named.exit_code, 0) << named.output;
}

TEST_F(BadInput, a_recording_without_its_depth_maps_the_ranges_and_says_so) {
    record_short("rec");
    std::filesystem::remove(path("rec/depth.oni"));
    std::filesystem::remove(path("rec/depth.epoch.yaml"));
    const Said said = octoskin("replay " + path("rec"));
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, HasSubstr("no depth.oni"));
}

TEST_F(BadInput, a_truncated_oni_gives_its_whole_frames_and_says_what_is_lost) {
    record_short("rec");
    static_cast<void>(replayed_map());
    const std::string proximity = content(path("maps/proximity.ot"));
    const std::string oni = content(path("rec/depth.oni"));
    write(path("rec/depth.oni"), oni.substr(0, oni.size() / 2));
    const Said said = octoskin("replay " + path("rec") + " --out " + path("half"));
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output,
                testing::ContainsRegex(
                    "depth.oni: was cut off; [56] of its 12 frames are complete and used, [67] are lost"));
    EXPECT_EQ(content(path("half/proximity.ot")), proximity);
    EXPECT_NE(content(path("half/depth.ot")), content(path("maps/depth.ot")));
    EXPECT_GT(content(path("half/depth.ot")).size(), 1000U);
    // Of nothing comes nothing: a map of the ranges alone would look like a fused one. It is made only of a
    // recording that says that it has no camera.
    write(path("rec/depth.oni"), oni.substr(0, 2000));
    const Failure nothing = failure_of("replay " + path("rec") + " --out " + path("cut"));
    EXPECT_THAT(nothing, fails_with(65, code_is(ErrorCode::foreign_format), path_is(path("rec/depth.oni")),
                                    remedy_is(HasSubstr("move depth.oni and depth.epoch.yaml away")),
                                    others_are("No map is written")));
    EXPECT_THAT(nothing.output, HasSubstr("in = "));
    EXPECT_FALSE(std::filesystem::exists(path("cut")));
    std::filesystem::rename(path("rec/depth.oni"), path("depth.oni"));
    std::filesystem::rename(path("rec/depth.epoch.yaml"), path("depth.epoch.yaml"));
    ASSERT_EQ(octoskin("replay " + path("rec") + " --out " + path("cut")).exit_code, 0);
    EXPECT_EQ(content(path("cut/proximity.ot")), proximity);
    std::filesystem::rename(path("depth.epoch.yaml"), path("rec/depth.epoch.yaml"));
    write(path("rec/depth.oni"), "foreign");
    EXPECT_THAT(failure_of("replay " + path("rec")),
                fails_with(65, code_is(ErrorCode::foreign_format), path_is(path("rec/depth.oni"))));
}

TEST_F(BadInput, an_output_that_cannot_be_written_is_named) {
    write(path("file"), "in the way");
    EXPECT_THAT(failure_of("simulate " + path("file/rec")), fails_with(73, path_is(path("file/rec"))));
}

TEST_F(BadInput, of_candump_without_L_names_the_way_to_record) {
    record_short("rec");
    write(path("rec/can.log"), "  can0  141   [8]  01 02 03 04 05 06 07 08\n");
    for (const std::string& command : {"replay " + path("rec"), "black-box " + path("rec/can.log")}) {
        EXPECT_THAT(failure_of(command),
                    fails_with(65, code_is(ErrorCode::foreign_format), path_is(path("rec/can.log")),
                               line_is(1), what_is(HasSubstr("does not begin with a time in parentheses")),
                               value_is(HasSubstr("can0  141   [8]  01 02")),
                               remedy_is(HasSubstr("candump -L can0 > can.log"))));
    }
    write(path("rec/can.log"), "");
    EXPECT_THAT(failure_of("black-box " + path("rec/can.log")),
                fails_with(65, code_is(ErrorCode::no_content), path_is(path("rec/can.log"))));
    EXPECT_THAT(failure_of("replay " + path("rec")),
                fails_with(1, code_is(ErrorCode::no_content), what_is(HasSubstr("can.log is empty"))));
}

}  // namespace
}  // namespace octoskin
