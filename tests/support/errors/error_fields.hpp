// What a test requires of an error: fields with given values, and a sentence that contains the fields.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "host/errors/error.hpp"

namespace octoskin {

/// How GoogleTest shows an error.
inline void PrintTo(const Error& error, std::ostream* out) {
    *out << name_of(error.code) << ": " << error.message();
}

}  // namespace octoskin

namespace octoskin::testing_support {

/// True if the sentence contains file, line, key, what, value and remedy, as far as the error has them, and
/// the error has a `what`.
[[nodiscard]] inline testing::AssertionResult has_its_fields(const Error& error) {
    const std::string message = error.message();
    std::string place = error.file.string();
    if (error.line > 0) place += (place.empty() ? "" : ":") + std::to_string(error.line);
    if (!place.empty() && !message.starts_with(place + ":"))
        return testing::AssertionFailure() << "'" << place << "' does not begin: " << message;
    for (const std::string& field : {error.key, error.what, error.value, error.remedy}) {
        if (message.find(field) == std::string::npos)
            return testing::AssertionFailure() << "'" << field << "' is missing in: " << message;
    }
    if (error.what.empty()) return testing::AssertionFailure() << "no broken rule in: " << message;
    return testing::AssertionSuccess();
}

/// What `error_in` returns for a result without an error.
[[nodiscard]] inline Error no_error() {
    return {.code = ErrorCode::self_check, .what = "no error"};
}
/// The error of a result, or `no_error`.
template <typename AnyResult>
[[nodiscard]] Error error_in(const AnyResult& result) {
    return result ? no_error() : result.error();
}

// Matchers for one field of an Error each.
[[nodiscard]] inline auto code_is(ErrorCode code) {
    return testing::ResultOf(
        "its code", [](const Error& error) { return std::string(name_of(error.code)); },
        std::string(name_of(code)));
}
/// The last component of its file.
[[nodiscard]] inline auto file_is(const std::string& name) {
    return testing::ResultOf(
        "its file", [](const Error& error) { return error.file.filename().string(); }, name);
}
[[nodiscard]] inline auto line_is(int line) {
    return testing::Field("line", &Error::line, line);
}
template <typename Matcher>
[[nodiscard]] auto key_is(const Matcher& matcher) {
    return testing::Field("key", &Error::key, matcher);
}
template <typename Matcher>
[[nodiscard]] auto what_is(const Matcher& matcher) {
    return testing::Field("what", &Error::what, matcher);
}
template <typename Matcher>
[[nodiscard]] auto value_is(const Matcher& matcher) {
    return testing::Field("value", &Error::value, matcher);
}
template <typename Matcher>
[[nodiscard]] auto remedy_is(const Matcher& matcher) {
    return testing::Field("remedy", &Error::remedy, matcher);
}
template <typename Matcher>
[[nodiscard]] auto others_are(const Matcher& matcher) {
    return testing::Field("others", &Error::others, matcher);
}
/// Matches `no_error`: the result had a value.
[[nodiscard]] inline auto is_no_error() {
    return testing::Field("what", &Error::what, "no error");
}

}  // namespace octoskin::testing_support
