// The records of an MCAP file (https://mcap.dev/spec): an operation code, a length, fields.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/time.hpp"
#include "host/io/mcap/record_bytes.hpp"

namespace octoskin::mcap {

/// At the beginning and at the end of a file.
inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
/// Operation code and length.
inline constexpr std::size_t kRecordHeadBytes = 9;

enum class Op : std::uint8_t {
    header = 0x01,
    footer = 0x02,
    schema = 0x03,
    channel = 0x04,
    message = 0x05,
    chunk = 0x06,
    message_index = 0x07,
    chunk_index = 0x08,
    attachment = 0x09,
    attachment_index = 0x0A,
    statistics = 0x0B,
    metadata = 0x0C,
    metadata_index = 0x0D,
    summary_offset = 0x0E,
    data_end = 0x0F,
};

/// The type of a channel's messages.
struct Schema {
    std::string name;      ///< "sensor_msgs/msg/Range"
    std::string encoding;  ///< "ros2msg"
    std::string data;      ///< the definition, in that encoding
    friend bool operator==(const Schema&, const Schema&) = default;
};

struct Channel {
    std::uint16_t schema_id = 0;  ///< 0: none
    std::string topic;
    std::string message_encoding;  ///< "cdr"
    Metadata metadata = {};        ///< of a writer; a reader leaves it out
    friend bool operator==(const Channel&, const Channel&) = default;
};

/// The bytes in front of a message's data.
struct MessageHead {
    static constexpr std::size_t kBytes = 22;
    std::uint16_t channel_id = 0;
    std::uint32_t sequence = 0;
    WallTime logged;
    WallTime published;
};

inline void put(FieldWriter& writer, const MessageHead& head) {
    writer.put(head.channel_id);
    writer.put(head.sequence);
    writer.put(static_cast<std::uint64_t>(head.logged.ns));
    writer.put(static_cast<std::uint64_t>(head.published.ns));
}

/// A time beyond 2262 wraps to a negative one.
[[nodiscard]] inline WallTime get_time(FieldReader& reader) noexcept {
    return {static_cast<std::int64_t>(reader.get<std::uint64_t>())};
}

[[nodiscard]] inline MessageHead get_message_head(FieldReader& reader) noexcept {
    MessageHead head;
    head.channel_id = reader.get<std::uint16_t>();
    head.sequence = reader.get<std::uint32_t>();
    head.logged = get_time(reader);
    head.published = get_time(reader);
    return head;
}

/// Appends a record with these fields. Throws std::bad_alloc.
inline void put_record(std::string& bytes, Op op, std::string_view fields) {
    FieldWriter writer(bytes);
    writer.put(static_cast<std::uint8_t>(op));
    writer.put(static_cast<std::uint64_t>(fields.size()));
    bytes += fields;
}

}  // namespace octoskin::mcap
