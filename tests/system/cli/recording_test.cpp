// What a recording promises, through the program: the same bytes every time, and ordinary files for ordinary
// tools.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing::Not;

bool is_installed(const std::string& tool) {
    return run("command -v " + tool).exit_code == 0;
}

class Recording : public ProgramTest {};

TEST_F(Recording, replays_to_the_same_bytes_every_time) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec") + " --out " + path("one")).exit_code, 0);
    ASSERT_EQ(octoskin("replay " + path("rec") + " --out " + path("two")).exit_code, 0);
    for (const char* map : {"depth", "proximity", "fused"}) {
        for (const char* extension : {".ot", ".bt", ".ply"}) {
            const std::string file = std::string(map) + extension;
            EXPECT_GT(content(path("one/" + file)).size(), 1000U) << file;
            EXPECT_EQ(content(path("one/" + file)), content(path("two/" + file))) << file;
        }
    }
}

TEST_F(Recording, the_same_seed_records_the_same_and_another_seed_something_else) {
    record_short("a", "--seed 3");
    record_short("b", "--seed 3");
    record_short("c", "--seed 4");
    for (const char* file : {"can.log", "rig.yaml", "robot.urdf", "meta.yaml", "depth.epoch.yaml"}) {
        EXPECT_EQ(content(path(std::string("a/") + file)), content(path(std::string("b/") + file))) << file;
    }
    EXPECT_NE(content(path("a/can.log")), content(path("c/can.log")));
    EXPECT_NE(content(path("a/rig.yaml")), content(path("c/rig.yaml")));
    ASSERT_EQ(octoskin("replay " + path("a")).exit_code, 0);
    ASSERT_EQ(octoskin("replay " + path("b")).exit_code, 0);
    EXPECT_EQ(content(path("a/maps/fused.ot")), content(path("b/maps/fused.ot")));
}

/// Points of the map's surface: the corners of the faces that the .ply draws.
std::vector<std::array<float, 3>> points_of(const std::string& ply) {
    constexpr std::size_t kVertexBytes = 15;  // three floats, three bytes of colour
    constexpr std::string_view kEnd = "end_header\n";
    std::vector<std::array<float, 3>> points;
    for (std::size_t i = 0; i < 16; ++i) {
        const std::size_t at = ply.find(kEnd) + kEnd.size() + 97 * i * kVertexBytes;
        if (at + kVertexBytes > ply.size()) break;
        std::memcpy(points.emplace_back().data(), ply.data() + at, sizeof(points.back()));
    }
    return points;
}

TEST_F(Recording, explains_voxels_by_what_made_them) {
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    int explained = 0;
    for (const auto& [x, y, z] : points_of(content(path("rec/maps/proximity.ply")))) {
        const std::string point = std::to_string(x) + ' ' + std::to_string(y) + ' ' + std::to_string(z);
        const Said said = octoskin("explain " + point + " --lines 100000 --json --recording " + path("rec"));
        ASSERT_EQ(said.exit_code, 0) << said.output;
        const auto json = nlohmann::json::parse(said.output);
        double sum = 0.0;
        for (const auto& contribution : json["contributions"]) sum += contribution["change"].get<double>();
        const double log_odds = json["log_odds"].is_null() ? 0.0 : json["log_odds"].get<double>();
        EXPECT_NEAR(sum, log_odds, 1e-9) << said.output;
        EXPECT_EQ(json["contributions"].size(), json["contributions_in_all"]);
        EXPECT_THAT(json["conclusion"].get<std::string>(),
                    testing::StartsWith(json["occupancy"].get<std::string>()));
        explained += json["contributions"].empty() ? 0 : 1;
    }
    EXPECT_GT(explained, 4);
    EXPECT_EQ(octoskin("explain 0 0 1e9 --recording " + path("rec")).exit_code, 64);
    EXPECT_EQ(octoskin("explain 0 0 0 --recording " + path("nowhere")).exit_code, 66);
}

TEST_F(Recording, plays_at_the_speed_asked_for_and_step_by_step) {
    record_short("rec");
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(octoskin("replay " + path("rec") + " --out " + path("slow") + " --speed 4").exit_code, 0);
    // 4.5 s of log.
    EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1'000));
    ASSERT_EQ(octoskin("replay " + path("rec") + " --out " + path("fast")).exit_code, 0);
    EXPECT_TRUE(content(path("slow/fused.ot")) == content(path("fast/fused.ot")));
    const Said stepped = run("yes '' | " OCTOSKIN_PROGRAM " replay " + path("rec") + " --step");
    EXPECT_EQ(stepped.exit_code, 0);
    EXPECT_THAT(stepped.output, HasSubstr("(1750000000.000135) can0 040#092E26"));
    EXPECT_EQ(octoskin("replay " + path("rec") + " --speed fast").exit_code, 64);
    EXPECT_EQ(octoskin("replay " + path("rec") + " --speed 0").exit_code, 64);
    EXPECT_EQ(octoskin("replay " + path("rec") + " --speed ''").exit_code, 64);
    EXPECT_EQ(octoskin("replay " + path("rec") + " --onto fd:77").exit_code, 64);
    EXPECT_EQ(octoskin("replay " + path("rec") + " --onto nobus9").exit_code, 69);
}

TEST_F(Recording, prints_an_account_that_balances_for_every_kind_of_input) {
    record_short("rec");
    const Said said = octoskin("replay " + path("rec"));
    EXPECT_THAT(said.output, testing::ContainsRegex("the arm's last known posture, for `octoskin query`: "
                                                    "--stands=-?[0-9.]+(,-?[0-9.]+){6}\n"));
    ASSERT_EQ(said.exit_code, 0);
    const auto frames = content(path("rec/can.log"));
    const auto lines = std::count(frames.begin(), frames.end(), '\n');
    EXPECT_THAT(said.output,
                HasSubstr(std::to_string(lines) + " in = " + std::to_string(lines) + " used + 0 rejected"));
    for (const char* unit : {"log lines", "CAN frames", "readings", "joint samples", "depth frames"}) {
        EXPECT_THAT(said.output, HasSubstr(unit));
    }
    EXPECT_THAT(said.output, HasSubstr("12 in = 10 used + 2 rejected"));  // two depth frames before START
}

TEST_F(Recording, its_log_goes_through_can_utils_and_back) {
    if (!is_installed("log2asc")) GTEST_SKIP() << "can-utils is not installed";
    record_short("rec");
    const Said there = run("log2asc -I " + path("rec/can.log") + " -O " + path("can.asc") + " can0");
    ASSERT_EQ(there.exit_code, 0) << there.output;
    ASSERT_EQ(run("asc2log -I " + path("can.asc") + " -O " + path("back.log")).exit_code, 0);
    // Time stamps become relative on the way, and asc2log names the bus itself: the frames are what must
    // survive.
    const std::string frames = " sed 's/^([^)]*) [a-z0-9]* //; s/ [RT]$//' ";
    const Said original = run(frames + path("rec/can.log"));
    const Said returned = run(frames + path("back.log"));
    EXPECT_GT(original.output.size(), 10'000U);
    EXPECT_EQ(original.output, returned.output);
}

TEST_F(Recording, its_maps_are_read_by_octomaps_tools) {
    if (!is_installed("compare_octrees")) GTEST_SKIP() << "octomap-tools is not installed";
    record_short("rec");
    ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
    const std::string fused = path("rec/maps/fused.ot");
    const Said same = run("compare_octrees " + fused + " " + fused);
    EXPECT_EQ(same.exit_code, 0) << same.output;
    EXPECT_THAT(same.output, HasSubstr("KLD"));
    const Said vrml = run("bt2vrml " + path("rec/maps/fused.bt"));
    EXPECT_EQ(vrml.exit_code, 0) << vrml.output;
    EXPECT_GT(std::filesystem::file_size(path("rec/maps/fused.bt.wrl")), 10'000U);
}

TEST_F(Recording, another_robot_rig_and_world_need_no_rebuild) {
    const Said said = octoskin("simulate " + path("rec") + " --rig " + source("tests/data/gantry/rig.yaml") +
                               " --scenario " + source("tests/data/gantry/scenario.yaml"));
    ASSERT_EQ(said.exit_code, 0) << said.output;
    EXPECT_FALSE(std::filesystem::exists(path("rec/depth.oni")));
    const Said replayed = octoskin("replay " + path("rec"));
    ASSERT_EQ(replayed.exit_code, 0) << replayed.output;
    // One sensor looks at the wall, one along the pillar's rounding; both for 2 s at 30 Hz.
    EXPECT_THAT(replayed.output, HasSubstr("313 in = 122 used + 191 rejected"));
}

TEST_F(Recording, the_experiment_leaves_maps_metrics_a_recording_and_a_report) {
    const Said said = octoskin("experiment --seeds 0 1 --jobs 2 --configurations denoised paper --out " +
                               path("out") + " --rig " + source("tests/data/short/rig.yaml") +
                               " --scenario " + source("tests/data/short/scenario.yaml"));
    ASSERT_EQ(said.exit_code, 0) << said.output;
    for (const char* map : {"depth", "proximity", "fused"}) {
        for (const char* extension : {".ot", ".bt", ".ply"}) {
            EXPECT_GT(content(path(std::string("out/") + map + extension)).size(), 1000U) << map << extension;
        }
    }
    const auto metrics = nlohmann::json::parse(content(path("out/metrics.json")));
    for (const char* configuration : {"denoised", "paper"}) {
        for (const char* map : {"depth", "proximity", "fused"}) {
            for (const char* metric : {"occupied", "free", "missed", "incorrect", "lost", "precision",
                                       "recall", "f1", "iou", "occluded_recall", "object_recall"}) {
                const auto& figure = metrics.at(configuration).at(map).at(metric);
                EXPECT_EQ(figure.at("per_seed").size(), 2U);
                EXPECT_TRUE(figure.contains("mean") && figure.contains("sd"));
            }
        }
    }
    const std::string report = content(path("out/report.html"));
    EXPECT_GT(report.size(), 100'000U);
    EXPECT_THAT(report, Not(HasSubstr("src=\"http")));
    // Only the first seed's recording stays, and the maps are what it replays to.
    EXPECT_FALSE(std::filesystem::exists(path("out/recording-seed-1")));
    ASSERT_EQ(octoskin("replay " + path("out/recording")).exit_code, 0);
    EXPECT_EQ(content(path("out/recording/maps/fused.ot")), content(path("out/fused.ot")));
    EXPECT_EQ(octoskin("evaluate " + path("out/fused.ot") + " --rig " + path("out/recording/rig.yaml") +
                       " --scenario " + source("tests/data/short/scenario.yaml"))
                  .exit_code,
              0);
}

}  // namespace
}  // namespace octoskin
