// Schemas and channels from the fields of their records.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "host/io/mcap/records.hpp"

namespace octoskin::mcap {

/// Empty: not the fields of such a record, or the id 0, which no schema has. Throws std::bad_alloc.
[[nodiscard]] inline std::optional<std::pair<std::uint16_t, Schema>> parse_schema(std::string_view fields) {
    FieldReader reader(fields);
    const auto id = reader.get<std::uint16_t>();
    Schema schema;
    schema.name = reader.get_text();
    schema.encoding = reader.get_text();
    schema.data = reader.get_text();
    if (!reader.is_sound() || id == 0) return std::nullopt;
    return std::pair(id, std::move(schema));
}

[[nodiscard]] inline std::optional<std::pair<std::uint16_t, Channel>> parse_channel(std::string_view fields) {
    FieldReader reader(fields);
    const auto id = reader.get<std::uint16_t>();
    Channel channel;
    channel.schema_id = reader.get<std::uint16_t>();
    channel.topic = reader.get_text();
    channel.message_encoding = reader.get_text();
    channel.metadata = reader.get_metadata();
    if (!reader.is_sound()) return std::nullopt;
    return std::pair(id, std::move(channel));
}

}  // namespace octoskin::mcap
