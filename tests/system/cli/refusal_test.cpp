// What a new user meets first: each refusal has the exit code that the help promises, names what is wrong,
// and says the way out.
#include <gmock/gmock.h>

#include <vector>

#include "host/core/text/printable.hpp"
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

class Refusal : public ProgramTest {
  protected:
    struct Case {
        std::string arguments;
        testing::Matcher<Failure> failure;
    };
    /// Each as fields and, with the same fields in its sentence, as a person sees it.
    static void expect_each(const std::vector<Case>& cases) {
        for (const Case& each : cases) {
            const Failure failure = failure_in(run("timeout 30 " + typed_for_error(each.arguments)));
            EXPECT_THAT(failure, each.failure) << each.arguments;
            const Said said = run("timeout 30 " + typed(each.arguments));
            EXPECT_EQ(said.exit_code, failure.exit_code) << each.arguments << ": " << said.output;
            for (const std::string& part : printed_parts(failure.error))
                EXPECT_THAT(said.output, HasSubstr(part)) << each.arguments;
        }
    }
    const std::string rig_ = source("hw/rigs/bench_one_board.yaml");

  private:
    /// File with line, key, value and remedy, as they are in the sentence.
    static std::vector<std::string> printed_parts(const Error& error) {
        std::string place = error.file.string();
        if (error.line > 0) place += ":" + std::to_string(error.line);
        std::vector<std::string> parts;
        for (const std::string& part : {place, error.key, error.value}) parts.push_back(printable(part));
        // CLI11 begins its hint, "run with --help", with a capital letter.
        if (!error.remedy.empty()) parts.push_back(printable(error.remedy.substr(1)));
        return parts;
    }
};

TEST_F(Refusal, of_a_place_where_nothing_can_be_made_says_where_else) {
    const std::string daemon = "run --no-camera --can nocan9 --rig " + rig_ + " --maps ";
    write(path("file"), "");
    const auto not_in = [](const std::string& socket, const std::string& folder, const std::string& option) {
        return fails_with(69, code_is(ErrorCode::not_found), path_is(socket), what_is(HasSubstr(folder)),
                          remedy_is(AllOf(HasSubstr("create it"), HasSubstr(option))));
    };
    expect_each({
        {daemon + path("maps") + " --socket /nodir/x", not_in("/nodir/x", "/nodir", "--socket")},
        {daemon + path("maps") + " --socket " + path("control") + " --joints /nodir/j",
         not_in("/nodir/j", "/nodir", "--joints")},
        {daemon + path("maps") + " --socket " + path("file/x"),
         fails_with(69, code_is(ErrorCode::wrong_kind_of_file), path_is(path("file/x")),
                    what_is(HasSubstr(path("file") + " is no folder")), remedy_is(HasSubstr("--socket")))},
        {daemon + "/proc/none --socket " + path("control"),
         fails_with(73, path_is("/proc/none"),
                    remedy_is(AllOf(HasSubstr("write elsewhere"), HasSubstr("--maps"))))},
        {"simulate /proc/none",
         fails_with(73, code_is(ErrorCode::not_found), path_is("/proc/none"),
                    what_is(HasSubstr("(No such file or directory)")), remedy_is(HasSubstr("its folder")))},
        {"experiment --out " + path("file/out"),
         fails_with(73, path_is(path("file/out")), remedy_is(HasSubstr("write elsewhere")))},
    });
}

TEST_F(Refusal, of_options_that_would_be_ignored) {
    const std::string can = "joints --can nocan9 --rig " + rig_;
    const auto sentence_with = [](const std::string& option) {
        return fails_with(64, code_is(ErrorCode::bad_argument), what_is(HasSubstr(option)),
                          remedy_is(HasSubstr("--help")));
    };
    expect_each({
        {"rig " + rig_ + " --canonical --block " + path("block"), sentence_with("--canonical")},
        {"rig " + rig_ + " --node bench", sentence_with("--block")},
        {can + " --socket " + path("joints") + " < /dev/null", sentence_with("--socket")},
        {"joints --can fd:0 --rig " + rig_ + " < /dev/null",
         fails_with(64, code_is(ErrorCode::wrong_kind_of_file), path_is("fd:0"))},
        {"calibrate offset --can fd:0 --target-mm 140 --sensor front --rig " + rig_ + " < /dev/null",
         fails_with(64, path_is("fd:0"))},
    });
    EXPECT_FALSE(std::filesystem::exists(path("block")));
}

TEST_F(Refusal, of_a_number_says_what_it_must_be) {
    const std::string calibrate = "calibrate offset --can nocan9 --sensor a --rig " + rig_ + " --target-mm ";
    const auto number = [](const std::string& option, const std::string& range, const std::string& value) {
        return fails_with(64, code_is(ErrorCode::bad_argument), key_is(option), what_is(HasSubstr(range)),
                          value_is("'" + value + "'"), remedy_is(HasSubstr("--help")));
    };
    expect_each({
        {calibrate + "140mm", number("--target-mm", "from 1 to 4000", "140mm")},
        {calibrate + "0", number("--target-mm", "from 1 to 4000", "0")},
        {"record " + path("out") + " --seconds -1", number("--seconds", "from 0 to 1000000", "-1")},
    });
}

TEST_F(Refusal, of_one_kind_of_file_in_place_of_another_says_what_it_looks_like) {
    const auto other_kind = [](const std::string& file, const std::string& kind) {
        return fails_with(78, code_is(ErrorCode::foreign_format), path_is(source(file)),
                          value_is(HasSubstr(kind)), remedy_is(HasSubstr("another file")));
    };
    expect_each({
        {"rig " + source("hw/robots/panda.urdf"), other_kind("hw/robots/panda.urdf", "a robot (URDF)")},
        {"rig " + source("hw/worlds/experiment.sdf"),
         other_kind("hw/worlds/experiment.sdf", "a world (SDF)")},
        {"mapping " + rig_, fails_with(78, code_is(ErrorCode::foreign_format), path_is(rig_),
                                       what_is(HasSubstr("of a rig, which this looks like")))},
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
    const auto missing = [this](const std::string& file, const std::string& other) {
        return fails_with(66, code_is(ErrorCode::not_found), path_is(path(file)),
                          what_is(HasSubstr(other + " exists")), remedy_is(HasSubstr("put it there")));
    };
    expect_each({
        {"replay " + path("lonely"), missing("lonely/depth.epoch.yaml", "depth.oni")},
        {"replay " + path("other"), missing("other/depth.oni", "depth.epoch.yaml")},
        {"replay " + path("robto"),
         fails_with(65, code_is(ErrorCode::unknown_word), path_is(path("robto/meta.yaml")), line_is(2),
                    key_is("source"), what_is(HasSubstr("robot or simulation")), value_is("'robto'"))},
        {"replay " + path("set"),
         fails_with(66, code_is(ErrorCode::not_found), path_is(path("set/groundtruth.txt")),
                    remedy_is(HasSubstr("groundtruth.txt")))},
    });
}

TEST_F(Refusal, of_a_map_without_rig_names_one_that_is_there) {
    record_short("rec");
    std::filesystem::rename(path("rec/rig.yaml"), path("rec/mine.yaml"));
    ASSERT_EQ(octoskin("replay " + path("rec") + " --rig " + path("rec/mine.yaml")).exit_code, 0);
    expect_each({{"evaluate " + path("rec/maps/fused.ot"),
                  fails_with(64, code_is(ErrorCode::bad_argument), key_is("--rig"),
                             remedy_is(HasSubstr("give --rig " + path("rec/mine.yaml"))))}});
}

TEST_F(Refusal, of_a_step_that_nobody_asks_for_ends_the_replay) {
    record_short("rec");
    const Failure failure =
        failure_in(run("printf '\\n\\n' | " + typed_for_error("replay " + path("rec") + " --step")));
    EXPECT_THAT(failure, fails_with(74, code_is(ErrorCode::no_data), path_is("standard input"),
                                    remedy_is(HasSubstr("--step"))));
    EXPECT_THAT(failure.output, HasSubstr("(1750000000.000135) can0 040#092E26"));
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
