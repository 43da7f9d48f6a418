// A command that fails: its exit code, and its error as fields.
#pragma once

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>
#include <string>

#include "host/apps/command_line/error_json.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/system/said.hpp"

namespace octoskin {

struct Failure {
    int exit_code = -1;
    Error error = testing_support::no_error();
    std::string output = {};
};

/// How GoogleTest shows a failure.
inline void PrintTo(const Failure& failure, std::ostream* out) {
    *out << "exit code " << failure.exit_code << ", ";
    PrintTo(failure.error, out);
    *out << "\n" << failure.output;
}

/// The failure of a program that was run with --json-errors: the error is the last line that is an object of
/// JSON, with the exit code of the program. Without such a line the error is no_error().
inline Failure failure_in(const Said& said) {
    using Json = nlohmann::ordered_json;
    Failure failure{.exit_code = said.exit_code, .output = said.output};
    std::istringstream lines(said.output);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with('{')) continue;
        const Json json = Json::parse(line, nullptr, false);
        if (!json.is_object() || !json.contains("error")) continue;
        EXPECT_EQ(json.value("exit", -1), said.exit_code) << line;
        failure.error = error_of(json.at("error"));
    }
    return failure;
}

/// As `typed`, with --json-errors.
inline std::string typed_for_error(const std::string& arguments) {
    return (are_for_lab(arguments) ? OCTOSKIN_LAB_PROGRAM " --json-errors "
                                   : OCTOSKIN_PROGRAM " --json-errors ") +
           arguments;
}

/// Runs a command that should fail.
inline Failure failure_of(const std::string& arguments) {
    return failure_in(run(typed_for_error(arguments)));
}

/// The whole path of an error's file.
[[nodiscard]] inline auto path_is(const std::string& path) {
    return testing::ResultOf(
        "the path of its file", [](const Error& error) { return error.file.string(); }, path);
}

/// A failure with this exit code, whose error has these fields and a message that contains them.
template <typename... Fields>
[[nodiscard]] auto fails_with(int exit_code, const Fields&... fields) {
    const auto has_its_fields = testing::ResultOf(
        "a message with every field",
        [](const Error& error) { return static_cast<bool>(testing_support::has_its_fields(error)); }, true);
    const auto is_error = testing::Not(testing_support::is_no_error());
    return testing::AllOf(
        testing::Field("exit code", &Failure::exit_code, exit_code),
        testing::Field("error", &Failure::error, testing::AllOf(is_error, has_its_fields, fields...)));
}

}  // namespace octoskin
