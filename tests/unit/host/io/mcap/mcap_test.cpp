// MCAP files are written and read back, and those of other layouts are read.
#include <gmock/gmock.h>
#include <lz4frame.h>

#include "tests/unit/host/io/mcap/mcap_bytes.hpp"

namespace octoskin::mcap {
namespace {

using testing::Each;
using testing::ElementsAre;

std::string lz4_of(const std::string& bytes) {
    std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
    return packed;
}

class Mcap : public testing::Test {
  protected:
    testing_support::ScratchFolder folder_;
};

TEST_F(Mcap, reads_what_it_writes_over_many_chunks) {
    constexpr std::uint64_t kMessages = 300;
    constexpr std::size_t kEach = 20'000;  // 6 MB
    auto reader = McapReader::open(folder_.write("a.mcap", written(kMessages, kEach)));
    ASSERT_TRUE(reader);
    const Read read = read_all(*reader);
    ASSERT_EQ(read.data.size(), kMessages);
    for (std::uint64_t i = 0; i < kMessages; ++i) {
        EXPECT_TRUE(read.data[i].starts_with(std::to_string(i)));
        EXPECT_EQ(read.data[i].size(), kEach);
        EXPECT_EQ(read.times[i], static_cast<std::int64_t>(10 * i));
        EXPECT_EQ(read.topics[i], i % 2 == 0 ? "/a" : "/b");
    }
    EXPECT_THAT(read.faults, Each(0U));
    ASSERT_EQ(reader->channels().size(), 2U);
    EXPECT_EQ(reader->channels().at(2), (Channel{.schema_id = 1, .topic = "/b", .message_encoding = "cdr"}));
}

TEST_F(Mcap, writes_a_file_without_messages_that_reads_as_empty) {
    const Read read = read_bytes(folder_, written(0));
    EXPECT_TRUE(read.data.empty());
    EXPECT_THAT(read.faults, Each(0U));
}

TEST_F(Mcap, gives_the_schema_with_each_message) {
    auto reader = McapReader::open(folder_.write("a.mcap", written(1)));
    ASSERT_TRUE(reader);
    const auto message = reader->next();
    ASSERT_TRUE(message && *message && (*message)->schema != nullptr);
    EXPECT_EQ(*(*message)->schema, kText);
    EXPECT_EQ((*message)->head.sequence, 0U);
}

TEST_F(Mcap, names_a_failed_sink) {
    McapWriter writer([](std::string_view) { return false; }, "test");
    const std::uint16_t channel = writer.add_channel(kText, {.topic = "/a", .message_encoding = "cdr"});
    EXPECT_FALSE(writer.write(channel, {1}, "data"));
    EXPECT_FALSE(writer.finish());
}

TEST_F(Mcap, reads_messages_outside_chunks) {
    std::string data = channel_record(7, "/seven");
    for (int i = 0; i < 3; ++i) data += message_record(7, i, std::to_string(i));
    const Read read = read_bytes(folder_, file_of(data));
    EXPECT_THAT(read.data, ElementsAre("0", "1", "2"));
    EXPECT_THAT(read.topics, Each("/seven"));
    EXPECT_THAT(read.faults, Each(0U));
}

TEST_F(Mcap, reads_each_compression) {
    const std::string records = channel_record(1, "/a") + message_record(1, 5, std::string(1000, 'z'));
    for (const ChunkForm& form : {ChunkForm{}, ChunkForm{.compression = "lz4", .packed = lz4_of(records)},
                                  ChunkForm{.compression = "zstd", .packed = compress_zstd(records)}}) {
        const Read read = read_bytes(folder_, file_of(chunk_record(records, form)));
        EXPECT_THAT(read.data, ElementsAre(std::string(1000, 'z'))) << form.compression;
        EXPECT_THAT(read.faults, Each(0U)) << form.compression;
    }
}

TEST_F(Mcap, orders_messages_of_chunks_that_overlap_by_their_times) {
    const std::string channel = channel_record(1, "/a");
    const std::string late = channel + message_record(1, 20, "20") + message_record(1, 40, "40");
    const std::string early = message_record(1, 30, "30") + message_record(1, 10, "10");
    const std::string data = chunk_record(late, {.first = 20}) + chunk_record(early, {.first = 10});
    const Read indexed = read_bytes(folder_, file_of(data, channel));
    EXPECT_THAT(indexed.data, ElementsAre("10", "20", "30", "40"));
    EXPECT_THAT(indexed.faults, Each(0U));
    // Without a summary the channel is in the first chunk only; the second one overlaps it nevertheless.
    EXPECT_THAT(read_bytes(folder_, file_of(data)).data, ElementsAre("10", "20", "30", "40"));
}

TEST_F(Mcap, keeps_the_order_of_the_file_for_one_time) {
    std::string records = channel_record(1, "/a");
    for (int i = 0; i < 50; ++i) records += message_record(1, 3, std::to_string(i));
    const Read read = read_bytes(folder_, file_of(chunk_record(records, {.first = 3})));
    for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(read.data.at(i), std::to_string(i));
}

TEST_F(Mcap, refuses_another_format_and_a_missing_file) {
    const auto foreign = McapReader::open(folder_.write("a.mcap", "SQLite format 3"));
    ASSERT_FALSE(foreign);
    EXPECT_EQ(foreign.error().code, ErrorCode::foreign_format);
    const auto empty = McapReader::open(folder_.write("a.mcap", ""));
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().code, ErrorCode::foreign_format);
    const auto absent = McapReader::open(folder_ / "none.mcap");
    ASSERT_FALSE(absent);
    EXPECT_EQ(absent.error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace octoskin::mcap
