// An error as data: its sentence against its fields, and the table of codes against the enumeration.
#include "host/errors/error.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <random>
#include <set>
#include <string>
#include <string_view>

#include "tests/support/errors/error_fields.hpp"

namespace octoskin {
namespace {

using testing_support::has_its_fields;

/// Words of random letters, different from those of the other fields by `mark`.
std::string words(std::mt19937& random, char mark) {
    std::uniform_int_distribution<int> letters(1, 12);
    std::uniform_int_distribution<int> letter('a', 'z');
    std::string text(1, mark);
    for (int left = letters(random); left > 0; --left) text += static_cast<char>(letter(random));
    return text;
}

TEST(Error, sentence_has_each_field_that_is_not_empty_in_order) {
    std::mt19937 random(20'260);
    std::uniform_int_distribution<int> number(1, 99'999);
    constexpr unsigned kFields = 8;
    for (unsigned full = 0; full < 1U << kFields; ++full) {
        const auto has = [full](unsigned field) { return (full >> field & 1U) != 0; };
        const auto text = [&](unsigned field, char mark) { return has(field) ? words(random, mark) : ""; };
        Error error;
        error.file = text(0, 'F');
        error.line = has(1) ? number(random) : 0;
        error.column = has(2) ? number(random) : 0;
        error.key = text(3, 'K');
        error.what = text(4, 'W');
        error.value = text(5, 'V');
        error.remedy = text(6, 'R');
        error.others = text(7, 'O');
        const std::string line = has(1) ? std::to_string(error.line) : "";
        // A column without a line is the column of nothing.
        const std::string column = has(1) && has(2) ? ":" + std::to_string(error.column) : "";
        const std::array parts = {error.file.string(), line,        column,       error.key,
                                  error.what,          error.value, error.remedy, error.others};
        const std::string message = error.message();
        std::size_t at = 0;
        for (const std::string& part : parts) {
            const std::size_t found = message.find(part, at);
            ASSERT_NE(found, std::string::npos) << "'" << part << "' in " << message;
            at = found + part.size();
        }
        EXPECT_EQ(at, message.size()) << "something follows the last field: " << message;
        const testing::AssertionResult complete = has_its_fields(error);
        EXPECT_EQ(static_cast<bool>(complete), has(4)) << complete.message() << "; `what` is required";
        const std::string reason = error.reason();
        EXPECT_TRUE(message.ends_with(reason)) << message;
        EXPECT_EQ(reason.find_first_of("FK"), std::string::npos) << reason;
    }
}

TEST(Error, sentence_has_these_separators) {
    Error error{.what = "expected 1 or 2",
                .value = "'3'",
                .remedy = "give 1 or 2",
                .file = "a/rig.yaml",
                .line = 12,
                .column = 3,
                .key = "nodes[0].bus",
                .others = "1 more refused: bus"};
    EXPECT_EQ(error.message(),
              "a/rig.yaml:12:3: nodes[0].bus: expected 1 or 2, found '3': give 1 or 2. 1 more refused: bus");
    EXPECT_EQ(error.reason(), "expected 1 or 2, found '3': give 1 or 2. 1 more refused: bus");
    EXPECT_EQ((Error{.what = "gone", .file = "a/rig.yaml"}.message()), "a/rig.yaml: gone");
    EXPECT_EQ(Error{.what = "gone"}.message(), "gone");
}

TEST(Error, takes_another_place_and_keeps_the_rest) {
    const Error error{ErrorCode::not_found, "gone", "none", "put it there", "old", 3, 4, "key", "others"};
    const Error moved = in_file(error, "new", 7);
    EXPECT_EQ(moved.file, "new");
    EXPECT_EQ(moved.line, 7);
    EXPECT_EQ(in_file(error, "new").line, 0);
    EXPECT_EQ(moved.code, error.code);
    EXPECT_EQ(moved.key, error.key);
    EXPECT_EQ(moved.reason(), error.reason());
}

TEST(ErrorCode, has_one_name_and_one_meaning_in_the_order_of_the_enumeration) {
    EXPECT_EQ(kErrorMeanings.size(), static_cast<std::size_t>(ErrorCode::self_check) + 1)
        << "self_check is the last";
    std::set<std::string_view> names;
    std::set<std::string_view> meanings;
    for (std::size_t i = 0; i < kErrorMeanings.size(); ++i) {
        const auto& [code, name, meaning] = kErrorMeanings[i];
        EXPECT_EQ(static_cast<std::size_t>(code), i) << name;
        EXPECT_EQ(name_of(code), name);
        EXPECT_FALSE(name.empty());
        EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string_view::npos) << name;
        EXPECT_FALSE(meaning.empty()) << name;
        EXPECT_TRUE(names.insert(name).second) << name << " occurs twice";
        EXPECT_TRUE(meanings.insert(meaning).second) << name << " has the meaning of another";
    }
    EXPECT_EQ(name_of(ErrorCode::unknown_key), "unknown_key");
    EXPECT_EQ(name_of(ErrorCode::self_check), "self_check");
}

}  // namespace
}  // namespace octoskin
