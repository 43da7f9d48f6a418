// What a recording is judged in: the world it was made in, found again, or none.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class SceneOfARecording : public ProgramTest {
  protected:
    /// The experiment's world with the crate moved, in a folder with its meshes.
    void make_kitchen() const {
        std::filesystem::copy(source("hw/worlds"), path("worlds"), std::filesystem::copy_options::recursive);
        std::string world = content(path("worlds/experiment.sdf"));
        const std::string place = "0.67 0.34 0.14 0 0 0";  // of the crate
        ASSERT_NE(world.find(place), std::string::npos);
        world.replace(world.find(place), place.size(), "0.87 0.34 0.14 0 0 0");
        write(path("worlds/kitchen.sdf"), world);
    }
    [[nodiscard]] std::string kitchen() const { return path("worlds/kitchen.sdf"); }
    /// As a recording of before, or of a world that cannot be put into one.
    void take_scene_out(const std::string& recording) const {
        ASSERT_EQ(run("sed -i '/^scene_crc32/d' " + path(recording) + "/meta.yaml && rm " + path(recording) +
                      "/scenario.yaml " + path(recording) + "/world.sdf")
                      .exit_code,
                  0);
    }
};

/// The figures alone: every line of the table.
std::string table_of(const Said& said) {
    return said.output.substr(said.output.find("Voxels against"));
}

TEST_F(SceneOfARecording, has_the_meshes_that_were_found_in_folders_of_models) {
    make_kitchen();
    std::filesystem::create_directories(path("models/kitchen"));
    std::filesystem::rename(path("worlds/meshes"), path("models/kitchen/meshes"));
    ASSERT_EQ(run("sed -i 's#<uri>meshes/#<uri>model://kitchen/meshes/#; s#<model name=.cone.>#&<mimic/>#' " +
                  kitchen())
                  .exit_code,
              0);
    const std::string simulate = "simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                                 " --scenario " + source("tests/data/short/scenario.yaml") + " --world " +
                                 kitchen();
    const Failure nowhere = failure_of(simulate);
    EXPECT_THAT(nowhere, fails_with(65, path_is(kitchen())));
    EXPECT_THAT(nowhere.error.message(),
                AllOf(HasSubstr("model://kitchen/meshes/"), HasSubstr("--model-path")));
    const Said made = octoskin(simulate + " --model-path " + path("worlds") + ":" + path("models"));
    ASSERT_EQ(made.exit_code, 0) << made.output;
    EXPECT_THAT(made.output,
                AllOf(HasSubstr("warning " + kitchen() + ": line "), HasSubstr("<mimic> in <model>"),
                      Not(HasSubstr("does not contain its world"))));
    const std::string world = content(path("rec/world.sdf"));
    EXPECT_THAT(world, AllOf(HasSubstr("mesh_01.obj"), Not(HasSubstr("model://"))));
    const Said judged = octoskin("evaluate " + path("rec"));
    EXPECT_EQ(judged.exit_code, 0) << judged.output;
    EXPECT_THAT(judged.output, HasSubstr("<mimic> in <model>"));
}

TEST_F(SceneOfARecording, has_the_models_that_its_world_includes) {
    make_kitchen();
    std::filesystem::create_directories(path("models/crate_2"));
    write(path("models/crate_2/model.config"),
          "<model><name>crate_2</name><sdf version='1.6'>model.sdf</sdf></model>");
    write(path("models/crate_2/model.sdf"),
          "<sdf version='1.6'><model name='crate_2'><static>true</static><link name='l'><visual "
          "name='v'><geometry>"
          "<box><size>0.2 0.2 0.2</size></box></geometry></visual></link></model></sdf>");
    std::string world = content(kitchen());
    world.insert(world.find("</world>"),
                 "<include><uri>model://crate_2</uri><pose>-0.6 0.3 0.1 0 0 0.3</pose></include>");
    write(kitchen(), world);
    const Said made = octoskin("simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                               " --scenario " + source("tests/data/short/scenario.yaml") + " --world " +
                               kitchen() + " --model-path " + path("models"));
    ASSERT_EQ(made.exit_code, 0) << made.output;
    EXPECT_THAT(made.output, Not(HasSubstr("does not contain its world")));
    std::filesystem::remove_all(path("models"));
    std::filesystem::remove_all(path("worlds"));
    const Said judged = octoskin("evaluate " + path("rec"));
    EXPECT_EQ(judged.exit_code, 0) << judged.output;
    EXPECT_THAT(judged.output, HasSubstr("judging in " + path("rec") + "/world.sdf"));
}

TEST_F(SceneOfARecording, is_the_one_it_was_made_in_or_evaluate_refuses) {
    make_kitchen();
    record_short("rec", "--world " + kitchen());
    const std::string meta = content(path("rec/meta.yaml"));
    EXPECT_THAT(meta,
                AllOf(HasSubstr("world: " + kitchen()), HasSubstr("world_crc32: 0x"),
                      HasSubstr("scenario_crc32: 0x"), HasSubstr("rig_crc32: 0x"), HasSubstr("commit ")));
    take_scene_out("rec");
    const std::string evaluate =
        "evaluate " + path("rec") + " --scenario " + source("tests/data/short/scenario.yaml");
    const auto is_absent =
        fails_with(66, code_is(ErrorCode::not_found), path_is(path("rec")), key_is("world"),
                   what_is(HasSubstr(kitchen())), remedy_is(HasSubstr("give --world " + kitchen())));
    EXPECT_THAT(failure_of(evaluate), is_absent)
        << "a recording does not choose what is opened outside of it";
    const Said own = octoskin(evaluate + " --world " + kitchen() + " --json " + path("figures.json"));
    ASSERT_EQ(own.exit_code, 0) << own.output;
    EXPECT_THAT(own.output, AllOf(HasSubstr("judging in " + kitchen()), Not(HasSubstr("recorded in"))));
    const Said to_output =
        run(typed(evaluate) + " --world " + kitchen() + " --json /dev/stdout > " + path("both"));
    EXPECT_EQ(to_output.exit_code, 0) << to_output.output;
    EXPECT_THAT(content(path("both")),
                AllOf(HasSubstr("Voxels against"), HasSubstr("kitchen.sdf, CRC-32 0x")));
    EXPECT_THAT(content(path("figures.json")),
                AllOf(HasSubstr("kitchen.sdf, CRC-32 0x"), HasSubstr("commit ")));

    const Said other = octoskin(evaluate + " --world " + source("hw/worlds/experiment.sdf"));
    ASSERT_EQ(other.exit_code, 0) << other.output;
    EXPECT_THAT(other.output,
                AllOf(HasSubstr("recorded in kitchen.sdf"), HasSubstr("judging in experiment.sdf")));
    EXPECT_NE(table_of(own), table_of(other));

    std::filesystem::rename(kitchen(), path("worlds/moved.sdf"));
    EXPECT_THAT(failure_of(evaluate), is_absent);
    const Said moved = octoskin(evaluate + " --world " + path("worlds/moved.sdf"));
    ASSERT_EQ(moved.exit_code, 0) << moved.output;
    EXPECT_THAT(moved.output, Not(HasSubstr("recorded in kitchen.sdf")));
    EXPECT_EQ(table_of(moved), table_of(own));

    write(kitchen(), content(path("worlds/moved.sdf")) + "<!-- edited -->\n");
    std::filesystem::copy(path("worlds/meshes"), path("rec/meshes"));
    std::filesystem::copy(path("worlds/moved.sdf"), path("rec/kitchen.sdf"));
    const Said within = octoskin(evaluate);
    ASSERT_EQ(within.exit_code, 0) << within.output;
    EXPECT_EQ(table_of(within), table_of(own));
    std::filesystem::remove_all(path("rec/meshes"));
    std::filesystem::create_directory_symlink(path("worlds/meshes"), path("rec/meshes"));
    const Failure linked = failure_of(evaluate);
    EXPECT_THAT(linked, fails_with(65, path_is(path("rec/kitchen.sdf"))));
    EXPECT_THAT(linked.error.message(), HasSubstr("is a symbolic link"));
    write(path("rec/kitchen.sdf"), content(kitchen()));
    EXPECT_THAT(failure_of(evaluate), fails_with(65, code_is(ErrorCode::mismatch), path_is(path("rec")),
                                                 what_is(HasSubstr("kitchen.sdf (CRC-32 0x")),
                                                 value_is(HasSubstr(path("rec/kitchen.sdf") + " (CRC-32 0x")),
                                                 remedy_is(HasSubstr("give --world"))));
    std::filesystem::remove(path("rec/kitchen.sdf"));
    std::filesystem::create_symlink(kitchen(), path("rec/kitchen.sdf"));
    EXPECT_THAT(failure_of(evaluate),
                fails_with(65, code_is(ErrorCode::link), path_is(path("rec/kitchen.sdf"))));
}

TEST_F(SceneOfARecording, has_the_scenario_too_with_what_that_extends) {
    write(path("base.yaml"), "extends: " + source("tests/data/short/scenario.yaml") + "\n");
    write(path("mine.yaml"), "extends: base.yaml\nname: mine\n");
    const Said made = octoskin("simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                               " --scenario " + path("mine.yaml"));
    ASSERT_EQ(made.exit_code, 0) << made.output;
    take_scene_out("rec");
    write(path("base.yaml"), content(path("base.yaml")) + "depth: {sigma_m: 0.01}\n");
    EXPECT_THAT(failure_of("evaluate " + path("rec")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("rec")), key_is("scenario"),
                           what_is(HasSubstr(path("mine.yaml"))), remedy_is(HasSubstr("give --scenario"))));
    const Said changed = octoskin("evaluate " + path("rec") + " --scenario " + path("mine.yaml"));
    EXPECT_EQ(changed.exit_code, 0) << changed.output;
    EXPECT_THAT(changed.output, HasSubstr("recorded in mine.yaml (CRC-32 0x"));
    std::filesystem::copy(path("mine.yaml"), path("rec/mine.yaml"));
    std::filesystem::create_symlink(path("base.yaml"), path("rec/base.yaml"));
    const Said within = octoskin("evaluate " + path("rec"));
    EXPECT_EQ(within.exit_code, 65) << "its scenario extends what is behind a link\n" << within.output;
}

/// A scenario and a world of one's own, with a mesh and what that names: the recording has all of it.
TEST_F(SceneOfARecording, made_with_ones_own_scenario_and_world_is_in_it) {
    make_kitchen();
    write(path("base.yaml"), "extends: " + source("tests/data/short/scenario.yaml") + "\n");
    write(path("mine.yaml"), "extends: base.yaml\nname: mine\nworld: worlds/kitchen.sdf\n");
    record_short("given", "--world " + kitchen());
    const Said given = octoskin("evaluate " + path("given") + " --world " + kitchen());
    ASSERT_EQ(given.exit_code, 0) << given.output;
    const Said made = octoskin("simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                               " --scenario " + path("mine.yaml"));
    ASSERT_EQ(made.exit_code, 0) << made.output;
    EXPECT_THAT(made.output, Not(HasSubstr("does not contain its world")));
    EXPECT_EQ(run("ls -A " + path("rec")).output,
              "can.log\ndepth.epoch.yaml\ndepth.oni\nmesh_01.obj\nmeta.yaml\nrig.yaml\nrobot.urdf\n"
              "scenario.yaml\nworld.sdf\n");
    EXPECT_EQ(content(path("rec/mesh_01.obj")), content(path("worlds/meshes/cone.obj")));
    // Somewhere else, without anything that it was made of.
    std::filesystem::create_directory(path("elsewhere"));
    std::filesystem::rename(path("rec"), path("elsewhere/rec"));
    std::filesystem::remove_all(path("worlds"));
    for (const char* gone : {"base.yaml", "mine.yaml"}) std::filesystem::remove(path(gone));
    const std::string rec = path("elsewhere/rec");
    const Said own = octoskin("evaluate " + rec);
    ASSERT_EQ(own.exit_code, 0) << own.output;
    EXPECT_THAT(own.output, HasSubstr("judging in " + rec + "/world.sdf, " + rec + "/scenario.yaml"));
    EXPECT_EQ(table_of(own), table_of(given));
    // What is given goes first, and is said to be another.
    const Said other = octoskin("evaluate " + rec + " --world " + source("hw/worlds/experiment.sdf"));
    EXPECT_EQ(other.exit_code, 0) << other.output;
    EXPECT_THAT(other.output, HasSubstr("recorded in kitchen.sdf"));
    EXPECT_NE(table_of(other), table_of(own));
    for (const char* name : {"world.sdf", "scenario.yaml", "mesh_01.obj"}) {
        const std::string file = rec + "/" + name;
        const std::string whole = content(file);
        write(file, whole + "\n");
        EXPECT_THAT(
            failure_of("evaluate " + rec),
            fails_with(65, code_is(ErrorCode::mismatch), path_is(rec),
                       what_is(HasSubstr("`octoskin-lab simulate`")), value_is(HasSubstr("CRC-32 0x")),
                       remedy_is(HasSubstr("give --scenario and --world"))))
            << name;
        std::filesystem::remove(file);
        std::filesystem::create_symlink("/etc/passwd", file);
        EXPECT_EQ(octoskin("evaluate " + rec).exit_code, 66) << name;
        std::filesystem::remove(file);
        write(file, whole);
    }
    EXPECT_EQ(octoskin("evaluate " + rec).exit_code, 0);
    const std::string sdf = content(rec + "/world.sdf");
    std::filesystem::resize_file(rec + "/world.sdf", std::uintmax_t{1} << 40U);
    EXPECT_EQ(run("timeout 20 " OCTOSKIN_LAB_PROGRAM " evaluate " + rec).exit_code, 65)
        << "without reading all of it";
    write(rec + "/world.sdf", sdf);
    // A map of it, beside it and elsewhere.
    ASSERT_EQ(octoskin("replay " + rec).exit_code, 0);
    const std::string rig = " --rig " + rec + "/rig.yaml";
    EXPECT_EQ(octoskin("evaluate " + rec + "/maps/fused.ot" + rig).exit_code, 0);
    std::filesystem::copy(rec + "/maps", path("maps"));
    const Failure alone = failure_of("evaluate " + path("maps/fused.ot") + rig);
    EXPECT_THAT(alone, fails_with(64, code_is(ErrorCode::bad_argument), path_is(path("maps/fused.ot")),
                                  key_is("--scenario"), remedy_is(HasSubstr("--recording"))));
    EXPECT_THAT(alone.output, HasSubstr("give --recording " + rec));  // a warning
    EXPECT_EQ(octoskin("evaluate " + path("maps/fused.ot") + rig + " --recording " + rec).exit_code, 0);
    // Of another world nothing of this one stays.
    const Said forced =
        octoskin("simulate " + rec + " --force --rig " + source("tests/data/gantry/rig.yaml") +
                 " --scenario " + source("tests/data/gantry/scenario.yaml"));
    ASSERT_EQ(forced.exit_code, 0) << forced.output;
    EXPECT_FALSE(std::filesystem::exists(rec + "/depth.oni"));
    EXPECT_EQ(std::filesystem::exists(rec + "/mesh_01.obj"),
              content(rec + "/world.sdf").find("mesh_01.obj") != std::string::npos);
}

TEST_F(SceneOfARecording, whose_world_is_missing_says_so_and_a_shipped_one_is_known_by_its_checksum) {
    write(path("mine.yaml"), "extends: " + source("tests/data/short/scenario.yaml") + "\nname: mine\n");
    const Said made = octoskin("simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                               " --scenario " + path("mine.yaml"));
    ASSERT_EQ(made.exit_code, 0) << made.output;
    // As a person puts it there: the scenario's text, its world nowhere beside it.
    std::string alone = content(path("rec/scenario.yaml"));
    take_scene_out("rec");
    alone.replace(alone.find("world.sdf"), 9, "nowhere.sdf");
    write(path("rec/mine.yaml"), alone);
    ASSERT_EQ(run("sed -i '/^scenario_crc32/d' " + path("rec/meta.yaml")).exit_code, 0);
    const Said shipped = octoskin("evaluate " + path("rec"));
    EXPECT_EQ(shipped.exit_code, 0) << shipped.output;
    EXPECT_THAT(shipped.output, HasSubstr("judging in " + source("hw/worlds/experiment.sdf")));
    ASSERT_EQ(run("sed -i 's/^world_crc32.*/world_crc32: 0x00000001/; s/^scenario:/scenario_crc32: "
                  "0x00000002\\nscenario:/' " +
                  path("rec/meta.yaml"))
                  .exit_code,
              0);
    write(path("rec/mine.yaml"), "extends: none.yaml\n");
    const Failure unusable = failure_of("evaluate " + path("rec"));
    EXPECT_THAT(unusable, fails_with(65, code_is(ErrorCode::mismatch), path_is(path("rec")),
                                     value_is(AllOf(HasSubstr(path("rec/mine.yaml") + ":1: extends: "),
                                                    HasSubstr("none.yaml")))));
    EXPECT_THAT(unusable.output, Not(HasSubstr("0x00000000")));
}

TEST_F(SceneOfARecording, of_a_robot_has_to_be_given) {
    record_short("rec");
    write(path("rec/meta.yaml"), "schema: octoskin-recording/1\nsource: robot\n");
    EXPECT_THAT(failure_of("evaluate " + path("rec")),
                fails_with(64, code_is(ErrorCode::missing_key), path_is(path("rec/meta.yaml")),
                           key_is("scenario"), remedy_is(HasSubstr("give --scenario"))));
}

TEST_F(SceneOfARecording, that_names_no_world_is_not_guessed) {
    record_short("rec");
    ASSERT_EQ(run("sed -i '/^world/d' " + path("rec/meta.yaml")).exit_code, 0);
    const std::string scenario = " --scenario " + source("tests/data/short/scenario.yaml");
    EXPECT_THAT(failure_of("evaluate " + path("rec") + scenario),
                fails_with(64, code_is(ErrorCode::missing_key), path_is(path("rec/meta.yaml")),
                           key_is("world"), remedy_is(HasSubstr("give --world"))));
    write(path("rec/meta.yaml"), "schema: octoskin-recording/1\nsource: robot\n");
    const Said robot = octoskin("evaluate " + path("rec") + scenario);
    EXPECT_EQ(robot.exit_code, 0) << robot.output;
    EXPECT_THAT(robot.output, AllOf(HasSubstr("rec/meta.yaml names no world"), HasSubstr("--world")));
    const Said given =
        octoskin("evaluate " + path("rec") + scenario + " --world " + source("hw/worlds/experiment.sdf"));
    EXPECT_EQ(given.exit_code, 0) << given.output;
    EXPECT_THAT(given.output, Not(HasSubstr("names no world")));
}

TEST_F(SceneOfARecording, whose_meta_cannot_be_read_is_named_when_a_map_beside_it_is_judged) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    write(path("rec/meta.yaml"), "schema: octoskin-recording/1\nsource: simulation\nseed: some\n");
    const Said said = octoskin("evaluate " + path("rec/maps/fused.ot") + " --rig " + path("rec/rig.yaml"));
    EXPECT_NE(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, AllOf(HasSubstr("rec/meta.yaml:3: seed: "), HasSubstr("repair that file")));
}

TEST_F(SceneOfARecording, without_a_checksum_goes_by_its_name) {
    record_short("rec");
    write(path("rec/meta.yaml"),
          "schema: octoskin-recording/1\nsource: simulation\nworld: kitchen.sdf\n"
          "scenario: experiment.scenario.yaml\n");
    EXPECT_THAT(failure_of("evaluate " + path("rec")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("rec")), key_is("world"),
                           what_is(HasSubstr("kitchen.sdf")), remedy_is(HasSubstr("give --world"))));
}

TEST_F(SceneOfARecording, serves_the_maps_beside_it) {
    record_short("rec", "--seed 1");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string map = path("rec/maps/fused.ot");
    const std::string scenario = " --scenario " + source("tests/data/short/scenario.yaml");
    EXPECT_THAT(failure_of("evaluate " + map),
                fails_with(64, code_is(ErrorCode::bad_argument), key_is("--rig"),
                           remedy_is(HasSubstr("give --rig " + path("rec/rig.yaml")))));
    const Said own = octoskin("evaluate " + map + scenario + " --rig " + path("rec/rig.yaml"));
    ASSERT_EQ(own.exit_code, 0) << own.output;
    EXPECT_THAT(own.output, Not(HasSubstr("is another rig")));
    const Said other =
        octoskin("evaluate " + map + scenario + " --rig " + source("tests/data/short/rig.yaml"));
    EXPECT_EQ(other.exit_code, 0) << other.output;
    EXPECT_THAT(other.output, AllOf(HasSubstr("is another rig than " + path("rec/rig.yaml")),
                                    HasSubstr("figures are wrong")));
    EXPECT_NE(table_of(other), table_of(own));

    std::filesystem::copy(path("rec/maps"), path("copies"));
    const Said copy =
        octoskin("evaluate " + path("copies/fused.ot") + scenario + " --rig " + path("rec/rig.yaml"));
    EXPECT_EQ(copy.exit_code, 0) << copy.output;
    // maps.yaml says where the recording is, and does not choose what is opened.
    EXPECT_THAT(copy.output, HasSubstr("give --recording " + path("rec")));
    EXPECT_EQ(table_of(copy), table_of(own));

    std::filesystem::copy(map, path("alone.ot"));
    EXPECT_THAT(failure_of("evaluate " + path("alone.ot") + " --rig " + path("rec/rig.yaml")),
                fails_with(64, code_is(ErrorCode::bad_argument), path_is(path("alone.ot")),
                           key_is("--scenario"), remedy_is(HasSubstr("give --scenario"))));
}

TEST_F(SceneOfARecording, and_its_maps_know_each_other) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec") + " --configuration paper").exit_code, 0);
    const std::string origin = content(path("rec/maps/maps.yaml"));
    EXPECT_THAT(origin, AllOf(HasSubstr("schema: octoskin-maps/1"), HasSubstr("recording: " + path("rec")),
                              HasSubstr("configuration: paper"), HasSubstr("depth_update: paper"),
                              HasSubstr("rig_hash: 0x"), HasSubstr("fused.ot: 0x"), HasSubstr("commit ")));
    const std::string fused = content(path("rec/maps/fused.ot"));
    write(path("rec/maps/fused.ot"), content(path("rec/maps/depth.ot")));
    const std::string rig = " --rig " + path("rec/rig.yaml");
    EXPECT_THAT(failure_of("evaluate " + path("rec/maps/fused.ot") + rig),
                fails_with(65, code_is(ErrorCode::mismatch), path_is(path("rec/maps/fused.ot")),
                           what_is(HasSubstr("maps.yaml")), value_is(HasSubstr("0x")),
                           remedy_is(HasSubstr("move maps.yaml away"))));
    write(path("rec/maps/fused.ot"), fused);

    write(path("rec/maps/maps.yaml"), origin + "surprise: 1\n");
    const auto lines = std::count(origin.begin(), origin.end(), '\n');
    EXPECT_THAT(failure_of("evaluate " + path("rec/maps/fused.ot") + rig),
                fails_with(65, code_is(ErrorCode::unknown_key), path_is(path("rec/maps/maps.yaml")),
                           line_is(static_cast<int>(lines) + 1), key_is("surprise"),
                           remedy_is(HasSubstr("replay the recording again"))));
    write(path("rec/maps/maps.yaml"), origin);

    write(path("rec/can.log"), content(path("rec/can.log")) + "\n");
    const auto is_of_another = [this](const std::string& map) {
        return fails_with(65, code_is(ErrorCode::mismatch), path_is(map),
                          what_is(HasSubstr("was made from another recording")),
                          value_is(HasSubstr("CRC-32 0x")),
                          remedy_is(HasSubstr("replay " + path("rec") + " again")));
    };
    EXPECT_THAT(failure_of("evaluate " + path("rec/maps/fused.ot") + rig),
                is_of_another(path("rec/maps/fused.ot")));
    // One elsewhere whose recording has changed has none.
    std::filesystem::copy(path("rec/maps"), path("copies"));
    EXPECT_THAT(failure_of("evaluate " + path("copies/fused.ot") + rig),
                fails_with(64, code_is(ErrorCode::bad_argument), path_is(path("copies/fused.ot")),
                           key_is("--scenario"), remedy_is(HasSubstr("--recording"))));
    EXPECT_THAT(failure_of("evaluate " + path("copies/fused.ot") + rig + " --recording " + path("rec")),
                is_of_another(path("copies/fused.ot")));
    // Below the map's folder it may lie.
    ASSERT_EQ(run("sed -i 's#^recording:.*#recording: below#' " + path("copies/maps.yaml")).exit_code, 0);
    std::filesystem::copy(path("rec"), path("copies/below"), std::filesystem::copy_options::recursive);
    const Said changed = octoskin("evaluate " + path("copies/fused.ot") + rig);
    EXPECT_THAT(changed.output, AllOf(HasSubstr("copies/below"), HasSubstr("has changed since")));
}

TEST_F(SceneOfARecording, that_cannot_be_had_is_refused_at_the_line_that_asks_for_it) {
    const auto refusal = [&](const std::string& overlay) {
        write(path("my.scenario.yaml"),
              "extends: " + source("tests/data/short/scenario.yaml") + "\n" + overlay);
        return failure_of("simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                          " --scenario " + path("my.scenario.yaml"));
    };
    EXPECT_THAT(refusal("motion:\n  circle:\n    link: hand_of_nobody\n"),
                fails_with(78, code_is(ErrorCode::unknown_name), path_is(path("my.scenario.yaml")),
                           line_is(4), key_is("motion.circle.link"), value_is("'hand_of_nobody'")));
    EXPECT_THAT(refusal("motion: {circle: {start_position_rad: [0, 0]}}\n"),
                fails_with(78, code_is(ErrorCode::mismatch), path_is(path("my.scenario.yaml")), line_is(2),
                           key_is("motion.circle.start_position_rad"), what_is(HasSubstr("7 joints"))));
    EXPECT_THAT(refusal("motion:\n  circle: {radius_m: 3}\n"),
                fails_with(78, code_is(ErrorCode::out_of_range), key_is("motion.circle"),
                           remedy_is(HasSubstr("move the circle"))));
}

TEST_F(SceneOfARecording, hides_no_model_that_is_not_there) {
    write(path("my.scenario.yaml"),
          "extends: " + source("tests/data/short/scenario.yaml") + "\nhidden_models: [crate, conne]\n");
    for (const std::string& command : {"simulate " + path("rec"), "experiment --out " + path("out")}) {
        EXPECT_THAT(failure_of(command + " --rig " + source("tests/data/short/rig.yaml") + " --scenario " +
                               path("my.scenario.yaml")),
                    fails_with(78, code_is(ErrorCode::unknown_name), path_is(path("my.scenario.yaml")),
                               line_is(2), key_is(HasSubstr("hidden_models")), value_is("'conne'"),
                               remedy_is(HasSubstr("cone, crate"))))
            << command;
    }
    EXPECT_FALSE(std::filesystem::exists(path("rec")));
}

class MovingWorld : public ProgramTest {
  protected:
    /// A recording of 1 s before a wall that a box comes before after half of it, or does not.
    void record(const std::string& name, const std::string& more) const {
        write(path(name + ".yaml"), "extends: " + source("tests/data/short/scenario.yaml") +
                                        "\nname: " + name + "\nworld: " + source("hw/worlds/moving.sdf") +
                                        "\nhidden_models: []\n" + more);
        const Said said =
            octoskin("simulate " + path(name) + " --rig " + source("tests/data/short/rig.yaml") +
                     " --scenario " + path(name + ".yaml"));
        ASSERT_EQ(said.exit_code, 0) << said.output;
    }
};

TEST_F(MovingWorld, is_what_camera_and_sensors_see) {
    record("still", "");
    write(path("no.motion.yaml"), "models: [{model: guest, places: [{at_s: 100, is_there: false}]}]\n");
    record("later", "world_motion: no.motion.yaml\n");
    EXPECT_EQ(content(path("later/can.log")), content(path("still/can.log"))) << "nothing moves yet";
    EXPECT_EQ(content(path("later/depth.oni")), content(path("still/depth.oni")));
    write(path("floor.motion.yaml"), "models: [{model: floor, places: [{at_s: 0.5, is_there: false}]}]\n");
    record("gone", "world_motion: floor.motion.yaml\n");
    EXPECT_NE(content(path("gone/can.log")), content(path("still/can.log")));
    EXPECT_NE(content(path("gone/depth.oni")), content(path("still/depth.oni")));
    ASSERT_EQ(octoskin("replay " + path("gone")).exit_code, 0);
}

TEST_F(MovingWorld, is_not_judged) {
    write(path("floor.motion.yaml"), "models: [{model: floor, places: [{at_s: 0.5, is_there: false}]}]\n");
    record("gone", "world_motion: floor.motion.yaml\n");
    const auto moves = fails_with(78, code_is(ErrorCode::unsupported), path_is(path("gone.yaml")), line_is(5),
                                  key_is("world_motion"), remedy_is(HasSubstr("`octoskin-lab simulate`")));
    EXPECT_THAT(failure_of("evaluate " + path("gone") + " --scenario " + path("gone.yaml")), moves);
    const Failure studied = failure_of("experiment --rig " + source("tests/data/short/rig.yaml") +
                                       " --scenario " + path("gone.yaml") + " --out " + path("study"));
    EXPECT_THAT(studied, moves);
    EXPECT_THAT(studied.output, Not(HasSubstr("ground truth"))) << "before any work";
    EXPECT_FALSE(std::filesystem::exists(path("study")));
}

TEST_F(MovingWorld, is_refused_where_its_motion_is_not_there_or_of_another_world) {
    write(path("mine.yaml"),
          "extends: " + source("tests/data/short/scenario.yaml") + "\nworld_motion: no.yaml\n");
    const std::string simulate = "simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") +
                                 " --scenario " + path("mine.yaml");
    EXPECT_THAT(failure_of(simulate),
                fails_with(78, code_is(ErrorCode::not_found), path_is(path("mine.yaml")), line_is(2),
                           key_is("world_motion"), value_is(HasSubstr(path("no.yaml")))));
    write(path("no.yaml"), "models: [{model: guest, places: [{at_s: 1, is_there: false}]}]\n");
    EXPECT_THAT(failure_of(simulate),
                fails_with(78, code_is(ErrorCode::unknown_name), path_is(path("no.yaml")), line_is(1),
                           key_is("models[0].model"), value_is("'guest'")));
}

}  // namespace
}  // namespace octoskin
