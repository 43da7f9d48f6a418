// What of a foreign text reaches a terminal. Oracle: ECMA-48 (C0, C1), RFC 3629, Unicode's property
// Bidi_Control, character by character.
#include <gtest/gtest.h>

#include <string>

#include "host/core/text/printable.hpp"
#include "host/core/text/utf8.hpp"

namespace octoskin {
namespace {

std::string utf8(char32_t c) {
    const auto byte = [](char32_t bits) { return static_cast<char>(static_cast<unsigned char>(bits)); };
    if (c < 0x80) return {byte(c)};
    if (c < 0x800) return {byte(0xC0 | c >> 6U), byte(0x80 | (c & 0x3FU))};
    if (c < 0x10000) return {byte(0xE0 | c >> 12U), byte(0x80 | (c >> 6U & 0x3FU)), byte(0x80 | (c & 0x3FU))};
    return {byte(0xF0 | c >> 18U), byte(0x80 | (c >> 12U & 0x3FU)), byte(0x80 | (c >> 6U & 0x3FU)),
            byte(0x80 | (c & 0x3FU))};
}

TEST(Printable, leaves_marks_as_they_are) {
    for (const char* text : {"", "wrist_1", "Gelenk Größe 3 °C", "機械臂", "\U0001F9BE", "a\\x1b b \\", "~"})
        EXPECT_EQ(printable(text), text);
}

TEST(Printable, shows_what_orders_a_terminal_by_its_number) {
    EXPECT_EQ(printable("\x1b]0;owned\a\x1b[31mred"), "\\x1b]0;owned\\x07\\x1b[31mred");
    EXPECT_EQ(printable("a\nb\tc\rd"), "a\\x0ab\\x09c\\x0dd");
    EXPECT_EQ(printable(std::string("nul\0nul", 7)), "nul\\x00nul");
    EXPECT_EQ(printable("\x7f"), "\\x7f");
    EXPECT_EQ(printable("\u009b31m"), "\\x9b31m");
    EXPECT_EQ(printable("file\u202egnp.exe"), "file\\u202egnp.exe");
    EXPECT_EQ(printable("a\u2028b\u2029c"), "a\\u2028b\\u2029c");
}

TEST(Printable, shows_each_byte_that_is_no_utf8) {
    EXPECT_EQ(printable("\x9b"
                        "31m"),
              "\\x9b31m")
        << "C1 as a terminal of eight bits takes it";
    EXPECT_EQ(printable("\xff\xfe"), "\\xff\\xfe");
    EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b") << "an overlong form";
    EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "a surrogate";
    EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "above U+10FFFF";
    EXPECT_EQ(printable("\xe6\xa9"), "\\xe6\\xa9") << "cut off";
    EXPECT_EQ(printable("\xc3"
                        "a"),
              "\\xc3a");
}

TEST(Printable, lets_no_character_through_that_is_a_control_or_turns_the_writing) {
    for (char32_t c = 0; c <= 0x10FFFF; ++c) {
        if (c >= 0xD800 && c <= 0xDFFF) continue;
        const bool is_control = c < 0x20 || (c >= 0x7F && c <= 0x9F);
        const bool is_turning = c == 0x61C || c == 0x200E || c == 0x200F || (c >= 0x202A && c <= 0x202E) ||
                                (c >= 0x2066 && c <= 0x2069);
        const bool is_separator = c == 0x2028 || c == 0x2029;
        const std::string text = utf8(c);
        ASSERT_EQ(utf8_length(text), text.size()) << static_cast<unsigned>(c);
        ASSERT_EQ(utf8_character(text), c);
        ASSERT_EQ(printable(text) == text, !(is_control || is_turning || is_separator))
            << static_cast<unsigned>(c);
    }
}

TEST(Printable, of_json_reads_as_the_same_and_orders_no_terminal) {
    EXPECT_EQ(printable_json("{\n  \"a\\u001b\": \"\xc3\xa9\"\n}"), "{\n  \"a\\u001b\": \"\xc3\xa9\"\n}");
    EXPECT_EQ(printable_json("\"\x7f\xc2\x9b\xe2\x80\xae\xe2\x81\xa6\""), "\"\\u007f\\u009b\\u202e\\u2066\"");
    EXPECT_EQ(printable_json("\"\xe2\x80\xa8\xd8\x9c\""), "\"\\u2028\\u061c\"");
}

TEST(Printable, of_lines_keeps_line_ends_and_tabs_alone) {
    EXPECT_EQ(printable_lines("a\tb\n\x1b[0m\r\n"), "a\tb\n\\x1b[0m\\x0d\n");
}

}  // namespace
}  // namespace octoskin
