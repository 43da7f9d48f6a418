// One text in every encoding that people's programs write.
#include "host/io/lines/line_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing::ElementsAre;
using End = LineStream::End;

class LineStreamTest : public testing::Test {
  protected:
    LineStream open(const std::string& bytes, std::size_t bytes_max = 100) {
        return {std::ifstream(scratch_.write("text", bytes), std::ios::binary), bytes_max};
    }
    std::vector<std::string> lines_of(const std::string& bytes) {
        LineStream stream = open(bytes);
        std::vector<std::string> lines;
        while (stream.next() != End::nothing_left) lines.push_back(stream.line());
        EXPECT_EQ(stream.number(), lines.size());
        EXPECT_FALSE(stream.has_failed());
        return lines;
    }

    testing_support::ScratchFolder scratch_;
};

std::string utf_16(const std::string& ascii, bool is_big) {
    std::string bytes;
    for (const char c : ascii) bytes += is_big ? std::string{'\0', c} : std::string{c, '\0'};
    return bytes;
}

TEST_F(LineStreamTest, gives_the_same_lines_in_every_encoding) {
    const std::string text = "one\r\n\ntwo 2";
    const std::string marks[] = {"\xEF\xBB\xBF" + text, "\xFF\xFE" + utf_16(text, false),
                                 "\xFE\xFF" + utf_16(text, true), utf_16(text, false), utf_16(text, true)};
    EXPECT_THAT(lines_of(text), ElementsAre("one\r", "", "two 2"));
    for (const std::string& bytes : marks) EXPECT_THAT(lines_of(bytes), ElementsAre("one\r", "", "two 2"));
}

TEST_F(LineStreamTest, characters_of_utf_16_beyond_ascii_are_question_marks) {
    EXPECT_THAT(lines_of(std::string("\xFF\xFE\x41\x00\xE4\x00\x16\x4E\x42\x00", 10)), ElementsAre("A??B"));
}

TEST_F(LineStreamTest, half_a_character_at_the_end_is_none) {
    EXPECT_THAT(lines_of(std::string("\xFF\xFE\x41\x00\x42", 5)), ElementsAre("A"));
}

TEST_F(LineStreamTest, an_empty_file_and_a_mark_alone_have_no_line) {
    EXPECT_THAT(lines_of(""), ElementsAre());
    EXPECT_THAT(lines_of("\xEF\xBB\xBF"), ElementsAre());
    EXPECT_THAT(lines_of("\xFF\xFE"), ElementsAre());
}

TEST_F(LineStreamTest, a_line_over_the_limit_is_cut_and_the_next_is_whole) {
    LineStream stream = open("12345\n123456\n1", 5);
    EXPECT_EQ(stream.next(), End::line_feed);
    EXPECT_FALSE(stream.is_cut());
    EXPECT_EQ(stream.next(), End::line_feed);
    EXPECT_EQ(stream.line(), "12345");
    EXPECT_TRUE(stream.is_cut());
    EXPECT_EQ(stream.next(), End::end_of_file);
    EXPECT_EQ(stream.line(), "1");
    EXPECT_FALSE(stream.is_cut());
    EXPECT_EQ(stream.next(), End::nothing_left);
    EXPECT_EQ(stream.number(), 3U);
}

TEST_F(LineStreamTest, a_file_over_one_block_is_read_whole) {
    std::string text;
    for (int i = 0; i < 20'000; ++i) text += std::to_string(i) + '\n';
    const auto lines = lines_of(text);
    ASSERT_EQ(lines.size(), 20'000U);
    for (int i = 0; i < 20'000; ++i) ASSERT_EQ(lines[static_cast<std::size_t>(i)], std::to_string(i));
}

}  // namespace
}  // namespace octoskin
