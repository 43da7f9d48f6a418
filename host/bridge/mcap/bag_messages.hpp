// Messages of a bag as structs: the type is checked before the bytes are read.
#pragma once

#include "common/result.hpp"
#include "host/bridge/cdr/cdr_reader.hpp"
#include "host/bridge/messages/type_name.hpp"
#include "host/io/mcap/mcap_reader.hpp"

namespace octoskin::bridge {

[[nodiscard]] inline bool is_of(const mcap::Message& message, const ros::TypeName& type) noexcept {
    return message.schema != nullptr && message.schema->name == type.ros;
}

/// The error is a reason for an account: "other_type" (of another type, or not in CDR), "malformed".
template <cdr::Message M>
[[nodiscard]] Result<M, const char*> read_as(const mcap::Message& message) {
    if (!is_of(message, M::kType) || message.channel->message_encoding != "cdr")
        return unexpected("other_type");
    auto read = cdr::read<M>(message.data);
    if (!read) return unexpected("malformed");
    return std::move(read).value();
}

}  // namespace octoskin::bridge
