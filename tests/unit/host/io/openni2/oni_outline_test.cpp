// The outline of .oni files put together by hand, record by record (layout: OpenNI2 2.2, OniDataRecords.h).
#include "host/io/openni2/helpers/oni_outline.hpp"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::openni2 {
namespace {

std::string little_endian(std::uint32_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> (8 * i)));
    return bytes;
}

std::string record(std::uint32_t type, std::size_t extra_fields, std::size_t payload) {
    return std::string("NIR\0", 4) + little_endian(type) + little_endian(1) +
           little_endian(static_cast<std::uint32_t>(28 + extra_fields)) +
           little_endian(static_cast<std::uint32_t>(payload)) + std::string(8 + extra_fields + payload, 'x');
}

const std::string kHead = "NI10" + std::string(20, '\0');
const std::string kProperty = record(0x03, 31, 0);
const std::string kDataBegin = record(0x08, 12, 0);
const std::string kFrame = record(0x0A, 12, 9);
const std::string kEnd = record(0x0B, 0, 0);

class OniOutlineTest : public testing::Test {
  protected:
    OniOutline outline_of_bytes(const std::string& bytes) {
        return outline_of(scratch_.write("x.oni", bytes));
    }
    testing_support::ScratchFolder scratch_;
};

TEST_F(OniOutlineTest, counts_the_frames_and_finds_the_end_before_what_follows_it) {
    const std::string whole = kHead + kProperty + kDataBegin + kFrame + kProperty + kFrame + kEnd;
    const auto outline = outline_of_bytes(whole + std::string(1000, '\0'));
    EXPECT_TRUE(outline.has_begun);
    EXPECT_EQ(outline.frames, 2U);
    EXPECT_EQ(outline.length, whole.size());
}

TEST_F(OniOutlineTest, has_not_begun_before_the_record_that_says_so) {
    EXPECT_FALSE(outline_of_bytes("").has_begun);
    EXPECT_FALSE(outline_of_bytes(kHead + kProperty).has_begun);
    EXPECT_FALSE(outline_of_bytes(kHead + kProperty + kDataBegin.substr(0, 39)).has_begun);
    EXPECT_TRUE(outline_of_bytes(kHead + kProperty + kDataBegin).has_begun);
    EXPECT_FALSE(outline_of(scratch_ / "absent.oni").has_begun);
}

TEST_F(OniOutlineTest, counts_only_whole_frames_of_a_file_that_is_cut_anywhere) {
    const std::string begun = kHead + kDataBegin;
    const std::string whole = begun + kFrame + kFrame + kEnd;
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const auto outline = outline_of_bytes(whole.substr(0, length));
        const std::size_t data = length > begun.size() ? length - begun.size() : 0;
        EXPECT_EQ(outline.frames, std::min<std::size_t>(2, data / kFrame.size())) << "cut to " << length;
        EXPECT_FALSE(outline.length) << "cut to " << length;
    }
}

TEST_F(OniOutlineTest, stops_at_a_record_that_makes_no_sense) {
    std::string tiny = kFrame;
    tiny[12] = 4;  // a header smaller than a header would never end
    std::string huge = kFrame;
    huge[19] = '\x7F';
    std::string other = kFrame;
    other[0] = 'X';
    for (const auto& wrong : {tiny, huge, other}) {
        const auto outline = outline_of_bytes(kHead + kDataBegin + kFrame + wrong + kEnd);
        EXPECT_EQ(outline.frames, 1U);
        EXPECT_FALSE(outline.length);
    }
}

}  // namespace
}  // namespace octoskin::openni2
