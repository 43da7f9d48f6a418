// octoskin query of a map file.
#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>

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
    const Said own = query(nothing_known + " --joints " + kReady + " --own-space 0.05");
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
    expect("", 69, "nobody knows how the arm stands");
    expect(" --joints 1,2", 64, "2 joint positions; the rig has 7 joints");
    expect(" --joints a,b", 64, "expected numbers");
    expect(" --joints 0,9,0,-2,0,1,0", 64, "panda_joint2 is 9; its limits are");
    expect(" --path " + path("bad.txt"), 65, "bad.txt:2: expected a joint configuration");
    expect(" --path " + path("none.txt"), 65, "no joint configuration");
    expect(" --path " + path("nowhere.txt"), 66, "nowhere.txt");
    expect(std::string(" --ignore-link hand --joints ") + kReady, 64, "the robot has no link 'hand'");
    const Said no_rig = octoskin("query " + map + " --joints " + kReady);
    EXPECT_EQ(no_rig.exit_code, 64) << no_rig.output;
    EXPECT_THAT(no_rig.output, HasSubstr("give --rig"));
    const Said no_daemon = octoskin("query --socket " + path("nobody"));
    EXPECT_EQ(no_daemon.exit_code, 69) << no_daemon.output;
}

}  // namespace
}  // namespace octoskin
