// What is on disk already: never destroyed unasked, and never mixed with what failed.
#include <gmock/gmock.h>
#include <sys/file.h>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::others_are;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class Overwrite : public ProgramTest {
  protected:
    [[nodiscard]] Said record(const std::string& more) const {
        return octoskin("simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                        " --scenario " + source("tests/data/short/scenario.yaml") + " " + more);
    }
    /// The failure of the same.
    [[nodiscard]] Failure fail_to_record(const std::string& more) const {
        return failure_of("simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                          " --scenario " + source("tests/data/short/scenario.yaml") + " " + more);
    }
    [[nodiscard]] std::string names_in(const std::string& folder) const {
        return run("ls -A " + path(folder)).output;
    }
};

TEST_F(Overwrite, a_recording_is_replaced_only_by_force_and_with_its_maps) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string log = content(path("rec/can.log"));
    EXPECT_THAT(fail_to_record("--seed 1"),
                fails_with(73, code_is(ErrorCode::already_exists), path_is(path("rec")),
                           what_is(HasSubstr("not empty")), remedy_is(HasSubstr("--force"))));
    EXPECT_EQ(content(path("rec/can.log")), log);
    EXPECT_TRUE(std::filesystem::exists(path("rec/maps/fused.ot")));
    const Said forced = record("--seed 1 --force");
    EXPECT_EQ(forced.exit_code, 0) << forced.output;
    EXPECT_NE(content(path("rec/can.log")), log);
    EXPECT_FALSE(std::filesystem::exists(path("rec/maps")));
}

TEST_F(Overwrite, a_robots_recording_is_not_replaced_even_by_force) {
    record_short("rec");
    write(path("rec/meta.yaml"), "schema: octoskin-recording/1\nsource: robot\n");
    const std::string log = content(path("rec/can.log"));
    EXPECT_THAT(fail_to_record("--force"),
                fails_with(73, code_is(ErrorCode::already_exists), path_is(path("rec")),
                           value_is("a can.log"), remedy_is(HasSubstr("another directory"))));
    EXPECT_EQ(content(path("rec/can.log")), log);
}

TEST_F(Overwrite, a_simulation_that_fails_leaves_nothing) {
    write(path("wide.yaml"), "extends: " + source("tests/data/short/rig.yaml") +
                                 "\ncamera: {width_px: 2048, height_px: 2048, cx_px: 1024, cy_px: 1024}\n");
    EXPECT_THAT(failure_of("simulate " + path("rec") + " --rig " + path("wide.yaml") + " --scenario " +
                           source("tests/data/short/scenario.yaml")),
                fails_with(73, code_is(ErrorCode::limit_exceeded), file_is("depth.oni"),
                           what_is(HasSubstr("2048 x 2048"))));
    EXPECT_FALSE(std::filesystem::exists(path("rec")));
}

TEST_F(Overwrite, a_replay_that_fails_leaves_the_maps_as_they_were) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string fused = content(path("rec/maps/fused.ot"));
    const std::string names = names_in("rec/maps");
    // A rig of other nodes: nothing of this log comes into its map.
    EXPECT_THAT(failure_of("replay " + path("rec") + " --rig " + source("tests/data/gantry/rig.yaml")),
                fails_with(1, code_is(ErrorCode::no_content), others_are("No map is written")));
    EXPECT_EQ(content(path("rec/maps/fused.ot")), fused);
    EXPECT_EQ(names_in("rec/maps"), names);
}

TEST_F(Overwrite, maps_that_cannot_all_be_written_leave_those_before_as_they_were) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string fused = content(path("rec/maps/fused.ot"));
    // The files beside may have a few blocks only: the first map is whole, a later one is not.
    const Said full = run("ulimit -f 300; trap '' XFSZ; " OCTOSKIN_PROGRAM " replay " + path("rec") +
                          " --configuration paper");
    EXPECT_EQ(full.exit_code, 73) << full.output;
    EXPECT_EQ(content(path("rec/maps/fused.ot")), fused);
    EXPECT_EQ(names_in("rec/maps"),
              "depth.bt\ndepth.ot\ndepth.ply\nfused.bt\nfused.ot\nfused.ply\nmaps.yaml\nproximity."
              "bt\nproximity.ot\n"
              "proximity.ply\n");
}

TEST_F(Overwrite, a_rig_and_its_files_are_not_replaced_by_what_is_made_of_them) {
    std::filesystem::copy_file(source("hw/robots/panda.urdf"), path("panda.urdf"));
    write(path("base.yaml"), "extends: " + source("hw/rigs/bench_one_board.yaml"));
    write(path("rig.yaml"), "extends: base.yaml\nrobot: {urdf: panda.urdf}\n");
    ASSERT_EQ(octoskin("rig " + path("rig.yaml") + " --picture " + path("rig.svg")).exit_code, 0);
    for (const std::string option : {"--picture ", "--block "}) {
        for (const std::string file : {"rig.yaml", "base.yaml", "panda.urdf"}) {
            const std::string before = content(path(file));
            EXPECT_THAT(failure_of("rig " + path("rig.yaml") + " " + option + path(file)),
                        fails_with(64, code_is(ErrorCode::conflict), path_is(path(file)),
                                   remedy_is(HasSubstr("another name"))));
            EXPECT_EQ(content(path(file)), before) << option << file;
        }
    }
}

TEST_F(Overwrite, no_map_of_a_camera_that_is_not_there) {
    const Said made = octoskin("simulate " + path("rec") + " --rig " + source("tests/data/gantry/rig.yaml") +
                               " --scenario " + source("tests/data/gantry/scenario.yaml"));
    ASSERT_EQ(made.exit_code, 0) << made.output;
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    EXPECT_EQ(names_in("rec/maps"),
              "fused.bt\nfused.ot\nfused.ply\nmaps.yaml\nproximity.bt\nproximity.ot\nproximity.ply\n");
}

TEST_F(Overwrite, a_log_with_its_rig_elsewhere_is_enough) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string fused = content(path("rec/maps/fused.ot"));
    std::filesystem::create_directory(path("elsewhere"));
    std::filesystem::rename(path("rec/rig.yaml"), path("elsewhere/rig.yaml"));
    std::filesystem::rename(path("rec/robot.urdf"), path("elsewhere/robot.urdf"));
    write(path("rec/meta.yaml"), "schema: octoskin-recording/1\nsource: robot\n");
    EXPECT_THAT(failure_of("replay " + path("rec")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("rec/rig.yaml")),
                           remedy_is(HasSubstr("give --rig"))));
    const Said said =
        octoskin("replay " + path("rec") + " --rig " + path("elsewhere/rig.yaml") + " --out " + path("maps"));
    ASSERT_EQ(said.exit_code, 0) << said.output;
    EXPECT_EQ(content(path("maps/fused.ot")), fused);
    EXPECT_THAT(failure_of("replay " + path("rec/can.log")),
                fails_with(66, code_is(ErrorCode::wrong_kind_of_file), path_is(path("rec/can.log")),
                           remedy_is(HasSubstr("directory, " + path("rec")))));
}

TEST_F(Overwrite, two_that_write_one_directory_at_once_are_kept_apart) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string log = content(path("rec/can.log"));
    const std::string both = "( " OCTOSKIN_LAB_PROGRAM " simulate " + path("rec") +
                             " --force --seed 7 --rig " + source("tests/data/short/rig.yaml") +
                             " --scenario " + source("tests/data/short/scenario.yaml");
    // Two simulations, started together: one is refused, and what is there is of the other alone.
    const Said said = run(both + "; echo first $? ) & " + both + "; echo second $? ) & wait");
    EXPECT_THAT(said.output, testing::AnyOf(AllOf(HasSubstr("first 0"), HasSubstr("second 73")),
                                            AllOf(HasSubstr("first 73"), HasSubstr("second 0")),
                                            // One may have been done before the other began.
                                            AllOf(HasSubstr("first 0"), HasSubstr("second 0"))));
    record_short("alone", "--seed 7");
    for (const char* file : {"can.log", "depth.oni", "rig.yaml", "meta.yaml"})
        EXPECT_EQ(content(path(std::string("rec/") + file)), content(path(std::string("alone/") + file)))
            << file;
    EXPECT_NE(content(path("rec/can.log")), log);
    EXPECT_EQ(names_in("rec"), names_in("alone"));
}

TEST_F(Overwrite, a_directory_in_use_is_named_with_what_to_do) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string again = "simulate " + path("rec") + " --force --rig " +
                              source("tests/data/short/rig.yaml") + " --scenario " +
                              source("tests/data/short/scenario.yaml");
    std::FILE* const held = std::fopen(path("rec/maps").c_str(), "r");
    ASSERT_NE(held, nullptr);
    ASSERT_EQ(::flock(::fileno(held), LOCK_EX), 0);
    EXPECT_THAT(failure_of("replay " + path("rec")),
                fails_with(73, code_is(ErrorCode::in_use), path_is(path("rec/maps")),
                           what_is(HasSubstr("writing")), remedy_is(HasSubstr("another directory"))));
    EXPECT_EQ(octoskin("replay " + path("rec") + " --out " + path("elsewhere")).exit_code, 0);
    std::fclose(held);

    std::FILE* const read = std::fopen(path("rec/meta.yaml").c_str(), "r");
    ASSERT_NE(read, nullptr);
    ASSERT_EQ(::flock(::fileno(read), LOCK_SH), 0);
    EXPECT_THAT(failure_of(again),
                fails_with(73, code_is(ErrorCode::in_use), path_is(path("rec")),
                           what_is(HasSubstr("reading")), remedy_is(HasSubstr("another directory"))));
    EXPECT_EQ(octoskin("replay " + path("rec")).exit_code, 0);  // readers do not mind each other
    ASSERT_EQ(::flock(::fileno(read), LOCK_EX), 0);
    EXPECT_THAT(failure_of("replay " + path("rec")),
                fails_with(65, code_is(ErrorCode::in_use), path_is(path("rec")),
                           what_is(HasSubstr("replacing")), remedy_is(HasSubstr("wait"))));
    std::fclose(read);
    EXPECT_EQ(octoskin(again).exit_code, 0);
}

TEST_F(Overwrite, maps_with_a_directory_in_their_way_are_refused_and_those_before_stay) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string fused = content(path("rec/maps/fused.ot"));
    const std::string origin = content(path("rec/maps/maps.yaml"));
    std::filesystem::remove(path("rec/maps/proximity.ply"));
    std::filesystem::create_directory(path("rec/maps/proximity.ply"));
    EXPECT_THAT(failure_of("replay " + path("rec") + " --configuration paper"),
                fails_with(73, code_is(ErrorCode::wrong_kind_of_file),
                           path_is(path("rec/maps/proximity.ply")), remedy_is(HasSubstr("move it away"))));
    EXPECT_EQ(content(path("rec/maps/fused.ot")), fused);
    EXPECT_EQ(content(path("rec/maps/maps.yaml")), origin);
    EXPECT_EQ(run("ls -A " + path("rec/maps") + " | grep -c octoskin").output, "0\n");
}

TEST_F(Overwrite, maps_that_a_replay_has_none_of_go_with_the_replay_before) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    write(path("rec/maps/depth.ot"), "somebody's own");
    const Said said = octoskin("replay " + path("rec") + " --fused-only");
    ASSERT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, HasSubstr("of the replay before: depth.bt, depth.ply, proximity.ot"));
    EXPECT_THAT(said.output, HasSubstr("depth.ot are there too, and are not of this replay"));
    EXPECT_EQ(names_in("rec/maps"), "depth.ot\nfused.bt\nfused.ot\nfused.ply\nmaps.yaml\n");
    EXPECT_EQ(content(path("rec/maps/depth.ot")), "somebody's own");
}

class OverwriteByExperiment : public Overwrite {
  protected:
    [[nodiscard]] std::string experiment() const {
        return "experiment --out " + path("out") + " --rig " + source("tests/data/short/rig.yaml") +
               " --scenario " + source("tests/data/short/scenario.yaml");
    }
    void expect_refused_for(const std::string& name) const {
        const Failure failure = failure_of(experiment());
        EXPECT_THAT(failure,
                    fails_with(73, code_is(ErrorCode::already_exists), path_is(path("out")),
                               value_is("'" + name + "'"), remedy_is(HasSubstr("give another directory"))));
        EXPECT_THAT(failure.output, testing::Not(HasSubstr("ground truth")));
    }
};

TEST_F(OverwriteByExperiment, replaces_nothing_that_no_experiment_left) {
    std::filesystem::create_directory(path("out"));
    write(path("out/fused.ot"), "precious");
    expect_refused_for("fused.ot");
    EXPECT_EQ(names_in("out"), "fused.ot\n");
    std::filesystem::remove(path("out/fused.ot"));
    write(path("out/thesis.txt"), "no result's name, but somebody's folder");
    expect_refused_for("thesis.txt");
    std::filesystem::remove(path("out/thesis.txt"));
    record_short("out/recording", "--seed 5");
    const std::string log = content(path("out/recording/can.log"));
    expect_refused_for("recording");  // without notes
    EXPECT_EQ(content(path("out/recording/can.log")), log);
}

TEST_F(OverwriteByExperiment, replaces_its_own_results_again_and_again) {
    ASSERT_EQ(octoskin(experiment()).exit_code, 0);
    // As docs/start/simulation.md has it: maps of the recording beside it, and something of one's own.
    ASSERT_EQ(octoskin("replay " + path("out/recording")).exit_code, 0);
    write(path("out/notes.txt"), "what I saw");
    const Said again = octoskin(experiment());
    ASSERT_EQ(again.exit_code, 0) << again.output;
    EXPECT_EQ(content(path("out/notes.txt")), "what I saw");
    const auto expect_kept = [&](const std::string& name) {
        const std::string ours = content(path("out/" + name));
        write(path("out/" + name), "precious");
        expect_refused_for(name);
        EXPECT_EQ(content(path("out/" + name)), "precious");
        write(path("out/" + name), ours);
    };
    for (const char* name : {"fused.ot", "metrics.json", "report.html", "maps.yaml", "recording/rig.yaml"})
        expect_kept(name);
    // What says whose the results are is gone, or a link, or in the way: not even the recording is new.
    const std::string log = content(path("out/recording/can.log"));
    const std::string notes = path("out/.octoskin-experiment");
    std::filesystem::rename(notes, path("notes"));
    expect_refused_for("depth.bt");
    std::filesystem::create_symlink(path("notes"), notes);
    expect_refused_for(".octoskin-experiment");
    std::filesystem::remove(notes);
    std::filesystem::copy(path("notes"), notes);
    std::filesystem::remove(path("out/report.html"));
    std::filesystem::create_directory(path("out/report.html"));
    const auto written = std::filesystem::last_write_time(path("out/recording/can.log"));
    expect_refused_for("report.html");
    EXPECT_EQ(content(path("out/recording/can.log")), log);
    EXPECT_EQ(std::filesystem::last_write_time(path("out/recording/can.log")), written);
    std::filesystem::remove(path("out/report.html"));
    std::filesystem::remove_all(path("out/recording"));
    record_short("out/recording", "--seed 5");
    expect_refused_for("recording/can.log");
}

}  // namespace
}  // namespace octoskin
