#include "common/wire/codec.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <type_traits>
#include <variant>

#include "common/wire/bits.hpp"
#include "common/wire/crc.hpp"
#include "common/wire/field_reader.hpp"
#include "common/wire/field_writer.hpp"
#include "common/wire/layout.hpp"

namespace octoskin::wire {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// In the order of Message's alternatives.
constexpr std::array<FrameType, std::variant_size_v<Message>> kTypeOfAlternative = {
    FrameType::range,       FrameType::range_aux,     FrameType::range_fd,    FrameType::heartbeat,
    FrameType::node_info,   FrameType::sensor_health, FrameType::sync,        FrameType::follow_up,
    FrameType::sync_report, FrameType::joint_state,   FrameType::mark,        FrameType::command,
    FrameType::reflex,      FrameType::black_box,     FrameType::calibration,
};

/// The checksum over identifier, length and `data`: all of a CAN frame except the checksum itself.
std::uint16_t checksum_of(Checksum kind, std::uint32_t standard_id, std::size_t payload_len, Bytes data) {
    const std::array<std::uint8_t, 3> head = {static_cast<std::uint8_t>(standard_id),
                                              static_cast<std::uint8_t>(standard_id >> 8U),
                                              static_cast<std::uint8_t>(payload_len)};
    return kind == Checksum::crc8 ? crc8(data, crc8(head)) : crc16(data, crc16(head));
}

constexpr std::size_t length_of(Checksum kind) {
    return static_cast<std::size_t>(kind);
}

// A CRC-16 is sent high byte first, unlike every other field. On the wire each byte's highest bit comes
// first, so only in this order is a burst on the wire a burst in the polynomial. Low byte first, bursts of 13
// bits across the border between data and checksum would pass.
std::uint16_t checksum_sent(Checksum kind, Bytes payload) {
    const Bytes last = payload.last(length_of(kind));
    return kind == Checksum::crc8 ? last[0] : static_cast<std::uint16_t>((last[0] << 8U) | last[1]);
}
void put_checksum(Checksum kind, std::uint16_t checksum, std::span<std::uint8_t> payload) {
    const auto last = payload.last(length_of(kind));
    last.front() = static_cast<std::uint8_t>(kind == Checksum::crc8 ? checksum : checksum >> 8U);
    last.back() = static_cast<std::uint8_t>(checksum);
}

template <class T>
void write(FieldWriter& writer, const T& message) {
    walk(writer, message);
}
template <class... Ts>
void write(FieldWriter& writer, const std::variant<Ts...>& message) {
    // Not std::visit, which may throw: these variants always hold a value.
    const auto write_if_held = [&writer](const auto* alternative) {
        if (alternative != nullptr) {
            write(writer, *alternative);
        }
    };
    (write_if_held(std::get_if<Ts>(&message)), ...);
}

std::uint8_t payload_length(const FrameSpec& spec, const Message& message) {
    const auto* frame = std::get_if<RangeFd>(&message);
    return frame == nullptr ? spec.payload_len : range_fd_length(frame->count);
}

using DecodedMessage = Result<Message, DecodeError>;

/// `data`: the payload without its checksum. Length, checksum and version have been checked.
template <class T, class Group = T>
DecodedMessage read(Bytes data) {
    BitReader bits(data);
    FieldReader reader(bits);
    T message{};
    static_cast<void>(bits.get(kVersionBits));
    walk(reader, message);
    const Bytes rest = data.subspan(bits.bits_used() / 8);
    if (reader.has_nonzero_padding() ||
        !std::ranges::all_of(rest, [](std::uint8_t byte) { return byte == 0; })) {
        return unexpected(DecodeError::nonzero_padding);
    }
    if (reader.has_invalid_field()) {
        return unexpected(DecodeError::invalid_field);
    }
    return Message(Group(message));
}

DecodedMessage read_range_fd(Bytes data) {
    DecodedMessage message = read<RangeFd>(data);
    const auto fits = [&data](const Message& m) {
        return range_fd_length(std::get_if<RangeFd>(&m)->count) == data.size() + length_of(Checksum::crc16);
    };
    if (message && !fits(*message)) {
        return unexpected(DecodeError::invalid_field);
    }
    return message;
}

/// The field after the version, which selects one of a type's layouts.
std::uint8_t selector(Bytes data, unsigned bits) {
    return static_cast<std::uint8_t>((data[0] >> kVersionBits) & max_of_bits(bits));
}

DecodedMessage read_node_info(Bytes data) {
    switch (static_cast<InfoPage>(selector(data, kInfoPageBits))) {
        case InfoPage::uid_low:
            return read<InfoUidLow, NodeInfo>(data);
        case InfoPage::uid_high:
            return read<InfoUidHigh, NodeInfo>(data);
        case InfoPage::identity:
            return read<InfoIdentity, NodeInfo>(data);
        case InfoPage::build:
            return read<InfoBuild, NodeInfo>(data);
        case InfoPage::counters:
            return read<InfoCounters, NodeInfo>(data);
        case InfoPage::traffic:
            return read<InfoTraffic, NodeInfo>(data);
        case InfoPage::fault:
            return read<InfoFault, NodeInfo>(data);
    }
    return unexpected(DecodeError::invalid_field);
}

DecodedMessage read_joint_state(Bytes data) {
    return selector(data, kJointIndexBits) == kJointIndexLast ? read<JointLast, JointState>(data)
                                                              : read<JointPair, JointState>(data);
}

using Reader = DecodedMessage (*)(Bytes data);

/// In the order of kFrameSpecs.
constexpr std::array<Reader, kFrameSpecs.size()> kReaders = {
    read<Reflex>,       read<Sync>,       read<FollowUp>,   read<Command>,     read<Mark>,
    read<Heartbeat>,    read_joint_state, read<SyncReport>, read<Range>,       read_range_fd,
    read<SensorHealth>, read_node_info,   read<RangeAux>,   read<Calibration>, read<BlackBox>,
};

bool is_length_of(const FrameSpec& spec, std::size_t length) {
    if (spec.type != FrameType::range_fd) {
        return length == spec.payload_len;
    }
    for (std::uint8_t readings = 1; readings <= kReadingsPerFdFrame; ++readings) {
        if (length == range_fd_length(readings)) {
            return true;
        }
    }
    return false;
}

}  // namespace

const char* name(DecodeError error) noexcept {
    switch (error) {
        case DecodeError::foreign_format:
            return "foreign_format";
        case DecodeError::unknown_type:
            return "unknown_type";
        case DecodeError::wrong_length:
            return "wrong_length";
        case DecodeError::wrong_crc:
            return "wrong_crc";
        case DecodeError::wrong_version:
            return "wrong_version";
        case DecodeError::nonzero_padding:
            return "nonzero_padding";
        case DecodeError::invalid_field:
            return "invalid_field";
    }
    return "?";
}

FrameType type_of(const Message& message) noexcept {
    return kTypeOfAlternative[message.index()];
}

CanFrame encode(const Message& message, NodeId node_id) noexcept {
    const FrameSpec& spec = *frame_spec(type_of(message));
    assert(is_allowed(spec.party, node_id));
    CanFrame frame;
    frame.can_id = can_id(spec.type, node_id);
    frame.is_fd = spec.is_fd;
    frame.has_bit_rate_switch = spec.is_fd;
    frame.payload_len = payload_length(spec, message);
    const auto payload = std::span(frame.data).first(frame.payload_len);
    const auto data = payload.first(payload.size() - length_of(spec.checksum));
    BitWriter bits(data);
    FieldWriter writer(bits);
    bits.put(kProtocolVersion, kVersionBits);
    write(writer, message);
    put_checksum(spec.checksum, checksum_of(spec.checksum, frame.can_id, payload.size(), data), payload);
    return frame;
}

Result<Decoded, DecodeError> decode(const CanFrame& frame) noexcept {
    if (frame.is_extended || frame.is_remote || frame.is_error) {
        return unexpected(DecodeError::foreign_format);
    }
    if (frame.payload_len > kFdPayloadMax) {
        return unexpected(DecodeError::wrong_length);
    }
    return decode(frame.can_id, frame.is_fd, frame.payload());
}

Result<Decoded, DecodeError> decode(std::uint32_t standard_id, bool is_fd, Bytes payload) noexcept {
    if (standard_id > kStandardIdMax) {
        return unexpected(DecodeError::foreign_format);
    }
    const FrameSpec* spec = frame_spec(type_of(standard_id));
    if (spec == nullptr || !is_allowed(spec->party, node_of(standard_id))) {
        return unexpected(DecodeError::unknown_type);
    }
    if (is_fd != spec->is_fd) {
        return unexpected(DecodeError::foreign_format);
    }
    if (!is_length_of(*spec, payload.size())) {
        return unexpected(DecodeError::wrong_length);
    }
    const Bytes data = payload.first(payload.size() - length_of(spec->checksum));
    if (checksum_sent(spec->checksum, payload) !=
        checksum_of(spec->checksum, standard_id, payload.size(), data)) {
        return unexpected(DecodeError::wrong_crc);
    }
    if ((data[0] & max_of_bits(kVersionBits)) != kProtocolVersion) {
        return unexpected(DecodeError::wrong_version);
    }
    const auto index = static_cast<std::size_t>(spec - kFrameSpecs.data());
    const DecodedMessage message = kReaders[index](data);
    if (!message) {
        return unexpected(message.error());
    }
    return Decoded{.node_id = node_of(standard_id), .message = *message};
}

}  // namespace octoskin::wire
