// octoskin query of a map file.
#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/io/mapfile/map_file.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

constexpr const char* kReady = "0,-0.785,0,-2.356,0,1.571,0.785";

class QueryCommandTest : public ProgramTest {
  protected:
    /// Free within 2.56 m of the origin, but for what `change` does with it.
    template <class Change>
    std::string save(const std::string& name, const Change& change) const {
        FusedMap map{MapConfig{.resolution_m = 0.04}};
        constexpr std::array<std::uint16_t, 2> kSides{32704, 32768};
        for (const auto x : kSides)
            for (const auto y : kSides)
                for (const auto z : kSides) EXPECT_TRUE(map.set_cube({{x, y, z}, 6}, -1.0F));
        change(map);
        const auto saved = save_map(map, path(name));
        EXPECT_TRUE(saved) << saved.error().message;
        return path(name);
    }
    [[nodiscard]] std::string free_map() const {
        return save("free.ot", [](FusedMap&) {});
    }
    /// Something stands where the forearm of the ready posture is.
    [[nodiscard]] std::string blocked_map() const {
        return save("blocked.ot", [](FusedMap& whole) {
            EXPECT_TRUE(whole.set_cube({*whole.key_of({0.35, 0.0, 0.62}), 0}, 2.0F));
        });
    }
    static Said query(const std::string& arguments) {
        return octoskin("query " + arguments + " --rig " + source("hw/rigs/experiment.yaml"));
    }
};

TEST_F(QueryCommandTest, of_a_free_posture_ends_with_0) {
    const Said said = query(free_map() + " --joints " + kReady);
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_EQ(said.output, "free\n");
}

TEST_F(QueryCommandTest, whose_answer_cannot_be_written_ends_with_74_whatever_it_is) {
    for (const std::string& map : {free_map(), blocked_map()}) {
        const Said said = run(typed("query " + map + " --joints " + kReady + " --rig " +
                                    source("hw/rigs/experiment.yaml") + " > /dev/full"));
        EXPECT_EQ(said.exit_code, 74) << said.output;
    }
}

TEST_F(QueryCommandTest, of_a_blocked_posture_ends_with_1_and_tells_where) {
    const Said said = query(blocked_map() + " --joints " + kReady + " --json");
    ASSERT_EQ(said.exit_code, 1) << said.output;
    const Json answer = Json::parse(said.output);
    EXPECT_EQ(answer["state"], "occupied");
    EXPECT_THAT(answer["legs"][0]["link"].get<std::string>(), HasSubstr("panda_link"));
    EXPECT_NEAR(answer["legs"][0]["voxel_m"][0].get<double>(), 0.34, 1e-6);
    const Said text = query(blocked_map() + " --joints " + kReady);
    EXPECT_THAT(text.output, testing::StartsWith("occupied: panda_link"));
}

TEST_F(QueryCommandTest, of_an_unknown_posture_ends_with_2) {
    const std::string nothing_known = path("empty.ot");
    ASSERT_TRUE(save_map(FusedMap{MapConfig{}}, nothing_known));
    const Said said = query(nothing_known + " --joints " + kReady);
    EXPECT_EQ(said.exit_code, 2) << said.output;
    EXPECT_THAT(said.output, testing::StartsWith("unknown: panda_link"));
    EXPECT_THAT(said.output, HasSubstr("--own-space M and --stands JOINTS")) << "why, as a rule";
    const Said own = query(nothing_known + " --own-space 0.05 --stands " + kReady);
    EXPECT_THAT(own.output, testing::Not(HasSubstr("--own-space")));
    EXPECT_EQ(own.exit_code, 0) << own.output;
}

TEST_F(QueryCommandTest, of_a_path_asks_about_what_lies_between_its_lines) {
    write(path("path.txt"),
          "# round the obstacle, and through it\n\n-1.2,-0.785,0,-2.356,0,1.571,0.785\n"
          "1.2 -0.785 0 -2.356 0 1.571 0.785\n");
    const std::string map = blocked_map();
    const Said said = query(map + " --path " + path("path.txt"));
    EXPECT_EQ(said.exit_code, 1) << said.output;
    EXPECT_THAT(said.output, HasSubstr("   1  free\n"));
    EXPECT_THAT(said.output, HasSubstr("the path is occupied: 2 configurations"));
    const Said in = run("cat " + path("path.txt") + " | " OCTOSKIN_PROGRAM " query " + map +
                        " --path - --rig " + source("hw/rigs/experiment.yaml"));
    EXPECT_EQ(in.output, said.output);
}

TEST_F(QueryCommandTest, with_padding_meets_what_without_it_passes) {
    const Said without = query(blocked_map() + " --joints 0.35,-0.785,0,-2.356,0,1.571,0.785 --json");
    ASSERT_EQ(without.exit_code, 0) << without.output;
    const double gap_m = Json::parse(without.output)["legs"][0]["occupied_m"].get<double>();
    const auto padded = [&](double padding_m) {
        return query(blocked_map() + " --joints 0.35,-0.785,0,-2.356,0,1.571,0.785 --padding " +
                     std::to_string(padding_m))
            .exit_code;
    };
    EXPECT_EQ(padded(gap_m - 0.001), 0);
    EXPECT_EQ(padded(gap_m + 0.001), 1);
}

TEST_F(QueryCommandTest, takes_a_configuration_that_begins_with_a_minus) {
    const Said said = query(free_map() + " --joints -0.5,-0.785,0,-2.356,0,1.571,0.785");
    EXPECT_EQ(said.exit_code, 0) << said.output;
}

TEST_F(QueryCommandTest, lists_unknown_pockets) {
    const std::string map = save("pocket.ot", [](FusedMap& whole) {
        FusedMap less(whole.config());
        whole.for_each_known([&](VoxelKey key, float log_odds) {
            const Eigen::Vector3d away = whole.centre_of(key) - Eigen::Vector3d(0.8, 0.0, 0.3);
            if (away.cwiseAbs().maxCoeff() <= 0.1) return;
            EXPECT_TRUE(less.set_cube({key, 0}, log_odds));
        });
        whole = std::move(less);
    });
    const Said said = query(map + " --unknown --joints " + kReady + " --json");
    ASSERT_EQ(said.exit_code, 0) << said.output;
    const Json answer = Json::parse(said.output);
    ASSERT_EQ(answer["pockets"].size(), 1U);
    EXPECT_NEAR(answer["pockets"][0]["centre_m"][0].get<double>(), 0.8, 0.02);
    ASSERT_FALSE(answer["pockets"][0]["view"].is_null()) << "thirty-four sensors, and none sees it";
    EXPECT_EQ(answer["pockets"][0]["view"]["joints"].size(), 7U);
}

TEST_F(QueryCommandTest, that_cannot_be_asked_says_why) {
    const std::string map = free_map();
    const auto expect = [&](const std::string& arguments, int exit_code, const std::string& text) {
        const Said said = query(map + arguments);
        EXPECT_EQ(said.exit_code, exit_code) << said.output;
        EXPECT_THAT(said.output, HasSubstr(text));
    };
    write(path("bad.txt"), "0,0,0,0,0,0,0\n0,0,x\n");
    write(path("none.txt"), "# nothing\n");
    expect("", 69, "give the posture to ask about as --joints");
    expect(" --joints 1,2", 64, "2 joint positions; the rig has 7 joints: panda_joint1, panda_joint2");
    for (const char* joints : {"a,b", "0,,0,0,0,0,0", "0,-1,0,-2,0,1,0,", "'0;-1;0;-2;0;1;0'",
                               "0x0,-1,0,-2,0,1,0", "nan,-1,0,-2,0,1,0", "inf,-1,0,-2,0,1,0", "''"}) {
        expect(std::string(" --joints ") + joints, 64, "expected a joint configuration: one number for each");
    }
    expect(" --joints 0,9,0,-2,0,1,0", 64, "panda_joint2 is 9; its limits are");
    expect(" --path " + path("bad.txt"), 65,
           "bad.txt:2: 'x' is not a plain, finite number; expected a joint");
    write(path("few.txt"), std::string("# two\n") + kReady + "\n\n0,0,0\n");
    expect(" --path " + path("few.txt"), 64, "few.txt:4: configuration 2: 3 joint positions; the rig has 7");
    write(path("beyond.txt"), std::string("# one\n0,9,0,-2,0,1,0\n"));
    expect(" --path " + path("beyond.txt"), 64,
           "beyond.txt:2: configuration 1: panda_joint2 is 9; its limits");
    expect(" --path " + path("beyond.txt") + " --path -", 64, "--path");
    expect(" --path ''", 66, "cannot be read: No such file");
    expect(" --path /proc/self/mem", 74, "/proc/self/mem: cannot be read");
    expect(" --path /dev/zero", 65, "/dev/zero: has more than 1048576 bytes, more than any valid path");
    expect(" --path " + directory_.string(), 64, "is a directory, not a file with one configuration a line");
    expect(" --path " + path("none.txt"), 65, "no joint configuration");
    expect(" --path " + path("nowhere.txt"), 66, "nowhere.txt");
    expect(std::string(" --ignore-link hand --joints ") + kReady, 64, "the robot has no link 'hand'");
    const Said no_rig = octoskin("query " + map + " --joints " + kReady);
    EXPECT_EQ(no_rig.exit_code, 64) << no_rig.output;
    EXPECT_THAT(no_rig.output, HasSubstr("give --rig"));
    const Said no_daemon = octoskin("query --socket " + path("nobody"));
    EXPECT_EQ(no_daemon.exit_code, 69) << no_daemon.output;
}

TEST_F(QueryCommandTest, refuses_what_would_not_be_looked_at) {
    const std::string map = free_map();
    const std::string rig = " --rig " + source("hw/rigs/experiment.yaml");
    const std::string joints = std::string(" --joints ") + kReady;
    const auto refused = [&](const std::string& arguments) {
        const Said said = octoskin("query " + arguments);
        EXPECT_EQ(said.exit_code, 64) << arguments << ": " << said.output;
        return said.output;
    };
    EXPECT_THAT(refused(joints + rig + " --socket " + path("nobody")),
                HasSubstr("--rig is for a map file; a daemon has its own: leave it out, or name the map"));
    EXPECT_THAT(refused(joints + " --robot " + source("hw/rigs/experiment.yaml")),
                HasSubstr("--robot is for a"));
    EXPECT_THAT(refused(joints + " --stands " + kReady), HasSubstr("--stands is for a map file"));
    EXPECT_THAT(refused(map + rig + joints + " --socket " + path("nobody")),
                HasSubstr("--socket is where a daemon listens, but a map file is given"));
    for (const char* option : {" --radius 1", " --above 0", " --pockets 1", " --tries 1"})
        EXPECT_THAT(refused(map + rig + joints + option), HasSubstr(" is for --unknown: give that, too"));
    EXPECT_THAT(refused(map + rig + joints + " --unknown --reach 1"),
                HasSubstr("--reach: --unknown gives no"));
    write(path("way.txt"), std::string(kReady) + "\n");
    EXPECT_THAT(refused(map + rig + " --unknown --path " + path("way.txt")),
                HasSubstr("give it as --joints"));
}

TEST_F(QueryCommandTest, takes_no_variable_that_nothing_set_for_an_option_that_was_left_out) {
    const std::string map = free_map();
    const std::string joints = std::string(" --joints ") + kReady;
    const auto expect_refused = [](const std::string& arguments, const std::string& what) {
        const Said said = octoskin("query " + arguments);
        EXPECT_EQ(said.exit_code, 64) << arguments << ": " << said.output;
        EXPECT_THAT(said.output, HasSubstr(what + ": the file name is missing"));
    };
    expect_refused("''" + joints, "map");
    expect_refused(map + " --rig ''" + joints, "--rig");
    expect_refused(map + " --rig " + source("hw/rigs/experiment.yaml") + " --robot ''" + joints, "--robot");
    expect_refused("--socket ''" + joints, "--socket");
}

/// Standard output alone: what a script parses.
Said said_to_script(const std::string& arguments) {
    return run(OCTOSKIN_PROGRAM " query --json " + arguments, "2>/dev/null");
}

TEST_F(QueryCommandTest, tells_an_error_as_json_too) {
    const std::string asked = free_map() + " --rig " + source("hw/rigs/experiment.yaml");
    const std::array<std::pair<std::string, int>, 6> refused{{{asked + " --joints 1,2", 64},
                                                              {asked + " --joints 1,,2", 64},
                                                              {asked + " --path " + path("nowhere"), 66},
                                                              {asked + " --tries 1", 64},
                                                              {path("none.ot"), 66},
                                                              {"--socket " + path("nobody"), 69}}};
    for (const auto& [arguments, exit_code] : refused) {
        const Said said = said_to_script(arguments);
        EXPECT_EQ(said.exit_code, exit_code) << said.output;
        const Json answer = Json::parse(said.output, nullptr, false);
        ASSERT_TRUE(answer.is_object()) << arguments << ": " << said.output;
        EXPECT_EQ(answer.value("ok", true), false);
        EXPECT_NE(answer.value("error", ""), "");
        EXPECT_EQ(answer.value("code", 0), exit_code);
    }
}

TEST_F(QueryCommandTest, tells_a_script_which_configuration_is_refused) {
    write(path("beyond.txt"), std::string(kReady) + "\n0,9,0,-2,0,1,0\n");
    const Said said = said_to_script(free_map() + " --rig " + source("hw/rigs/experiment.yaml") + " --path " +
                                     path("beyond.txt"));
    EXPECT_EQ(said.exit_code, 64);
    EXPECT_EQ(Json::parse(said.output).at("configuration"), 2) << said.output;
}

TEST_F(QueryCommandTest, takes_for_own_space_where_the_arm_is_said_to_stand) {
    const std::string unknown = path("empty.ot");
    ASSERT_TRUE(save_map(FusedMap{MapConfig{}}, unknown));
    const std::string aside = " --joints 1.5,-0.785,0,-2.356,0,1.571,0.785 --own-space 0.05";
    const Said itself = query(unknown + aside);
    EXPECT_EQ(itself.exit_code, 64) << "it would be free whatever the map says";
    EXPECT_THAT(itself.output, HasSubstr("--own-space of a map file needs --stands"));
    write(path("one.txt"), std::string(kReady) + "\n");
    EXPECT_EQ(query(unknown + " --own-space 0.05 --path " + path("one.txt")).exit_code, 64);
    write(path("two.txt"), std::string(kReady) + "\n" + kReady + "\n");
    const Said way = query(unknown + " --json --own-space 0.05 --path " + path("two.txt"));
    EXPECT_EQ(way.exit_code, 0) << "a way begins where the arm stands: " << way.output;
    EXPECT_EQ(Json::parse(way.output).at("own_space_m"), 0.05);
    EXPECT_EQ(query(unknown + aside + " --stands " + kReady).exit_code, 2) << "there it does not stand";
    EXPECT_EQ(query(unknown + " --own-space 0.05 --stands " + kReady).exit_code, 0) << "as it stands";
    const Said few = query(unknown + aside + " --stands 0,1");
    EXPECT_EQ(few.exit_code, 64);
    EXPECT_THAT(few.output, HasSubstr("the present posture: 2 joint positions; the rig has 7 joints"));
    EXPECT_THAT(query(unknown + aside + " --stands 1,,2").output,
                HasSubstr("--stands '1,,2': a number is missing"));
}

TEST_F(QueryCommandTest, warns_if_the_map_was_made_with_another_rig) {
    record_short("run");
    const Said replayed = octoskin("replay " + path("run") + " --out " + path("maps"));
    ASSERT_EQ(replayed.exit_code, 0) << replayed.output;
    const std::string asked = "query " + path("maps/fused.ot") + " --joints " + kReady + " --rig ";
    const Said same = octoskin(asked + path("run/rig.yaml"));
    EXPECT_THAT(same.output, testing::Not(HasSubstr("another rig"))) << same.output;
    const Said other = octoskin(asked + source("hw/rigs/experiment.yaml"));
    EXPECT_EQ(other.exit_code, same.exit_code);
    EXPECT_THAT(other.output, HasSubstr("experiment.yaml is another rig than " + path("run/rig.yaml")));
    write(path("maps/fused.ot"), content(path("maps/proximity.ot")));
    EXPECT_THAT(octoskin(asked + path("run/rig.yaml")).output, HasSubstr("so it is not known whether"));
}

TEST_F(QueryCommandTest, help_says_what_each_option_takes) {
    const Said said = octoskin("query --help");
    for (const char* line : {"--ignore-link LINK  ", "--joints JOINTS ", "--path FILE ", "--rig FILE ",
                             "--stands JOINTS ", "--socket FILE="})
        EXPECT_THAT(said.output, HasSubstr(line));
    EXPECT_THAT(said.output, testing::Not(HasSubstr("TEXT")));
    EXPECT_THAT(said.output, testing::Not(HasSubstr(" ...  ")));
    const Said twice =
        query(free_map() + " --ignore-link panda_link6 --joints " + kReady + " --ignore-link panda_link7");
    EXPECT_EQ(twice.exit_code, 0) << twice.output;
}

}  // namespace
}  // namespace octoskin
