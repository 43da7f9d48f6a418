// Files put together by hand, record by record (layout: OpenNI2 2.2, OniDataRecords.h), cut anywhere.
#include "host/io/openni2/helpers/oni_salvage.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "host/io/openni2/helpers/oni_outline.hpp"
#include "host/io/openni2/helpers/oni_records.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::openni2 {
namespace {

template <class T>
std::string bytes_of(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

template <class T>
T value_at(const std::string& bytes, std::size_t position) {
    T value{};
    EXPECT_LE(position + sizeof(value), bytes.size());
    std::memcpy(&value, bytes.data() + position, sizeof(value));
    return value;
}

std::string record(std::uint32_t type, std::uint32_t node, const std::string& fields,
                   const std::string& payload = {}) {
    return std::string("NIR\0", 4) + bytes_of(type) + bytes_of(node) +
           bytes_of(static_cast<std::uint32_t>(28 + fields.size())) +
           bytes_of(static_cast<std::uint32_t>(payload.size())) + bytes_of(std::uint64_t{0}) + fields +
           payload;
}

/// Its frames' number, times and place of the table are open, as they are until the recorder ends.
std::string node_added(std::uint32_t node) {
    return record(0x0D, node,
                  bytes_of(std::uint32_t{6}) + std::string("Depth\0", 6) + bytes_of(std::uint32_t{2}) +
                      "16zT" + bytes_of(~std::uint32_t{0}) + bytes_of(std::uint64_t{0}) +
                      bytes_of(~std::uint64_t{0}) + bytes_of(std::uint64_t{0}));
}

std::string frame(std::uint32_t node, std::uint64_t timestamp_us, std::uint32_t number) {
    return record(0x0A, node, bytes_of(timestamp_us) + bytes_of(number), "pixels");
}

const std::string kHead = "NI10" + std::string(20, '\0');
const std::string kBegun = kHead + node_added(1) + record(0x08, 1, std::string(12, 'x'));

class OniSalvageTest : public testing::Test {
  protected:
    std::optional<std::uint32_t> salvaged(const std::string& bytes) {
        const auto frames = salvage(scratch_.write("cut.oni", bytes), scratch_ / "copy.oni");
        copy_ = frames ? testing_support::ScratchFolder::read(scratch_ / "copy.oni") : "";
        return frames;
    }
    testing_support::ScratchFolder scratch_;
    std::string copy_;
};

TEST_F(OniSalvageTest, keeps_whole_frames_and_writes_the_end_that_was_lost) {
    const std::string whole = kBegun + frame(1, 0, 1) + frame(1, 100'000, 2);
    ASSERT_EQ(salvaged(whole + frame(1, 200'000, 3).substr(0, 30)), 2U);
    // Up to its last whole frame nothing but the totals has changed: 28 bytes at the end of record 1.
    const std::size_t totals = kHead.size() + node_added(1).size() - 28;
    EXPECT_EQ(copy_.substr(0, totals), whole.substr(0, totals));
    EXPECT_EQ(copy_.substr(totals + 28, whole.size() - totals - 28), whole.substr(totals + 28));
    EXPECT_EQ(value_at<std::uint32_t>(copy_, totals), 2U);
    EXPECT_EQ(value_at<std::uint64_t>(copy_, totals + 4), 0U);
    EXPECT_EQ(value_at<std::uint64_t>(copy_, totals + 12), 100'000U);
    const auto table = value_at<std::uint64_t>(copy_, totals + 20);
    EXPECT_EQ(table, whole.size() + 28);  // behind the removal of the stream
    EXPECT_EQ(value_at<std::uint64_t>(copy_, whole.size() + 20), kHead.size());  // which says where it began
    EXPECT_EQ(value_at<std::uint32_t>(copy_, table + 4), 0x0EU);
    EXPECT_EQ(value_at<std::uint32_t>(copy_, table + 16), 3U * 20U);
    const std::size_t second = table + 28 + 2 * 20;
    EXPECT_EQ(value_at<std::uint64_t>(copy_, second), 100'000U);
    EXPECT_EQ(value_at<std::uint64_t>(copy_, second + 12), kBegun.size() + frame(1, 0, 1).size());
    const OniOutline outline = outline_of(scratch_ / "copy.oni");
    EXPECT_EQ(outline.frames, 2U);
    EXPECT_EQ(outline.length, copy_.size());
}

TEST_F(OniSalvageTest, of_a_file_that_is_cut_anywhere_keeps_what_is_whole) {
    const std::string whole =
        kBegun + frame(1, 0, 1) + frame(1, 5, 2) + record(0x07, 1, "") + record(0x0B, 0, "");
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const std::size_t data = length > kBegun.size() ? length - kBegun.size() : 0;
        const auto expected =
            static_cast<std::uint32_t>(std::min<std::size_t>(2, data / frame(1, 0, 1).size()));
        const auto frames = salvaged(whole.substr(0, length));
        EXPECT_EQ(frames.value_or(0), expected) << "cut to " << length;
        EXPECT_NE(frames, 0U);
    }
}

TEST_F(OniSalvageTest, tells_streams_apart) {
    const std::string both =
        kHead + node_added(1) + node_added(2) + frame(1, 0, 1) + frame(2, 7, 1) + frame(2, 8, 2);
    ASSERT_EQ(salvaged(both), 3U);
    const std::size_t first = kHead.size() + node_added(1).size() - 28;
    EXPECT_EQ(value_at<std::uint32_t>(copy_, first), 1U);
    EXPECT_EQ(value_at<std::uint32_t>(copy_, first + node_added(2).size()), 2U);
    // Stream 3 was never added: with its frame the file's sense ends.
    EXPECT_EQ(salvaged(kBegun + frame(1, 0, 1) + frame(3, 9, 1) + frame(1, 5, 2)), 1U);
    // So it does with a stream that is added again.
    EXPECT_EQ(salvaged(kBegun + frame(1, 0, 1) + node_added(1) + frame(1, 5, 2)), 1U);
    EXPECT_EQ(outline_of(scratch_ / "copy.oni").length, copy_.size());
}

TEST_F(OniSalvageTest, ends_at_what_OpenNI2_has_no_room_for) {
    EXPECT_EQ(salvaged(kBegun + frame(1, 0, 1) + record(0x0F, 1, std::string((1U << 20U) + 1, 'x')) +
                       frame(1, 5, 2)),
              1U);
    EXPECT_EQ(salvaged(kBegun + frame(1, 0, 1) +
                       record(0x0A, 1, bytes_of(std::uint64_t{5}) + bytes_of(std::uint32_t{2}),
                              std::string(kOniPayloadMax + 1, 'x')) +
                       frame(1, 9, 3)),
              1U);
}

TEST_F(OniSalvageTest, writes_nothing_of_more_than_its_limit) {
    const auto oni = scratch_.write("large.oni", kBegun);
    const std::string whole = record(0x0A, 1, bytes_of(std::uint64_t{5}) + bytes_of(std::uint32_t{1}),
                                     std::string(kOniPayloadMax, 'x'));
    const std::string begin = whole.substr(0, whole.size() - kOniPayloadMax);
    std::uintmax_t size = kBegun.size();
    std::ofstream file(oni, std::ios::binary | std::ios::in | std::ios::out);
    for (; size <= kSalvageMax; size += whole.size()) {
        file.seekp(static_cast<std::streamoff>(size));
        file << begin;
    }
    file.close();
    std::filesystem::resize_file(oni, size);
    EXPECT_EQ(salvage(oni, scratch_ / "copy.oni"), std::nullopt);
    EXPECT_FALSE(std::filesystem::exists(scratch_ / "copy.oni"));
}

TEST_F(OniSalvageTest, refuses_what_no_recorder_writes) {
    EXPECT_EQ(salvaged("foreign"), std::nullopt);
    EXPECT_EQ(salvaged(kHead + frame(1, 0, 1)), std::nullopt);
    EXPECT_EQ(salvaged(kHead + record(0x0D, 1, "") + frame(1, 0, 1)), std::nullopt);
    std::string many = kHead;
    for (std::uint32_t node = 1; node <= 9; ++node) many += node_added(node) + frame(node, 0, 1);
    EXPECT_EQ(salvaged(many), std::nullopt);
    EXPECT_EQ(salvage(scratch_ / "absent.oni", scratch_ / "copy.oni"), std::nullopt);
    const auto good = scratch_.write("good.oni", kBegun + frame(1, 0, 1));
    EXPECT_EQ(salvage(good, scratch_ / "no such folder" / "copy.oni"), std::nullopt);
    EXPECT_EQ(salvage(good, "/dev/full"), std::nullopt);
}

}  // namespace
}  // namespace octoskin::openni2
