// octoskin query of a map file.
#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/io/mapfile/map_file.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::code_is;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;
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
        EXPECT_TRUE(saved) << saved.error().message();
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
    EXPECT_THAT(said.output, testing::StartsWith("free\n"));
}

TEST_F(QueryCommandTest, with_a_minimum_of_evidence_ends_with_2_where_there_is_less) {
    const std::string posture = free_map() + " --joints " + kReady + " --json";  // log-odds -1: 2.5 images
    const Said enough = query(posture + " --min-evidence 2.5");
    ASSERT_EQ(enough.exit_code, 0) << enough.output;
    const Json free = Json::parse(enough.output)["legs"][0]["free_evidence"];
    EXPECT_EQ(free["images"], 2.5);
    EXPECT_EQ(free["beams"], 0.0);
    EXPECT_THAT(free["link"].get<std::string>(), HasSubstr("panda_link"));
    const Said less = query(posture + " --min-evidence 3");
    EXPECT_EQ(less.exit_code, 2) << less.output;
    EXPECT_EQ(Json::parse(less.output)["state"], "unknown");
    EXPECT_EQ(Json::parse(less.output)["min_evidence"], 3.0);
    EXPECT_EQ(query(posture + " --min-evidence -1").exit_code, 64);
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
    const std::string rig = " --rig " + source("hw/rigs/experiment.yaml");
    const auto failure = [&](const std::string& arguments) {
        return failure_of("query " + map + arguments + rig);
    };
    write(path("bad.txt"), "0,0,0,0,0,0,0\n0,0,x\n");
    write(path("none.txt"), "# nothing\n");
    EXPECT_THAT(failure(""), fails_with(69, code_is(ErrorCode::no_data), remedy_is(HasSubstr("--joints"))));
    EXPECT_THAT(
        failure(" --joints 1,2"),
        fails_with(64, code_is(ErrorCode::mismatch), key_is("configuration 1"), value_is("2 positions"),
                   what_is(HasSubstr("7 joints: panda_joint1, panda_joint2"))));
    for (const std::string joints : {"a,b", "0,,0,0,0,0,0", "0,-1,0,-2,0,1,0,", "0;-1;0;-2;0;1;0",
                                     "0x0,-1,0,-2,0,1,0", "nan,-1,0,-2,0,1,0", "inf,-1,0,-2,0,1,0", ""}) {
        EXPECT_THAT(failure(" --joints '" + joints + "'"),
                    fails_with(64, code_is(ErrorCode::bad_syntax), key_is("--joints '" + joints + "'")));
    }
    EXPECT_THAT(failure(" --joints 0,9,0,-2,0,1,0"),
                fails_with(64, code_is(ErrorCode::out_of_range), key_is(HasSubstr("panda_joint2")),
                           value_is("9"), what_is(HasSubstr("limits"))));
    EXPECT_THAT(failure(" --path " + path("bad.txt")),
                fails_with(65, code_is(ErrorCode::bad_syntax), path_is(path("bad.txt")), line_is(2),
                           value_is("'x'")));
    write(path("few.txt"), std::string("# two\n") + kReady + "\n\n0,0,0\n");
    EXPECT_THAT(
        failure(" --path " + path("few.txt")),
        fails_with(64, code_is(ErrorCode::mismatch), path_is(path("few.txt")), line_is(4),
                   key_is("configuration 2"), value_is("3 positions"), what_is(HasSubstr("7 joints"))));
    write(path("beyond.txt"), std::string("# one\n0,9,0,-2,0,1,0\n"));
    EXPECT_THAT(
        failure(" --path " + path("beyond.txt")),
        fails_with(64, code_is(ErrorCode::out_of_range), path_is(path("beyond.txt")), line_is(2),
                   key_is("configuration 1: panda_joint2"), value_is("9"), what_is(HasSubstr("limits"))));
    EXPECT_THAT(failure(" --path " + path("beyond.txt") + " --path -"),
                fails_with(64, code_is(ErrorCode::bad_argument), key_is("--path")));
    EXPECT_THAT(failure(" --path ''"), fails_with(66, code_is(ErrorCode::not_found)));
    EXPECT_THAT(failure(" --path /proc/self/mem"),
                fails_with(74, code_is(ErrorCode::system_error), path_is("/proc/self/mem")));
    EXPECT_THAT(
        failure(" --path /dev/zero"),
        fails_with(65, code_is(ErrorCode::too_large), path_is("/dev/zero"), what_is(HasSubstr("1048576"))));
    EXPECT_THAT(failure(" --path " + directory_.string()),
                fails_with(64, code_is(ErrorCode::wrong_kind_of_file), path_is(directory_.string())));
    EXPECT_THAT(failure(" --path " + path("none.txt")),
                fails_with(65, code_is(ErrorCode::no_content), path_is(path("none.txt"))));
    EXPECT_THAT(failure(" --path " + path("nowhere.txt")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("nowhere.txt"))));
    EXPECT_THAT(
        failure(std::string(" --ignore-link hand --joints ") + kReady),
        fails_with(64, code_is(ErrorCode::unknown_name), key_is("links_ignored"), value_is("'hand'")));
    EXPECT_THAT(
        failure_of("query " + map + " --joints " + kReady),
        fails_with(64, code_is(ErrorCode::bad_argument), key_is("--rig"), remedy_is(HasSubstr("rig"))));
    EXPECT_THAT(failure_of("query --socket " + path("nobody")), fails_with(69, path_is(path("nobody"))));
}

TEST_F(QueryCommandTest, refuses_what_would_not_be_looked_at) {
    const std::string map = free_map();
    const std::string rig = " --rig " + source("hw/rigs/experiment.yaml");
    const std::string joints = std::string(" --joints ") + kReady;
    const auto expect_refused = [](const std::string& arguments, const std::string& option,
                                   const std::string& remedy) {
        EXPECT_THAT(
            failure_of("query " + arguments),
            fails_with(64, code_is(ErrorCode::conflict), key_is(option), remedy_is(HasSubstr(remedy))))
            << arguments;
    };
    expect_refused(joints + rig + " --socket " + path("nobody"), "--rig", "leave it out, or name the map");
    expect_refused(joints + " --robot " + source("hw/rigs/experiment.yaml"), "--robot", "name the map");
    expect_refused(joints + " --stands " + kReady, "--stands", "name the map");
    expect_refused(map + rig + joints + " --socket " + path("nobody"), "--socket", "leave out");
    for (const std::string option : {"--radius", "--above", "--pockets", "--tries"})
        expect_refused(map + rig + joints + " " + option + " 1", option, "give --unknown");
    expect_refused(map + rig + joints + " --unknown --reach 1", "--reach", "leave it out");
    write(path("way.txt"), std::string(kReady) + "\n");
    expect_refused(map + rig + " --unknown --path " + path("way.txt"), "--path", "give it as --joints");
}

TEST_F(QueryCommandTest, takes_no_variable_that_nothing_set_for_an_option_that_was_left_out) {
    const std::string map = free_map();
    const std::string joints = std::string(" --joints ") + kReady;
    const auto expect_refused = [](const std::string& arguments, const std::string& option) {
        EXPECT_THAT(failure_of("query " + arguments),
                    fails_with(64, code_is(ErrorCode::bad_argument), key_is(option),
                               what_is(HasSubstr("the file name is missing"))))
            << arguments;
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
        EXPECT_EQ(answer.value("exit", 0), exit_code);
        // The same error as on standard error.
        ASSERT_TRUE(answer.contains("error")) << said.output;
        const Failure failure = failure_of("query " + arguments);
        EXPECT_THAT(failure, fails_with(exit_code));
        EXPECT_EQ(Json(answer.at("error")), Json(to_json(failure.error)));
    }
}

TEST_F(QueryCommandTest, tells_a_script_which_configuration_is_refused) {
    write(path("beyond.txt"), std::string(kReady) + "\n0,9,0,-2,0,1,0\n");
    const Said said = said_to_script(free_map() + " --rig " + source("hw/rigs/experiment.yaml") + " --path " +
                                     path("beyond.txt"));
    EXPECT_EQ(said.exit_code, 64);
    const Json answer = Json::parse(said.output);
    EXPECT_EQ(answer.at("configuration"), 2) << said.output;
    EXPECT_EQ(answer.at("error").at("line"), 2) << said.output;
}

TEST_F(QueryCommandTest, takes_for_own_space_where_the_arm_is_said_to_stand) {
    const std::string unknown = path("empty.ot");
    ASSERT_TRUE(save_map(FusedMap{MapConfig{}}, unknown));
    const std::string aside = " --joints 1.5,-0.785,0,-2.356,0,1.571,0.785 --own-space 0.05";
    const auto failure = [](const std::string& arguments) {
        return failure_of("query " + arguments + " --rig " + source("hw/rigs/experiment.yaml"));
    };
    EXPECT_THAT(failure(unknown + aside), fails_with(64, code_is(ErrorCode::bad_argument),
                                                     key_is("--own-space"), remedy_is(HasSubstr("--stands"))))
        << "it would be free whatever the map says";
    write(path("one.txt"), std::string(kReady) + "\n");
    EXPECT_EQ(query(unknown + " --own-space 0.05 --path " + path("one.txt")).exit_code, 64);
    write(path("two.txt"), std::string(kReady) + "\n" + kReady + "\n");
    const Said way = query(unknown + " --json --own-space 0.05 --path " + path("two.txt"));
    EXPECT_EQ(way.exit_code, 0) << "a way begins where the arm stands: " << way.output;
    EXPECT_EQ(Json::parse(way.output).at("own_space_m"), 0.05);
    EXPECT_EQ(query(unknown + aside + " --stands " + kReady).exit_code, 2) << "there it does not stand";
    EXPECT_EQ(query(unknown + " --own-space 0.05 --stands " + kReady).exit_code, 0) << "as it stands";
    EXPECT_THAT(failure(unknown + aside + " --stands 0,1"),
                fails_with(64, code_is(ErrorCode::mismatch), key_is("the present posture"),
                           value_is("2 positions"), what_is(HasSubstr("7 joints"))));
    EXPECT_THAT(failure(unknown + aside + " --stands 1,,2"),
                fails_with(64, code_is(ErrorCode::bad_syntax), key_is("--stands '1,,2'"),
                           value_is(HasSubstr("no number"))));
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
