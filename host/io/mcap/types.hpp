// Schemas and channels from the fields of their records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "host/io/mcap/records.hpp"

namespace octoskin::mcap {

/// Names, topics and encodings are no longer: each may be kept several times.
inline constexpr std::size_t kNameBytesMax = 1024;

[[nodiscard]] inline bool are_names(const std::string& one, const std::string& other) noexcept {
    return one.size() <= kNameBytesMax && other.size() <= kNameBytesMax;
}

/// Empty: not the fields of such a record, a name that is too long, or the id 0, which no schema has. Throws
/// std::bad_alloc.
[[nodiscard]] inline std::optional<std::pair<std::uint16_t, Schema>> parse_schema(std::string_view fields) {
    FieldReader reader(fields);
    const auto id = reader.get<std::uint16_t>();
    Schema schema;
    schema.name = reader.get_text();
    schema.encoding = reader.get_text();
    schema.data = reader.get_text();
    if (!reader.is_sound() || id == 0 || !are_names(schema.name, schema.encoding)) return std::nullopt;
    return std::pair(id, std::move(schema));
}

/// Without its metadata. Empty: not the fields of such a record, or a name that is too long.
[[nodiscard]] inline std::optional<std::pair<std::uint16_t, Channel>> parse_channel(std::string_view fields) {
    FieldReader reader(fields);
    const auto id = reader.get<std::uint16_t>();
    Channel channel;
    channel.schema_id = reader.get<std::uint16_t>();
    channel.topic = reader.get_text();
    channel.message_encoding = reader.get_text();
    (void)reader.get_text();  // metadata
    if (!reader.is_sound() || !are_names(channel.topic, channel.message_encoding)) return std::nullopt;
    return std::pair(id, std::move(channel));
}

}  // namespace octoskin::mcap
