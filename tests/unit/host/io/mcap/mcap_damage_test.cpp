// Damaged MCAP files: what can be read is read, and the rest is counted by its fault.
#include <gmock/gmock.h>

#include <random>

#include "tests/unit/host/io/mcap/mcap_bytes.hpp"

namespace octoskin::mcap {
namespace {

using testing::ElementsAre;

class DamagedMcap : public testing::Test {
  protected:
    testing_support::ScratchFolder folder_;
};

std::uint64_t sum(const Read& read) {
    std::uint64_t all = 0;
    for (const std::uint64_t one : read.faults) all += one;
    return all;
}

/// Of an uncompressed chunk with these records: what is read, and one fault.
void expect_fault(const testing_support::ScratchFolder& folder, const std::string& data, Fault fault,
                  std::size_t messages) {
    const std::string good = channel_record(1, "/a") + message_record(1, 1, "good");
    const Read read = read_bytes(folder, file_of(chunk_record(good, {.first = 1}) + data));
    EXPECT_EQ(read.data.size(), 1 + messages);
    EXPECT_EQ(read.count(fault), 1U);
    EXPECT_EQ(sum(read), 1U);
}

TEST_F(DamagedMcap, reads_what_is_whole_at_each_cut) {
    constexpr std::size_t kMessages = 40;
    std::string data = channel_record(1, "/a");
    for (std::size_t i = 0; i < kMessages; ++i) data += message_record(1, 1, std::string(10, 'm'));
    const std::string unchunked = file_of(data);
    const std::string chunked = written(kMessages);
    for (const std::string& whole : {unchunked, chunked}) {
        std::size_t most = 0;
        for (std::size_t cut = kMagic.size(); cut < whole.size(); ++cut) {
            const Read read = read_bytes(folder_, whole.substr(0, cut));
            EXPECT_GE(read.data.size(), most) << "cut at " << cut;
            most = read.data.size();
            const bool has_footer = cut + kMagic.size() >= whole.size();
            EXPECT_EQ(read.count(Fault::cut), has_footer ? 0U : 1U) << "cut at " << cut;
        }
        EXPECT_EQ(most, kMessages);
    }
}

TEST_F(DamagedMcap, gives_only_written_messages_of_a_chunk_with_a_flipped_bit) {
    const std::string whole = written(200);
    std::mt19937 random(4711);
    int seen = 0;
    for (int i = 0; i < 1500; ++i) {
        std::string bytes = whole;
        const std::size_t place = kMagic.size() + random() % (bytes.size() - kMagic.size());
        bytes[place] = static_cast<char>(static_cast<std::uint8_t>(bytes[place]) ^ (1U << random() % 8));
        const Read read = read_bytes(folder_, bytes);
        // A chunk is read whole or not at all; the checksum of the data also covers the heads of records.
        EXPECT_TRUE(read.data.empty() || read.data.size() == 200U) << "at " << place;
        seen += sum(read) > 0 ? 1 : 0;
    }
    EXPECT_GT(seen, 300);  // the summary, which is not needed, is most of so small a file
}

TEST_F(DamagedMcap, survives_random_bytes_behind_the_beginning) {
    std::mt19937 random(1);
    for (int i = 0; i < 300; ++i) {
        std::string bytes(kMagic);
        for (auto k = random() % 400; k > 0; --k) bytes += static_cast<char>(random() % 20);
        (void)read_bytes(folder_, bytes);
    }
}

TEST_F(DamagedMcap, counts_a_wrong_checksum_and_goes_on) {
    const std::string records = message_record(1, 2, "bad");
    const std::string next = chunk_record(message_record(1, 3, "next"), {.first = 3});
    expect_fault(folder_, chunk_record(records, {.first = 2, .crc = 12345U}) + next, Fault::damaged_chunk, 1);
}

TEST_F(DamagedMcap, takes_a_chunk_without_a_checksum) {
    const std::string records = channel_record(1, "/a") + message_record(1, 2, "any");
    EXPECT_THAT(read_bytes(folder_, file_of(chunk_record(records, {.crc = 0U}))).data, ElementsAre("any"));
}

TEST_F(DamagedMcap, counts_an_unknown_compression) {
    expect_fault(folder_, chunk_record(message_record(1, 2, "x"), {.first = 2, .compression = "bz2"}),
                 Fault::compression, 0);
}

TEST_F(DamagedMcap, bounds_the_memory_of_a_chunk_that_states_or_unpacks_to_too_much) {
    const std::string zeros(std::size_t{8} << 20U, '\0');
    const std::string bomb = compress_zstd(zeros);
    ASSERT_LT(bomb.size(), 2000U);
    ChunkForm form{.first = 2, .compression = "zstd", .packed = bomb, .size = std::uint64_t{1} << 60U};
    expect_fault(folder_, chunk_record(zeros, form), Fault::oversized, 0);
    form.size = 100;  // it would unpack to more than it states
    expect_fault(folder_, chunk_record(zeros, form), Fault::damaged_chunk, 0);
    form.size = zeros.size() + 1;
    expect_fault(folder_, chunk_record(zeros, form), Fault::damaged_chunk, 0);
    form.size = zeros.size();  // a chunk of zeros has no records
    expect_fault(folder_, chunk_record(zeros, form), Fault::bad_record, 0);
}

TEST_F(DamagedMcap, counts_a_length_in_a_chunk_that_goes_beyond_it) {
    std::string records = message_record(1, 2, "first") + message_record(1, 3, "second");
    records[message_record(1, 2, "first").size() + 1] = '\x7f';
    expect_fault(folder_, chunk_record(records, {.first = 2}), Fault::bad_record, 1);
}

TEST_F(DamagedMcap, counts_a_message_that_is_too_short) {
    std::string record;
    put_record(record, Op::message, "short");
    expect_fault(folder_, chunk_record(record, {.first = 2}), Fault::bad_record, 0);
}

TEST_F(DamagedMcap, counts_a_message_of_a_channel_without_description) {
    expect_fault(folder_, chunk_record(message_record(9, 2, "x"), {.first = 2}), Fault::unknown_channel, 0);
}

TEST_F(DamagedMcap, ends_at_a_record_that_is_longer_than_the_file) {
    std::string bytes = file_of(channel_record(1, "/a") + message_record(1, 1, "good"));
    std::string longer;
    FieldWriter writer(longer);
    writer.put(static_cast<std::uint8_t>(Op::message));
    writer.put(~std::uint64_t{0});
    const Read read =
        read_bytes(folder_, bytes.substr(0, bytes.size() - 50) + longer + std::string(100, 'x'));
    EXPECT_THAT(read.data, ElementsAre("good"));
    EXPECT_EQ(read.count(Fault::cut), 1U);
}

TEST_F(DamagedMcap, counts_a_wrong_checksum_of_the_data_and_reads_them) {
    std::string bytes = written(3);
    bytes[kMagic.size() + kRecordHeadBytes + 4] = 'R';  // the name of the profile, which no reader needs
    const Read read = read_bytes(folder_, bytes);
    EXPECT_EQ(read.data.size(), 3U);
    EXPECT_EQ(read.count(Fault::data_crc), 1U);
}

TEST_F(DamagedMcap, refuses_names_of_more_than_a_kibibyte) {
    const std::string longest = "/" + std::string(1023, 'a');
    const std::string message = message_record(1, 10, "data");
    const Read good = read_bytes(folder_, file_of(channel_record(1, longest) + message));
    EXPECT_EQ(good.topics, std::vector{longest});
    EXPECT_EQ(good.count(Fault::bad_record), 0U);
    const Read bad = read_bytes(folder_, file_of(channel_record(1, longest + "a") + message));
    EXPECT_TRUE(bad.topics.empty());
    EXPECT_EQ(bad.count(Fault::bad_record), 1U);
    EXPECT_EQ(bad.count(Fault::unknown_channel), 1U);
}

TEST_F(DamagedMcap, refuses_a_schemas_name_of_more_than_a_kibibyte) {
    for (const std::size_t length : {std::size_t{1024}, std::size_t{1025}}) {
        std::string fields;
        FieldWriter writer(fields);
        writer.put(std::uint16_t{1});
        writer.put_text(std::string(length, 'a'));
        writer.put_text("ros2msg");
        writer.put_text("string data");
        std::string record;
        put_record(record, Op::schema, fields);
        const Read read = read_bytes(folder_, file_of(record));
        EXPECT_EQ(read.count(Fault::bad_record), length > 1024 ? 1U : 0U);
    }
}

TEST_F(DamagedMcap, keeps_the_first_description_of_a_channel) {
    const std::string data =
        channel_record(1, "/first") + channel_record(1, "/second") + message_record(1, 1, "x");
    EXPECT_THAT(read_bytes(folder_, file_of(data)).topics, ElementsAre("/first"));
}

}  // namespace
}  // namespace octoskin::mcap
