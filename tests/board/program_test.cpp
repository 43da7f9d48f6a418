// octoskin_board as a program: exit codes, report, candump log.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace octoskin {
namespace {

struct Outcome {
    int exit_code = -1;
    std::string text;  ///< of both outputs
};

Outcome run(const std::string& arguments) {
    Outcome outcome;
    FILE* pipe = popen((OCTOSKIN_BOARD_PROGRAM " " + arguments + " 2>&1").c_str(), "r");
    if (pipe == nullptr) return outcome;
    std::array<char, 4096> buffer{};
    for (std::size_t got = 0; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
        outcome.text.append(buffer.data(), got);
    const int status = pclose(pipe);
    if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
    return outcome;
}

const std::string kRig = " --rig " OCTOSKIN_SOURCE_DIR "/hw/rigs/bench_one_board.yaml ";
const std::string kImage = "--elf " OCTOSKIN_FLASHED_IMAGE;
const std::string kOffender = "--elf " OCTOSKIN_TINY_PROGRAMS "/offender.elf";

/// "I2C1: 348 transfers, 12 refused, ..."
int refused_on(const std::string& bus, const Outcome& outcome) {
    std::smatch found;
    if (!std::regex_search(outcome.text, found, std::regex(bus + ": [0-9]+ transfers, ([0-9]+) refused")))
        return -1;
    return std::stoi(found[1]);
}

TEST(OctoskinBoard, names_the_violation_and_its_place_and_exits_with_1) {
    const Outcome outcome = run(kOffender + kRig + "--seconds 0.1");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.text, testing::HasSubstr("violation unclocked: write of GPIOA"));
    EXPECT_THAT(outcome.text, testing::HasSubstr("at reset+0x"));
}

TEST(OctoskinBoard, exits_with_0_in_spite_of_violations_if_told_so) {
    const Outcome outcome = run(kOffender + kRig + "--seconds 0.1 --allow-violations");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.text, testing::HasSubstr("violation unclocked"));
}

TEST(OctoskinBoard, runs_the_flashed_image_and_logs_its_frames) {
    const std::string log = testing::TempDir() + "octoskin_board_test.log";
    const Outcome outcome = run(kImage + kRig + "--seconds 0.6 --serial --sync --can-log " + log);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    EXPECT_THAT(outcome.text, testing::HasSubstr("160 MHz from the crystal"));
    EXPECT_THAT(outcome.text, testing::HasSubstr("violations 0"));
    std::ifstream stream(log);
    std::size_t lines = 0;
    for (std::string line; std::getline(stream, line);) {
        EXPECT_THAT(line, testing::StartsWith("(17500000"));
        ++lines;
    }
    // Four sensors at 50 Hz from 0.2 s on, heartbeats and information.
    EXPECT_GT(lines, 80U);
    std::remove(log.c_str());
}

std::string contents(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(OctoskinBoard, says_the_same_bytes_on_every_run_and_others_with_another_crystal) {
    const std::string log = testing::TempDir() + "octoskin_board_same.log";
    const auto logged = [&](const std::string& more) {
        EXPECT_EQ(run(kImage + kRig + "--seconds 0.6 --sync --can-log " + log + more).exit_code, 0);
        return contents(log);
    };
    const std::string first = logged("");
    EXPECT_EQ(logged(""), first);
    EXPECT_NE(logged(" --drift-ppm 100"), first);
    EXPECT_NE(logged(" --cycles-per-instruction 3"), first);
    std::remove(log.c_str());
}

TEST(OctoskinBoard, an_i2c_fault_on_the_command_line_happens) {
    const Outcome outcome =
        run(kImage + kRig + "--seconds 0.6 --i2c-fault bus=0,kind=nack_address,first=100,count=4");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    const Outcome without = run(kImage + kRig + "--seconds 0.6");
    EXPECT_GT(refused_on("I2C1", outcome), refused_on("I2C1", without));
    // One poll more or less there is, as the loop has other things to do.
    EXPECT_EQ(refused_on("I2C2", outcome), refused_on("I2C2", without))
        << "the other buses see nothing of it";
}

TEST(OctoskinBoard, refuses_what_it_cannot_use) {
    EXPECT_EQ(run("").exit_code, 64);
    EXPECT_EQ(run(kImage + kRig + "--i2c-fault bus=9,kind=stretch").exit_code, 64);
    EXPECT_EQ(run(kImage + kRig + "--i2c-fault kind=gremlin").exit_code, 64);
    EXPECT_EQ(run(kImage + kRig + "--i2c-fault kind=sda_stuck_low,first=400,count=200").exit_code, 64);
    EXPECT_EQ(run(kImage).exit_code, 64) << "no configuration";
    EXPECT_EQ(run("--elf " OCTOSKIN_SOURCE_DIR "/README.md" + kRig).exit_code, 65);
    EXPECT_EQ(run(kImage + " --config " OCTOSKIN_SOURCE_DIR "/README.md").exit_code, 65);
    EXPECT_EQ(run(kImage + kRig + "--node nobody").exit_code, 78);
    EXPECT_EQ(run(kImage + kRig + "--seconds 0.01 --can-log /nowhere/at/all").exit_code, 73);
    const Outcome no_interface = run(kImage + kRig + "--seconds 0.01 --can nocan7");
    EXPECT_EQ(no_interface.exit_code, 69) << no_interface.text;
    EXPECT_THAT(no_interface.text, testing::HasSubstr("nocan7"));
    const Outcome backwards = run(kImage + kRig + "--seconds -1");
    EXPECT_EQ(backwards.exit_code, 64);
    EXPECT_THAT(backwards.text, testing::HasSubstr("not in range 0.001000 to 1000000.000000"));
    const Outcome help = run("--help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.text, testing::Not(testing::HasSubstr("{false}")));
}

}  // namespace
}  // namespace octoskin
