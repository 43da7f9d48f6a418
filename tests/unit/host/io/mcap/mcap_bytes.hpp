// MCAP files in memory: of our writer, and record by record as other writers lay them out.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/io/mapfile/file_checksum.hpp"
#include "host/io/mcap/compression.hpp"
#include "host/io/mcap/mcap_reader.hpp"
#include "host/io/mcap/mcap_writer.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::mcap {

inline const Schema kText{"std_msgs/msg/String", "ros2msg", "string data\n"};

struct Read {
    std::vector<std::string> data;
    std::vector<std::int64_t> times;
    std::vector<std::string> topics;
    std::array<std::uint64_t, 8> faults{};
    [[nodiscard]] std::uint64_t count(Fault fault) const { return faults[static_cast<std::size_t>(fault)]; }
};

/// All messages of a file; an error of the reader fails the test.
inline Read read_all(McapReader& reader) {
    Read read;
    for (;;) {
        const auto message = reader.next();
        if (!message) ADD_FAILURE() << message.error().message();
        if (!message || !*message) break;
        const Message& one = **message;
        read.data.emplace_back(one.data.begin(), one.data.end());
        read.times.push_back(one.head.logged.ns);
        read.topics.push_back(one.channel->topic);
    }
    for (std::size_t i = 0; i < read.faults.size(); ++i)
        read.faults[i] = reader.count(Fault{static_cast<std::uint8_t>(i)});
    return read;
}

/// Of bytes that begin like an MCAP file.
inline Read read_bytes(const testing_support::ScratchFolder& folder, std::string_view bytes) {
    // A new file: ext4 writes one that is emptied and filled again to the disk.
    std::filesystem::remove(folder / "a.mcap");
    auto reader = McapReader::open(folder.write("a.mcap", bytes));
    if (!reader) {
        ADD_FAILURE() << reader.error().message();
        return {};
    }
    return read_all(*reader);
}

/// `messages` messages of two topics, 10 ns apart, by our writer.
inline std::string written(std::uint64_t messages, std::size_t bytes_each = 5) {
    std::string bytes;
    McapWriter writer([&bytes](std::string_view more) { return bytes += more, true; }, "test");
    const std::uint16_t a = writer.add_channel(kText, {.topic = "/a", .message_encoding = "cdr"});
    const std::uint16_t b =
        writer.add_channel(kText, {.topic = "/b", .message_encoding = "cdr", .metadata = {{"key", "value"}}});
    for (std::uint64_t i = 0; i < messages; ++i) {
        std::string data = std::to_string(i);
        data.resize(std::max(data.size(), bytes_each), 'x');
        EXPECT_TRUE(writer.write(i % 2 == 0 ? a : b, {static_cast<std::int64_t>(10 * i)}, data));
    }
    EXPECT_TRUE(writer.finish());
    EXPECT_EQ(writer.messages(), messages);
    EXPECT_EQ(writer.bytes(), bytes.size());
    return bytes;
}

// Records of other writers.
inline std::string channel_record(std::uint16_t id, const std::string& topic) {
    std::string fields;
    FieldWriter writer(fields);
    writer.put(id);
    writer.put(std::uint16_t{0});
    writer.put_text(topic);
    writer.put_text("cdr");
    writer.put_metadata({});
    std::string record;
    put_record(record, Op::channel, fields);
    return record;
}

inline std::string message_record(std::uint16_t channel, std::int64_t time, const std::string& data) {
    std::string fields;
    FieldWriter writer(fields);
    put(writer, {channel, 0, {time}, {time}});
    std::string record;
    put_record(record, Op::message, fields + data);
    return record;
}

struct ChunkForm {
    std::int64_t first = 0;
    std::string compression = {};
    std::string packed = {};  ///< empty: the records themselves
    std::optional<std::uint64_t> size = {};
    std::optional<std::uint32_t> crc = {};
};

inline std::string chunk_record(const std::string& records, const ChunkForm& form) {
    std::string fields;
    FieldWriter writer(fields);
    writer.put(static_cast<std::uint64_t>(form.first));
    writer.put(static_cast<std::uint64_t>(form.first));
    writer.put(form.size.value_or(records.size()));
    writer.put(form.crc.value_or(file_checksum(records)));
    writer.put_text(form.compression);
    const std::string& packed = form.packed.empty() ? records : form.packed;
    writer.put(static_cast<std::uint64_t>(packed.size()));
    fields += packed;
    std::string record;
    put_record(record, Op::chunk, fields);
    return record;
}

/// `summary`: records behind the end of the data.
inline std::string file_of(const std::string& data, const std::string& summary = {}) {
    std::string bytes(kMagic);
    put_record(bytes, Op::header, std::string(8, '\0'));
    bytes += data;
    put_record(bytes, Op::data_end, std::string(4, '\0'));
    bytes += summary;
    put_record(bytes, Op::footer, std::string(20, '\0'));
    bytes += kMagic;
    return bytes;
}

}  // namespace octoskin::mcap
