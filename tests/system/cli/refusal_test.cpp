// What a new user meets first: each refusal has the exit code that the help promises, names what is wrong,
// and says the way out.
#include <gmock/gmock.h>

#include <vector>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing::Not;

class Refusal : public ProgramTest {
  protected:
    struct Case {
        std::string arguments;
        int exit_code;
        std::string words;
    };
    static void expect_each(const std::vector<Case>& cases) {
        for (const Case& each : cases) {
            const Said said = run("timeout 30 " + typed(each.arguments));
            EXPECT_EQ(said.exit_code, each.exit_code) << each.arguments << ": " << said.output;
            EXPECT_THAT(said.output, HasSubstr(each.words)) << each.arguments;
        }
    }
    const std::string rig_ = source("hw/rigs/bench_one_board.yaml");
};

TEST_F(Refusal, of_a_place_where_nothing_can_be_made_says_where_else) {
    const std::string daemon = "run --no-camera --can nocan9 --rig " + rig_ + " --maps ";
    const std::string absent = "does not exist; create it, or name a place elsewhere with ";
    write(path("file"), "");
    expect_each({
        {daemon + path("maps") + " --socket /nodir/x", 69, "the folder /nodir " + absent + "--socket"},
        {daemon + path("maps") + " --socket " + path("control") + " --joints /nodir/j", 69,
         "the folder /nodir " + absent + "--joints"},
        {daemon + path("maps") + " --socket " + path("file/x"), 69, "is no folder; name a place elsewhere"},
        {daemon + "/proc/none --socket " + path("control"), 73, "write elsewhere; --maps names the folder"},
        {"simulate /proc/none", 73, "nothing can be written there (No such file or directory): its folder"},
        {"experiment --out " + path("file/out"), 73, "write elsewhere"},
    });
}

TEST_F(Refusal, of_options_that_would_be_ignored) {
    const std::string can = "joints --can nocan9 --rig " + rig_;
    expect_each({
        {"rig " + rig_ + " --canonical --block " + path("block"), 64, "--canonical"},
        {"rig " + rig_ + " --node bench", 64, "--block"},
        {can + " --socket " + path("joints") + " < /dev/null", 64, "--socket"},
        {"joints --can fd:0 --rig " + rig_ + " < /dev/null", 64, "fd:0 is not a socket"},
        {"calibrate offset --can fd:0 --target-mm 140 --sensor front --rig " + rig_ + " < /dev/null", 64,
         "fd:0"},
    });
    EXPECT_FALSE(std::filesystem::exists(path("block")));
}

TEST_F(Refusal, of_a_number_says_what_it_must_be) {
    const std::string calibrate = "calibrate offset --can nocan9 --sensor a --rig " + rig_ + " --target-mm ";
    expect_each({
        {calibrate + "140mm", 64, "expected a whole number from 1 to 4000, found '140mm'"},
        {calibrate + "0", 64, "expected a whole number from 1 to 4000, found '0'"},
        {"record " + path("out") + " --seconds -1", 64, "expected a number from 0 to 1000000, found '-1'"},
    });
}

TEST_F(Refusal, of_one_kind_of_file_in_place_of_another_says_what_it_looks_like) {
    expect_each({
        {"rig " + source("hw/robots/panda.urdf"), 78,
         "panda.urdf: expected YAML, found XML that looks like a robot (URDF)"},
        {"rig " + source("hw/worlds/experiment.sdf"), 78, "found XML that looks like a world (SDF)"},
        {"mapping " + rig_, 78, "not a key of a mapping file, but of a rig, which this looks like"},
    });
}

TEST_F(Refusal, of_a_recording_names_the_part_that_is_wrong) {
    record_short("rec");
    std::filesystem::copy(path("rec"), path("lonely"));
    std::filesystem::remove(path("lonely/depth.epoch.yaml"));
    std::filesystem::copy(path("rec"), path("other"));
    std::filesystem::remove(path("other/depth.oni"));
    std::filesystem::copy(path("rec"), path("robto"));
    write(path("robto/meta.yaml"), "schema: octoskin-recording/1\nsource: robto\n");
    std::filesystem::create_directory(path("set"));
    write(path("set/depth.txt"), "1.0 depth/1.png\n");
    expect_each({
        {"replay " + path("lonely"), 66, "depth.epoch.yaml: no such file, but depth.oni exists"},
        {"replay " + path("other"), 66, "depth.oni: no such file, but depth.epoch.yaml exists"},
        {"replay " + path("robto"), 65, "meta.yaml:2: source: expected robot or simulation, found 'robto'"},
        {"replay " + path("set"), 66, "groundtruth.txt: no such file"},
    });
}

TEST_F(Refusal, of_a_map_without_rig_names_one_that_is_there) {
    record_short("rec");
    std::filesystem::rename(path("rec/rig.yaml"), path("rec/mine.yaml"));
    ASSERT_EQ(octoskin("replay " + path("rec") + " --rig " + path("rec/mine.yaml")).exit_code, 0);
    expect_each({{"evaluate " + path("rec/maps/fused.ot"), 64, "give --rig " + path("rec/mine.yaml")}});
}

TEST_F(Refusal, of_a_step_that_nobody_asks_for_ends_the_replay) {
    record_short("rec");
    const Said said = run("printf '\\n\\n' | " OCTOSKIN_PROGRAM " replay " + path("rec") + " --step");
    EXPECT_EQ(said.exit_code, 74) << said.output;
    EXPECT_THAT(said.output, HasSubstr("standard input, and with it the replay, ended"));
    EXPECT_THAT(said.output, HasSubstr("(1750000000.000135) can0 040#092E26"));
    EXPECT_FALSE(std::filesystem::exists(path("rec/maps")));
}

TEST_F(Refusal, of_a_package_section_is_helped_by_the_installer_itself) {
    const Said said = run(source("toolchains/install_packages") + " --help");
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, HasSubstr("toolchains/install_packages SECTION..."));
    EXPECT_THAT(said.output, Not(HasSubstr("no such section")));
}

}  // namespace
}  // namespace octoskin
