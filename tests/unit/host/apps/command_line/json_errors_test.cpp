// The option --json-errors of a program with subcommands.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/program.hpp"

namespace octoskin::app {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

void add_commands(CLI::App& app) {
    app.add_subcommand("fail", "Fails")->callback([] {
        throw CommandFailure(ExitCode::bad_data, {.code = ErrorCode::damaged,
                                                  .what = "expected a checksum",
                                                  .value = "'\x7f'",
                                                  .remedy = "copy it again",
                                                  .file = "map.ot",
                                                  .line = 3,
                                                  .key = "crc32"});
    });
    app.add_subcommand("break", "Has a defect")->callback([] { throw std::logic_error("impossible"); });
    app.add_subcommand("take", "Takes a number")->add_option("--count")->check(from_to(1, 9));
}

struct Ended {
    int exit_code = 0;
    std::string standard_error;
};

Ended run(std::vector<std::string> words) {
    static int runs = 0;  // each run registers a logger of its program's name
    words.insert(words.begin(), "test" + std::to_string(++runs));
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    testing::internal::CaptureStderr();
    const int exit_code =
        run_program({words.front(), "A test", "", add_commands}, static_cast<int>(words.size()), argv.data());
    return {exit_code, testing::internal::GetCapturedStderr()};
}

/// The one line of JSON on standard error; null if there is none, or more.
Json error_of(const Ended& ended) {
    if (ended.standard_error.find('\n') + 1 != ended.standard_error.size()) return nullptr;
    const Json json = Json::parse(ended.standard_error, nullptr, false);
    if (!json.is_object() || json.value("exit", -1) != ended.exit_code) return nullptr;
    return json.at("error");
}

TEST(JsonErrors, are_asked_for_before_the_command_only) {
    const Ended ended = run({"fail", "--json-errors"});
    EXPECT_EQ(ended.exit_code, 64);
    EXPECT_THAT(ended.standard_error, HasSubstr("--json-errors: expected once"));
}

TEST(JsonErrors, have_the_fields_of_the_error_and_the_exit_code) {
    const Ended ended = run({"--json-errors", "fail"});
    EXPECT_EQ(ended.exit_code, 65);
    const Json error = error_of(ended);
    ASSERT_TRUE(error.is_object()) << ended.standard_error;
    EXPECT_EQ(error.at("code"), "damaged");
    EXPECT_EQ(error.at("file"), "map.ot");
    EXPECT_EQ(error.at("line"), 3);
    EXPECT_EQ(error.at("key"), "crc32");
    EXPECT_EQ(error.at("value"), "'\x7f'");
    EXPECT_EQ(error.at("remedy"), "copy it again");
    EXPECT_FALSE(error.contains("column"));
}

TEST(JsonErrors, include_those_of_the_command_line) {
    const Ended value = run({"--json-errors", "take", "--count", "12"});
    EXPECT_EQ(value.exit_code, 64);
    const Json error = error_of(value);
    ASSERT_TRUE(error.is_object()) << value.standard_error;
    EXPECT_EQ(error.at("code"), "bad_argument");
    EXPECT_EQ(error.at("key"), "--count");
    EXPECT_EQ(error.at("value"), "'12'");
    const Json unknown = error_of(run({"--json-errors", "fial"}));
    ASSERT_TRUE(unknown.is_object());
    EXPECT_EQ(unknown.at("code"), "unknown_word");
    EXPECT_EQ(unknown.at("value"), "'fial'");
    EXPECT_THAT(unknown.at("remedy").get<std::string>(), HasSubstr("'fail'"));
    EXPECT_EQ(error_of(run({"--json-errors"})).at("code"), "bad_argument");
    EXPECT_EQ(error_of(run({"--json-errors", "take", "1"})).at("code"), "bad_argument");
    const Json misspelt = error_of(run({"--json-errors", "take", "--counts", "1"}));
    EXPECT_EQ(misspelt.at("code"), "unknown_word");
    EXPECT_EQ(misspelt.at("value"), "'--counts'");
    EXPECT_THAT(misspelt.at("remedy").get<std::string>(), HasSubstr("'--count'"));
}

TEST(JsonErrors, include_defects) {
    const Ended ended = run({"--json-errors", "break"});
    EXPECT_EQ(ended.exit_code, 70);
    EXPECT_EQ(error_of(ended).at("code"), "self_check");
}

TEST(JsonErrors, are_printed_only_with_the_option) {
    const Ended ended = run({"fail"});
    EXPECT_EQ(ended.exit_code, 65);
    EXPECT_THAT(ended.standard_error, HasSubstr("map.ot:3: crc32: expected a checksum, found "));
    EXPECT_TRUE(error_of(ended).is_null());
    EXPECT_EQ(run({"--json-errors", "take", "--count", "3"}).exit_code, 0);
    EXPECT_EQ(run({"take", "--json-errors"}).exit_code, 64) << "the option is before the command";
}

TEST(FirstArgument, is_the_one_after_the_option) {
    const auto first = [](std::vector<const char*> words) {
        words.insert(words.begin(), "octoskin");
        return std::string(first_argument(static_cast<int>(words.size()), words.data()));
    };
    EXPECT_EQ(first({}), "");
    EXPECT_EQ(first({"run"}), "run");
    EXPECT_EQ(first({"--json-errors"}), "");
    EXPECT_EQ(first({"--json-errors", "run"}), "run");
    EXPECT_EQ(first({"--help", "run"}), "--help");
}

}  // namespace
}  // namespace octoskin::app
