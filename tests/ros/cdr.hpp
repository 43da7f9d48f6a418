// Reads and writes one generated message as bytes.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include "tests/ros/codec.hpp"

namespace octoskin::ros {

template <typename Message>
struct ReadMessage {
    Message message;
    std::size_t unread = 0;
};

/// Throws as Codec::decode does.
template <typename Message>
ReadMessage<Message> read_cdr(const Bytes& bytes) {
    using eprosima::fastcdr::Cdr;
    // FastBuffer takes no constant memory, but reading does not write to it.
    auto* const memory = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
    eprosima::fastcdr::FastBuffer buffer(memory, bytes.size());
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    ReadMessage<Message> read;
    read.message.deserialize(cdr);
    read.unread = bytes.size() - cdr.getSerializedDataLength();
    return read;
}

template <typename Message>
Bytes write_cdr(const Message& message) {
    using eprosima::fastcdr::Cdr;
    Bytes bytes(Message::getCdrSerializedSize(message) + 4);
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
    Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
    cdr.serialize_encapsulation();
    message.serialize(cdr);
    bytes.resize(cdr.getSerializedDataLength());
    return bytes;
}

}  // namespace octoskin::ros
