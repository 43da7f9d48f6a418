// Bad input through the program: a clear error with its exit code, or a counter; never a crash, a hang, or a
// changed voxel.
#include <gmock/gmock.h>

#include <random>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing::Not;

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
    const Said unknown = octoskin("replay somewhere --fast");
    EXPECT_EQ(unknown.exit_code, 64);
    EXPECT_THAT(unknown.output, HasSubstr("--fast"));
    EXPECT_EQ(octoskin("simulate out --seed many").exit_code, 64);
    EXPECT_EQ(octoskin("simulate out --seed -1").exit_code, 64);
    EXPECT_EQ(octoskin("--help").exit_code, 0);
    EXPECT_EQ(octoskin("replay --help").exit_code, 0);
}

TEST_F(BadInput, a_missing_recording_or_a_missing_part_of_it_is_named) {
    const Said absent = octoskin("replay " + path("nowhere"));
    EXPECT_EQ(absent.exit_code, 66);
    EXPECT_THAT(absent.output,
                HasSubstr("nowhere: no such directory; `octoskin record` (of a running daemon)"));
    const Said unreported = octoskin("explain 0 0 1");
    EXPECT_EQ(unreported.exit_code, 64);
    EXPECT_THAT(unreported.output, HasSubstr("`octoskin record`"));
    std::filesystem::create_directory(path("empty"));
    const Said empty = octoskin("explain 0 0 1 --recording " + path("empty"));
    EXPECT_EQ(empty.exit_code, 66);
    EXPECT_THAT(empty.output,
                HasSubstr("can.log: no such file: this is not a recording of `octoskin record`"));
    record_short("rec");
    for (const char* file : {"can.log", "rig.yaml", "robot.urdf", "meta.yaml"}) {
        std::filesystem::rename(path(std::string("rec/") + file), path("aside"));
        const Said said = octoskin("replay " + path("rec"));
        EXPECT_EQ(said.exit_code, 66) << file;
        EXPECT_THAT(said.output, HasSubstr(file));
        std::filesystem::rename(path("aside"), path(std::string("rec/") + file));
    }
}

TEST_F(BadInput, a_rig_with_a_mistake_is_refused_by_file_line_and_key) {
    const Said said = octoskin("rig " + source("tests/data/rigs/metres-for-millimetres.yaml"));
    EXPECT_EQ(said.exit_code, 78);
    EXPECT_THAT(said.output, testing::ContainsRegex("metres-for-millimetres.yaml:[0-9]+: "));
    const Said overloaded = octoskin("rig " + source("tests/data/rigs/can-overloaded.yaml"));
    EXPECT_EQ(overloaded.exit_code, 78);
    EXPECT_THAT(overloaded.output, HasSubstr("70 %"));
    const Said robot = octoskin("rig " + source("hw/rigs/experiment.yaml") + " --robot " +
                                source("tests/data/gantry/gantry.urdf"));
    EXPECT_EQ(robot.exit_code, 78);
    EXPECT_THAT(robot.output, HasSubstr("panda"));
}

TEST_F(BadInput, an_unsupported_shape_in_a_world_is_named) {
    const Said said =
        octoskin("simulate " + path("rec") + " --world " + source("tests/data/worlds/cone-element.sdf"));
    EXPECT_EQ(said.exit_code, 65) << said.output;
    EXPECT_THAT(said.output, HasSubstr("cone-element.sdf"));
}

TEST_F(BadInput, a_mapping_file_with_an_unknown_key_is_refused) {
    record_short("rec");
    write(path("mapping.yaml"), "base: paper\nmodell:\n  miss_log_odds: -0.4\n");
    const Said said = octoskin("replay " + path("rec") + " --configuration " + path("mapping.yaml"));
    EXPECT_EQ(said.exit_code, 78);
    EXPECT_THAT(said.output, HasSubstr("mapping.yaml:2"));
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
        const Said said = octoskin("replay " + path("rec"));
        EXPECT_EQ(said.exit_code, 65) << text;
        EXPECT_THAT(said.output, HasSubstr("meta.yaml")) << text;
    }
    for (const char* file : {"meta.yaml", "depth.epoch.yaml", "can.log"}) {
        std::filesystem::remove_all(path("rec"));
        record_short("rec");
        std::filesystem::remove(path(std::string("rec/") + file));
        std::filesystem::create_directory(path(std::string("rec/") + file));
        const Said said = octoskin("replay " + path("rec"));
        EXPECT_TRUE(said.exit_code == 65 || said.exit_code == 66) << file << ": " << said.exit_code;
        EXPECT_THAT(said.output, HasSubstr(file));
        std::filesystem::remove(path(std::string("rec/") + file));
    }
}

TEST_F(BadInput, a_map_that_runs_out_of_room_says_so_and_fails) {
    record_short("rec");
    write(path("mapping.yaml"), "base: robust\nmap: {memory_max_mib: 1}\n");
    const Said said = octoskin("replay " + path("rec") + " --configuration " + path("mapping.yaml"));
    EXPECT_EQ(said.exit_code, 1) << said.output;
    EXPECT_THAT(said.output, HasSubstr("no room"));
}

// A few lines of a foreign recording must not take all memory of the machine.
TEST_F(BadInput, a_recordings_own_mapping_must_fit_the_machine_unless_it_is_named) {
    record_short("rec");
    write(path("rec/mapping.yaml"), "base: robust\nmap: {memory_max_mib: 1000000}\n");
    const Said refused = octoskin("replay " + path("rec"));
    EXPECT_EQ(refused.exit_code, 78) << refused.output;
    EXPECT_THAT(refused.output, HasSubstr("rec/mapping.yaml"));
    EXPECT_THAT(refused.output, HasSubstr("memory_max_mib"));
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
    const Said nothing = octoskin("replay " + path("rec") + " --out " + path("cut"));
    EXPECT_EQ(nothing.exit_code, 65) << nothing.output;
    EXPECT_THAT(nothing.output, HasSubstr("depth.oni: "));
    EXPECT_THAT(nothing.output, HasSubstr("in = "));
    EXPECT_THAT(nothing.output, HasSubstr("no map is written"));
    EXPECT_FALSE(std::filesystem::exists(path("cut")));
    std::filesystem::rename(path("rec/depth.oni"), path("depth.oni"));
    std::filesystem::rename(path("rec/depth.epoch.yaml"), path("depth.epoch.yaml"));
    ASSERT_EQ(octoskin("replay " + path("rec") + " --out " + path("cut")).exit_code, 0);
    EXPECT_EQ(content(path("cut/proximity.ot")), proximity);
    std::filesystem::rename(path("depth.epoch.yaml"), path("rec/depth.epoch.yaml"));
    write(path("rec/depth.oni"), "foreign");
    const Said foreign = octoskin("replay " + path("rec"));
    EXPECT_EQ(foreign.exit_code, 65);
    EXPECT_THAT(foreign.output, HasSubstr("not a recording"));
}

TEST_F(BadInput, an_output_that_cannot_be_written_is_named) {
    write(path("file"), "in the way");
    const Said said = octoskin("simulate " + path("file/rec"));
    EXPECT_EQ(said.exit_code, 73) << said.output;
    EXPECT_THAT(said.output, HasSubstr("file/rec"));
}

TEST_F(BadInput, of_candump_without_L_names_the_way_to_record) {
    record_short("rec");
    write(path("rec/can.log"), "  can0  141   [8]  01 02 03 04 05 06 07 08\n");
    for (const std::string& command : {"replay " + path("rec"), "black-box " + path("rec/can.log")}) {
        const Said said = octoskin(command);
        EXPECT_EQ(said.exit_code, 65) << said.output;
        EXPECT_THAT(said.output,
                    HasSubstr("can.log: no line is a frame in candump's format: line 1 does not begin with a "
                              "time in parentheses"));
        EXPECT_THAT(said.output, HasSubstr("record with `candump -L can0 > can.log`"));
    }
    write(path("rec/can.log"), "");
    const Said empty = octoskin("black-box " + path("rec/can.log"));
    EXPECT_EQ(empty.exit_code, 65);
    EXPECT_THAT(empty.output, HasSubstr("can.log: no frames: the log is empty"));
    EXPECT_THAT(octoskin("replay " + path("rec")).output,
                HasSubstr("no measurement entered the map: can.log is empty"));
}

}  // namespace
}  // namespace octoskin
