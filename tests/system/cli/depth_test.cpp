// `octoskin-lab depth`: depth updates on noisy images of a world, without a recording.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>
#include <vector>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::key_is;
using testing_support::value_is;
using testing_support::what_is;

class DepthCommand : public ProgramTest {
  protected:
    /// With a small camera. `scenario`: of the shipped worlds.
    [[nodiscard]] static std::string depth(const std::string& arguments,
                                           const std::string& scenario = "experiment") {
        return "depth " + source("hw/worlds/" + scenario + ".scenario.yaml") + " --rig " +
               source("tests/data/short/rig.yaml") + " " + arguments;
    }
    /// What it writes with --json.
    [[nodiscard]] Json figures_of(const std::string& arguments) const {
        const Said said = octoskin(depth(arguments) + " --json " + path("figures.json"));
        EXPECT_EQ(said.exit_code, 0) << said.output;
        return Json::parse(content(path("figures.json")));
    }
};

TEST_F(DepthCommand, writes_the_figures_of_every_noise_seed_time_and_contender) {
    const std::string arguments =
        "--configurations denoised paper --noise 0.02 kinect --sigma-factor 1 0.5 --seeds 3 1 --at 0.2 0";
    const Json json = figures_of(arguments + " --jobs 2");
    EXPECT_THAT(json.at("program").get<std::string>(), HasSubstr("(commit "));
    EXPECT_EQ(json.at("rig"), "short");
    EXPECT_EQ(json.at("scene"), "stationary");
    using Row = std::tuple<std::string, int, double, std::string, double>;
    std::vector<Row> expected;
    for (const char* noise : {"0.02", "kinect"})
        for (const int seed : {3, 1})
            for (const double t_s : {0.0, 0.2})
                for (const auto& [configuration, factor] :
                     {std::pair("denoised", 1.0), {"denoised", 0.5}, {"paper", 1.0}})
                    expected.emplace_back(noise, seed, t_s, configuration, factor);
    std::vector<Row> rows;
    for (const Json& figures : json.at("figures")) {
        rows.emplace_back(figures.at("noise"), figures.at("seed"), figures.at("t_s"),
                          figures.at("configuration"), figures.at("sigma_factor"));
        EXPECT_EQ(figures.at("scenario"), "experiment");
        for (const char* share :
             {"precision", "precision_tolerant", "f1_seen", "f1_noise_free", "seen_occupied", "seen_free",
              "seen_unknown", "body_2cm", "body_5cm", "availability"}) {
            EXPECT_GE(figures.at(share), 0.0) << share;
            EXPECT_LE(figures.at(share), 1.0) << share;
        }
        EXPECT_GT(figures.at("all").at("voxels"), 100);
    }
    EXPECT_EQ(rows, expected);
    const std::string text = content(path("figures.json"));
    EXPECT_EQ(figures_of(arguments + " --jobs 1"), json);
    EXPECT_EQ(content(path("figures.json")), text) << "whatever is done at once";
}

TEST_F(DepthCommand, writes_them_after_its_tables_to_standard_output) {
    const Said said = run(typed(depth("--configurations paper --at 0 --json /dev/stdout")), "2>/dev/null");
    ASSERT_EQ(said.exit_code, 0);
    const std::size_t begin = said.output.find("\n{");
    ASSERT_NE(begin, std::string::npos);
    EXPECT_THAT(said.output.substr(0, begin), HasSubstr("noise 0.03"));
    EXPECT_EQ(Json::parse(said.output.substr(begin)).at("figures").size(), 1U);
}

TEST_F(DepthCommand, judges_a_moving_camera_at_the_first_and_the_last_image) {
    const Json json = figures_of("--configurations paper --moving --at 0.3 0.1 0.2");
    EXPECT_EQ(json.at("scene"), "moving");
    ASSERT_EQ(json.at("figures").size(), 2U);
    EXPECT_EQ(json.at("figures").at(0).at("t_s"), 0.0);
    EXPECT_EQ(json.at("figures").at(1).at("t_s"), 0.3);
}

TEST_F(DepthCommand, moves_the_hand_of_a_world_itself) {
    const Said said =
        octoskin(depth("--configurations paper --noise 0.005 --hand --json " + path("hand.json"), "hand"));
    ASSERT_EQ(said.exit_code, 0) << said.output;
    const Json json = Json::parse(content(path("hand.json")));
    EXPECT_EQ(json.at("scene"), "hand");
    ASSERT_EQ(json.at("figures").size(), 8U) << "two paths at four speeds";
    for (const Json& figures : json.at("figures")) {
        EXPECT_GT(figures.at("voxels"), 0);
        EXPECT_GT(figures.at("occupied"), 0);
    }
}

TEST_F(DepthCommand, refuses_what_it_cannot_study_before_it_begins) {
    EXPECT_THAT(failure_of(depth("--noise 0.5")),
                fails_with(64, code_is(ErrorCode::bad_value), key_is("--noise"), value_is("'0.5'")));
    EXPECT_THAT(failure_of(depth("--seeds 1 2 1")),
                fails_with(64, code_is(ErrorCode::duplicate), key_is("--seeds"), value_is("1 again")));
    EXPECT_THAT(failure_of(depth("--configurations denoised denoised")),
                fails_with(64, code_is(ErrorCode::duplicate), key_is("--configurations")));
    EXPECT_THAT(failure_of(depth("--configurations paper_noise_free_robot_seen")),
                fails_with(64, code_is(ErrorCode::unsupported), key_is("--configurations")));
    EXPECT_THAT(failure_of(depth("--configurations denoizd")),
                fails_with(66, code_is(ErrorCode::not_found), value_is("'denoizd'")));
    EXPECT_THAT(failure_of(depth("--configurations fast --noise 0.1 --sigma-factor 10")),
                fails_with(64, code_is(ErrorCode::out_of_range), key_is("--sigma-factor")));
    for (const char* wrong : {"--sigma-factor 0", "--at -1", "--jobs 0", "--seeds x", "--moving --hand"})
        EXPECT_EQ(octoskin(depth(wrong)).exit_code, 64) << wrong;
    EXPECT_THAT(failure_of("depth " + source("hw/worlds/experiment.scenario.yaml") + " --rig " +
                           source("hw/rigs/bench_one_board.yaml")),
                fails_with(78, code_is(ErrorCode::missing_key), key_is("camera"),
                           path_is(source("hw/rigs/bench_one_board.yaml"))));
    EXPECT_THAT(failure_of(depth("", "moving")), fails_with(78)) << "models that move have no one place";
    EXPECT_EQ(octoskin("depth " + path("gone.yaml")).exit_code, 66);
}

TEST_F(DepthCommand, refuses_a_place_for_its_figures_before_it_begins) {
    std::filesystem::create_directory(path("folder"));
    EXPECT_THAT(failure_of(depth("--json " + path("folder"))),
                fails_with(73, code_is(ErrorCode::wrong_kind_of_file), path_is(path("folder"))));
    EXPECT_THAT(failure_of(depth("--json " + path("gone/figures.json"))),
                fails_with(73, path_is(path("gone/figures.json")), what_is(HasSubstr("cannot be written"))));
    EXPECT_TRUE(std::filesystem::is_empty(path("folder")));
    EXPECT_FALSE(std::filesystem::exists(path("gone")));
}

TEST_F(DepthCommand, replaces_a_link_and_not_what_it_names_and_nothing_if_it_fails) {
    write(path("thesis.txt"), "precious");
    std::filesystem::create_symlink(path("thesis.txt"), path("figures.json"));
    EXPECT_EQ(octoskin(depth("--noise 0.5 --json " + path("figures.json"))).exit_code, 64);
    EXPECT_TRUE(std::filesystem::is_symlink(path("figures.json")));
    EXPECT_EQ(figures_of("--configurations paper --at 0").at("figures").size(), 1U);
    EXPECT_FALSE(std::filesystem::is_symlink(path("figures.json")));
    EXPECT_EQ(content(path("thesis.txt")), "precious");
}

}  // namespace
}  // namespace octoskin
