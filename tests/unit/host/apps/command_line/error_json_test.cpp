#include "host/apps/command_line/error_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

/// An error with the parts whose bits are set.
Error some_error(unsigned parts) {
    const auto has = [parts](unsigned bit) { return (parts >> bit & 1U) != 0; };
    Error error{ErrorCode::damaged, "expected a, b: c"};
    if (has(0)) error.value = "'x: y'";
    if (has(1)) error.remedy = "do: so";
    if (has(2)) error.file = "a/b.yaml";
    if (has(3)) error.line = 3;
    if (has(4)) error.column = 7;
    if (has(5)) error.key = "k[0].v";
    if (has(6)) error.others = "2 more. refused: z";
    return error;
}

TEST(ErrorJson, has_the_parts_that_are_not_empty) {
    const Json all = to_json(some_error(0b111'1111));
    EXPECT_EQ(all,
              (Json{{"code", "damaged"},
                    {"file", "a/b.yaml"},
                    {"line", 3},
                    {"column", 7},
                    {"key", "k[0].v"},
                    {"value", "'x: y'"},
                    {"remedy", "do: so"},
                    {"others", "2 more. refused: z"},
                    {"message",
                     "a/b.yaml:3:7: k[0].v: expected a, b: c, found 'x: y': do: so. 2 more. refused: z"}}));
    EXPECT_EQ(to_json(some_error(0)), (Json{{"code", "damaged"}, {"message", "expected a, b: c"}}));
}

TEST(ErrorJson, becomes_the_same_error_again) {
    for (unsigned parts = 0; parts < 128; ++parts) {
        const Error error = some_error(parts);
        for (const Json& json : {to_json(error), Json::parse(to_json(error).dump())}) {
            const Error again = error_of(json);
            EXPECT_EQ(again.message(), error.message());
            EXPECT_EQ(to_json(again), to_json(error));
            EXPECT_EQ(again.what, error.what) << error.message();
            EXPECT_EQ(again.others, error.others);
        }
    }
}

TEST(ErrorJson, of_another_program_is_shown_as_it_is) {
    EXPECT_EQ(error_of("too many clients").message(), "too many clients");
    for (const char* const text : {"null", "[1]", "{}", R"({"code":7,"line":-3,"file":null})",
                                   R"({"line":18446744073709551615,"column":1.5})"}) {
        const Error error = error_of(Json::parse(text));
        EXPECT_EQ(error.code, ErrorCode::bad_value) << text;
        EXPECT_EQ(error.message(), text);
    }
    const Error unknown = error_of({{"code", "no such code"}, {"file", "f"}, {"message", "f: why"}});
    EXPECT_EQ(unknown.code, ErrorCode::bad_value);
    EXPECT_EQ(unknown.file, "f");
    EXPECT_EQ(unknown.what, "why");
    const Error partly = error_of({{"code", "link"}, {"file", "f"}, {"line", 4}});
    EXPECT_EQ(partly.code, ErrorCode::link);
    EXPECT_EQ(partly.file, "f");
    EXPECT_EQ(partly.line, 4);
    const Error contradicting = error_of({{"code", "link"}, {"file", "f"}, {"message", "another sentence"}});
    EXPECT_EQ(contradicting.code, ErrorCode::link);
    EXPECT_EQ(contradicting.message(), "another sentence");
}

}  // namespace
}  // namespace octoskin
